"""Gymnasium's MuJoCo environments with render_mode="rgb_array"."""
import gymnasium
import numpy

import drawn

for name in ['Ant-v5', 'Humanoid-v5', 'HalfCheetah-v5', 'Hopper-v5']:
    environment = gymnasium.make(name, render_mode='rgb_array')
    environment.reset(seed=0)
    random = numpy.random.default_rng(0)
    shape, limit = environment.action_space.shape, environment.action_space.high
    for step in range(21):
        if step % 10 == 0:
            drawn.save('%s-%d' % (name.split('-')[0].lower(), step), environment.render())
        environment.step(random.uniform(-limit, limit, shape).astype(numpy.float32))
drawn.end()
