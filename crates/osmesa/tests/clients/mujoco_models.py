"""MuJoCo's own renderer: colour, depth, segmentation and labels of geoms, a height field, a skin and flexes."""
import math

import mujoco
import numpy

import drawn

SIZE = 320, 240

SHAPES = """
<mujoco><statistic center="0 0 .5" extent="2"/>
 <visual><map fogstart="2" fogend="5" haze=".4"/><rgba fog=".6 .7 .8 1" haze=".7 .8 .9 1"/></visual>
 <asset>
  <texture name="grid" type="2d" builtin="checker" rgb1=".1 .2 .3" rgb2=".8 .8 .7" width="256" height="256" mark="edge" markrgb="1 .3 .2"/>
  <texture name="cube" type="cube" builtin="gradient" rgb1=".9 .2 .1" rgb2=".1 .2 .9" width="64" height="64" mark="cross" markrgb="1 1 1"/>
  <texture type="skybox" builtin="gradient" rgb1=".3 .5 .7" rgb2=".05 .05 .1" width="128" height="128"/>
  <material name="grid" texture="grid" texrepeat="1 1" texuniform="true" reflectance=".3"/>
  <material name="cube" texture="cube" specular=".8" shininess=".6"/>
  <material name="gloss" specular="1" shininess=".9" rgba=".2 .7 .3 1"/>
 </asset>
 <worldbody>
  <light pos=".5 -1 3.5" dir="-.1 .25 -1" cutoff="40" exponent="6"/>
  <light pos="2 2 3" dir="-1 -1 -1" directional="true" diffuse=".4 .4 .35"/>
  <geom type="plane" size="3 3 .1" material="grid"/>
  <geom name="box" type="box" size=".2 .2 .2" pos="0 0 .25" euler="0 0 30" material="cube"/>
  <geom name="sphere" type="sphere" size=".22" pos=".5 -.3 .22" material="gloss"/>
  <geom name="capsule" type="capsule" size=".1 .25" pos="-.5 .2 .5" euler="60 0 0" rgba=".2 .3 .9 1"/>
  <geom name="cylinder" type="cylinder" size=".12 .25" pos="0 .7 .25" rgba=".9 .8 .2 1"/>
  <geom name="ellipsoid" type="ellipsoid" size=".3 .15 .1" pos=".1 -.8 .2" euler="0 0 40" rgba=".9 .2 .9 1"/>
  <geom name="glass" type="sphere" size=".3" pos="-.5 -.5 .5" rgba=".3 .8 .9 .5"/>
 </worldbody>
</mujoco>"""

FLEX = """
<mujoco><statistic center="0 0 .3" extent="1.5"/>
 <worldbody>
  <light pos="0 -1 3" dir="0 .3 -1"/>
  <geom type="plane" size="2 2 .1" rgba=".5 .6 .7 1"/>
  <flexcomp name="cloth" type="grid" dim="2" count="9 9 1" spacing=".1 .1 .1" pos="0 0 .5" radius=".01" mass="1" rgba=".9 .5 .2 1">
   <edge equality="true"/>
  </flexcomp>
  <flexcomp name="jelly" type="grid" dim="3" count="4 4 4" spacing=".1 .1 .1" pos=".6 .3 .25" radius=".01" mass="1" rgba=".2 .8 .4 1"/>
 </worldbody>
</mujoco>"""

HEIGHTS = """
<mujoco><statistic center="0 0 .2" extent="2"/>
 <asset><hfield name="h" nrow="48" ncol="48" size="1.5 1.5 .4 .1"/></asset>
 <worldbody><light pos="1 -1 3" dir="-.3 .3 -1"/><geom type="hfield" hfield="h" rgba=".5 .7 .4 1"/></worldbody>
</mujoco>"""

CHAIN = """
<mujoco><statistic center="0 0 .5" extent="1.2"/>
 <visual><quality shadowsize="2048"/></visual>
 <asset><texture name="t" type="2d" builtin="checker" rgb1=".9 .5 .2" rgb2=".2 .2 .2" width="64" height="64"/>
  <material name="m" texture="t" specular=".6"/></asset>
 <worldbody>
  <light pos="0 -1 3" dir="0 .3 -1"/>
  <geom type="plane" size="2 2 .1" rgba=".6 .6 .6 1"/>
  <body name="low" pos="0 0 .2"><joint type="hinge" axis="0 1 0" range="-90 90"/><geom size=".02" mass="1"/>
   <body name="high" pos="0 0 .5"><joint type="hinge" axis="0 1 0"/><geom size=".02" mass="1"/></body></body>
 </worldbody>
 <deformable>
  <skin name="tube" material="m" vertex="%s" face="%s">
   <bone body="low" bindpos="0 0 .2" bindquat="1 0 0 0" vertid="%s" vertweight="%s"/>
   <bone body="high" bindpos="0 0 .7" bindquat="1 0 0 0" vertid="%s" vertweight="%s"/>
  </skin>
 </deformable>
</mujoco>"""

ROWS, ROUND = 12, 16


def tube():
    """A model with a tube as its skin, bent between two bones."""
    corners, weights = [], []
    for row in range(ROWS):
        part = row / (ROWS - 1)
        for k in range(ROUND):
            turn = 2 * math.pi * k / ROUND
            corners += [.12 * math.cos(turn), .12 * math.sin(turn), .1 + .8 * part]
            weights.append(part)
    faces = []
    for row in range(ROWS - 1):
        for k in range(ROUND):
            a, b = row * ROUND + k, row * ROUND + (k + 1) % ROUND
            faces += [a, b, b + ROUND, a, b + ROUND, a + ROUND]

    def words(values):
        return ' '.join('%g' % v for v in values)
    ids = words(range(len(weights)))
    high, low = words(weights), words(1 - w for w in weights)
    return CHAIN % (words(corners), words(faces), ids, low, ids, high)


def pictures(name, model, data=None, labels=False, bend=None):
    """Draws what MuJoCo's Renderer offers; every renderer is a new context."""
    data = data or mujoco.MjData(model)
    if bend:
        data.qpos[:2] = bend
    mujoco.mj_forward(model, data)
    camera = mujoco.MjvCamera()
    mujoco.mjv_defaultFreeCamera(model, camera)
    camera.azimuth, camera.elevation = 110, -25
    option = mujoco.MjvOption()
    if labels:
        option.label = mujoco.mjtLabel.mjLABEL_GEOM
    with mujoco.Renderer(model, SIZE[1], SIZE[0]) as renderer:
        def draw(what):
            renderer.update_scene(data, camera, option)
            pixels = renderer.render()
            if what == 'depth':
                pixels = numpy.clip(pixels / (4 * model.stat.extent), 0, 1)
            elif what == 'segmentation':
                pixels = ((pixels + 1) * [73, 0] @ [[1, 3, 7], [0, 0, 0]] % 251).astype(numpy.uint8)
            drawn.save('%s-%s' % (name, what), pixels)
        draw('colour')
        flags = renderer.scene.flags
        flags[mujoco.mjtRndFlag.mjRND_SHADOW] = 0
        draw('noshadow')
        flags[mujoco.mjtRndFlag.mjRND_FOG] = flags[mujoco.mjtRndFlag.mjRND_HAZE] = 1
        draw('fog')
        flags[mujoco.mjtRndFlag.mjRND_WIREFRAME] = 1
        draw('wireframe')
        flags[mujoco.mjtRndFlag.mjRND_WIREFRAME] = 0
        renderer.enable_depth_rendering()
        draw('depth')
        renderer.disable_depth_rendering()
        renderer.enable_segmentation_rendering()
        draw('segmentation')


def heights():
    model = mujoco.MjModel.from_xml_string(HEIGHTS)
    x, y = numpy.meshgrid(numpy.linspace(-3, 3, 48), numpy.linspace(-3, 3, 48))
    model.hfield_data[:] = (.5 + .25 * numpy.sin(2 * x) + .25 * numpy.cos(3 * y)).ravel()
    return model


def cloth():
    """After some steps: computed by MuJoCo, the same on both sides."""
    model = mujoco.MjModel.from_xml_string(FLEX)
    data = mujoco.MjData(model)
    for _ in range(40):
        mujoco.mj_step(model, data)
    return model, data


pictures('shapes', mujoco.MjModel.from_xml_string(SHAPES))
pictures('labels', mujoco.MjModel.from_xml_string(SHAPES), labels=True)
pictures('heights', heights())
pictures('skin', mujoco.MjModel.from_xml_string(tube()), bend=[.4, -.9])
pictures('flex', *cloth())
drawn.end()
