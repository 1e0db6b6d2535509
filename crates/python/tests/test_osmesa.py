"""Other people's programs on vitral's OpenGL, each in a fresh process. What is not installed is skipped."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from pathlib import Path

import pytest
import vitral.osmesa

LIBRARY = Path(vitral.osmesa.__file__).parent / "lib" / "libOSMesa.so.8"

pytestmark = pytest.mark.skipif(not LIBRARY.exists(), reason="the package was built without libOSMesa")

INSTALL = "import vitral.osmesa\nvitral.osmesa.install()\n"

MODEL = """
<mujoco><worldbody>
  <light pos="0 0 4"/>
  <geom type="sphere" size=".5" rgba="1 0 0 1"/>
  <camera name="eye" pos="0 -3 0" xyaxes="1 0 0 0 0 1"/>
</worldbody></mujoco>
"""

MUJOCO = f'''
import mujoco
model = mujoco.MjModel.from_xml_string("""{MODEL}""")
data = mujoco.MjData(model)
mujoco.mj_forward(model, data)
with mujoco.Renderer(model, 48, 64) as renderer:
    renderer.update_scene(data, camera="eye")
    pixels = renderer.render()
red, green, blue = pixels[24, 32].tolist()
assert pixels.shape == (48, 64, 3) and red > 50 and green < red / 2, pixels[24, 32]
'''

GYMNASIUM = """
import gymnasium
import numpy

def make():
    return gymnasium.make("InvertedPendulum-v5", render_mode="rgb_array", width=64, height=48)

if __name__ == "__main__":
    for context in ("fork", "spawn"):
        environments = gymnasium.vector.AsyncVectorEnv([make] * 2, context=context)
        environments.reset(seed=1)
        pictures = environments.render()
        environments.close()
        assert len(pictures) == 2 and pictures[0].shape == (48, 64, 3)
        assert numpy.ptp(pictures[0]) > 50 and (pictures[0] == pictures[1]).mean() > 0.9
"""

DM_CONTROL = """
from dm_control import mujoco
try:
    physics = mujoco.Physics.from_xml_string(MODEL)
except AttributeError as error:
    raise SystemExit(f"skip: this dm_control does not suit this mujoco: {error}")
pixels = physics.render(48, 64, camera_id=0)
red, green, blue = pixels[24, 32].tolist()
assert pixels.shape == (48, 64, 3) and red > 100 and green < red / 2, pixels[24, 32]
"""

PYOPENGL = """
import ctypes
import numpy
from OpenGL import GL, arrays
from OpenGL.osmesa import OSMesaCreateContextExt, OSMesaMakeCurrent
context = OSMesaCreateContextExt(GL.GL_RGBA, 24, 0, 0, None)
pixels = arrays.GLubyteArray.zeros((8, 8, 4))
assert OSMesaMakeCurrent(context, pixels, GL.GL_UNSIGNED_BYTE, 8, 8)
assert b"vitral" in GL.glGetString(GL.GL_RENDERER).lower() + GL.glGetString(GL.GL_VENDOR).lower()
GL.glClearColor(1, 0.5, 0, 1)
GL.glClear(GL.GL_COLOR_BUFFER_BIT)
GL.glFinish()
assert pixels[4, 4].tolist() == [255, 128, 0, 255], pixels[4, 4]
"""

GLFW = """
import glfw
glfw.init_hint(glfw.PLATFORM, glfw.PLATFORM_NULL)
if not glfw.init():
    raise SystemExit("skip: this glfw has no null platform")
glfw.window_hint(glfw.CONTEXT_CREATION_API, glfw.OSMESA_CONTEXT_API)
window = glfw.create_window(16, 16, "a", None, None)
assert window
glfw.make_context_current(window)
assert glfw.get_proc_address("glClear")
"""

ROBOSUITE = """
import numpy
import robosuite
environment = robosuite.make(
    "Lift",
    robots="Panda",
    has_renderer=False,
    has_offscreen_renderer=True,
    use_camera_obs=True,
    camera_names="agentview",
    camera_heights=64,
    camera_widths=64,
)
pixels = environment.reset()["agentview_image"]
environment.close()
assert pixels.shape == (64, 64, 3) and numpy.ptp(pixels) > 100 and len(numpy.unique(pixels)) > 50
"""

PROGRAMS = {
    "mujoco": ("mujoco", MUJOCO),
    "gymnasium": ("gymnasium", GYMNASIUM),
    "dm_control": ("dm_control", f'MODEL = """{MODEL}"""\n' + DM_CONTROL),
    "PyOpenGL": ("OpenGL", PYOPENGL),
    "glfw": ("glfw", GLFW),
    "robosuite": ("robosuite", ROBOSUITE),
}


def run(*arguments: str) -> subprocess.CompletedProcess[str]:
    """A Python with these arguments."""
    return subprocess.run([sys.executable, *arguments], capture_output=True, text=True)


@pytest.mark.parametrize("name", PROGRAMS)
@pytest.mark.parametrize("way", ["install", "run", "shell"])
def test_a_program_draws(name: str, way: str, tmp_path: Path) -> None:
    module, text = PROGRAMS[name]
    if importlib.util.find_spec(module) is None or (name == "gymnasium" and importlib.util.find_spec("mujoco") is None):
        pytest.skip(f"{name} is not installed")
    program = tmp_path / "program.py"
    program.write_text(INSTALL + text if way == "install" else text)
    if way == "shell":
        line = 'eval "$("$0" -m vitral osmesa-env)" && exec "$0" "$1"'
        ended = subprocess.run(["sh", "-c", line, sys.executable, str(program)], capture_output=True, text=True)
    else:
        ended = run(*(["-m", "vitral.osmesa"] if way == "run" else []), str(program))
    if "skip: " in ended.stderr:
        pytest.skip(ended.stderr.split("skip: ")[1].strip())
    assert ended.returncode == 0, ended.stderr


def test_install_says_when_it_is_late() -> None:
    late = "import sys, types\nsys.modules['OpenGL.GL'] = types.ModuleType('OpenGL.GL')\n" + INSTALL
    ended = run("-c", late)
    assert ended.returncode == 1 and "OpenGL is imported already" in ended.stderr
    assert run("-c", INSTALL + INSTALL).returncode == 0


def test_both_names_are_one_library() -> None:
    code = (
        INSTALL + "import ctypes\n"
        "shim = ctypes.CDLL(str(vitral.osmesa.folder() / 'libOSMesa.so'))\n"
        "main = ctypes.CDLL('libOSMesa.so.8')\n"
        "address = lambda lib: ctypes.cast(lib.OSMesaCreateContext, ctypes.c_void_p).value\n"
        "assert address(shim) == address(main)\n"
    )
    ended = run("-c", code)
    assert ended.returncode == 0, ended.stderr


def test_the_command_finds_the_library() -> None:
    ended = run("-m", "vitral", "osmesa-env")
    assert ended.returncode == 0 and str(LIBRARY.parent.resolve()) in ended.stdout
