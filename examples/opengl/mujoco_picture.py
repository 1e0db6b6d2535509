"""A MuJoCo scene without a screen: a picture after some seconds of simulation.

    pip install mujoco pillow
    eval "$(vitral osmesa-env)"
    python3 examples/opengl/mujoco_picture.py mujoco.jpg
"""

import sys

import mujoco
from PIL import Image

# A column of bodies of each shape, which fall on a mirroring floor.
SHAPES = ["sphere", "box", "capsule", "cylinder", "ellipsoid"]
COLORS = [".85 .3 .2 1", ".2 .5 .8 1", ".95 .7 .2 1", ".3 .65 .4 1", ".6 .4 .75 1"]
BODIES = "".join(
    f'<body pos="{0.35 * (i % 3 - 1)} {0.3 * (i // 3 % 3 - 1)} {0.4 + 0.17 * i}" euler="{37 * i} {61 * i} 0">'
    f'<freejoint/><geom type="{SHAPES[i % 5]}" size=".13 .09 .07" rgba="{COLORS[i % 5]}"/></body>'
    for i in range(20)
)
MODEL = f"""
<mujoco>
  <visual>
    <global offwidth="640" offheight="480"/>
    <quality shadowsize="4096"/>
    <headlight ambient=".3 .3 .3" diffuse=".25 .25 .25"/>
  </visual>
  <asset>
    <texture type="skybox" builtin="gradient" rgb1=".75 .82 .9" rgb2=".35 .45 .6" width="256" height="256"/>
    <texture name="floor" type="2d" builtin="checker" rgb1=".8 .8 .78" rgb2=".5 .55 .6" width="256" height="256"/>
    <material name="floor" texture="floor" texrepeat="6 6" reflectance=".25"/>
  </asset>
  <worldbody>
    <light pos="1.5 -1 3" dir="-.45 .3 -1" diffuse=".7 .7 .7"/>
    <geom type="plane" size="3 3 .1" material="floor"/>
    {BODIES}
  </worldbody>
</mujoco>"""

model = mujoco.MjModel.from_xml_string(MODEL)
data = mujoco.MjData(model)
while data.time < 2.5:
    mujoco.mj_step(model, data)
camera = mujoco.MjvCamera()
camera.lookat[:] = 0, 0, 0.15
camera.distance, camera.azimuth, camera.elevation = 2.9, 120, -28
with mujoco.Renderer(model, 480, 640) as renderer:
    renderer.update_scene(data, camera)
    Image.fromarray(renderer.render()).save(sys.argv[1], quality=88)
