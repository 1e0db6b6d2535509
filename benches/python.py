"""Measures the Python package: import, render() against the Rust API, batches against MuJoCo with Mesa and a loop over F3D.

Run with the package installed: ``python benches/python.py [--models FOLDER]``. The Rust API is that of ``vitral bench``. MuJoCo is
measured where it is installed with PyOpenGL, and draws with the libOSMesa that the system has; F3D where it is on the path, by Xvfb
where there is no display.
"""

from __future__ import annotations

import argparse
import importlib.util
import json
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import vitral

#: How many pictures a batch has, and of which size.
PICTURES, SIDE = 1000, 84

#: Pictures of a turntable, of which each is made in turns by Python and by Rust.
TURN = 24

#: A ball of 250 triangles, as a program that MuJoCo's part of this bench has, too.
BALL = """
import numpy as np
def ball():
    u, v = np.meshgrid(np.arange(13), np.arange(11))
    theta, phi = u / 12 * 2 * np.pi, v / 10 * np.pi
    points = np.stack([np.cos(theta) * np.sin(phi), np.cos(phi), -np.sin(theta) * np.sin(phi)], -1).reshape(-1, 3)
    first = np.array([row * 13 + column for row in range(10) for column in range(12)])
    faces = np.concatenate([np.stack([first, first + 13, first + 14], 1), np.stack([first, first + 14, first + 1], 1)])
    return points, faces
"""

#: MuJoCo's pictures of 20 such balls, of which each moves.
MUJOCO = (
    BALL
    + """
import time, mujoco
points, faces = ball()
text = lambda values: " ".join(f"{value:.6g}" for value in values.reshape(-1))
bodies = "".join(
    f'<body mocap="true" pos="{i % 5 * 2.5} {i // 5 * 2.5} 0"><geom type="mesh" mesh="ball"/></body>' for i in range(20)
)
model = mujoco.MjModel.from_xml_string(
    f'<mujoco><visual><quality shadowsize="0" offsamples="0"/></visual>'
    f'<asset><mesh name="ball" inertia="shell" vertex="{text(points)}" face="{text(faces)}"/></asset>'
    f'<worldbody><light pos="5 5 20" dir="0 0 -1" castshadow="false"/>{bodies}</worldbody></mujoco>'
)
data = mujoco.MjData(model)
camera = mujoco.MjvCamera()
camera.lookat[:] = 5, 3.75, 0
camera.distance, camera.elevation = 20, -30
with mujoco.Renderer(model, SIDE, SIDE) as renderer:
    def picture(i):
        data.mocap_pos[:, 2] = i / PICTURES
        mujoco.mj_forward(model, data)
        camera.azimuth = i * 360 / PICTURES
        renderer.update_scene(data, camera)
        return renderer.render()
    assert np.ptp(picture(0)) > 50
    for i in range(10): picture(i)
    start, before = time.perf_counter(), time.process_time()
    for i in range(PICTURES): picture(i)
    print(PICTURES / (time.perf_counter() - start), (time.process_time() - before) / PICTURES * 1e3)
"""
)


def timed(work: Callable[[], object]) -> float:
    """Seconds."""
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def processor(code: str) -> float:
    """Milliseconds of processors that a fresh interpreter takes."""

    def once() -> float:
        before = children()
        subprocess.run([sys.executable, "-c", code], check=True)
        return children() - before

    return min(once() for _ in range(5)) * 1e3


def children() -> float:
    """Seconds of processors of all processes that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def rust(size: str) -> list[float]:
    """Seconds of each picture of a turntable by the Rust API, as the command tells them."""
    with tempfile.TemporaryDirectory() as scratch:
        words = [sys.executable, "-m", "vitral", "render", "builtin:teapot", "--turntable", str(TURN), "--resolution", size]
        words += ["--threads", "1", "--output", f"{scratch}/{{frame}}.ppm", "--stats-file", f"{scratch}/stats", "--quiet"]
        subprocess.run(words, check=True)
        stats = json.loads((Path(scratch) / "stats").read_text())
    return [frame["seconds"]["total"] for frame in stats["frames"]]


def articulated() -> vitral.Scene:
    """20 instances of a ball, 5,000 triangles in all."""
    names: dict[str, Callable[[], tuple[np.ndarray, np.ndarray]]] = {}
    exec(BALL, names)
    scene = vitral.Scene()
    mesh = scene.add_mesh(*names["ball"]())
    for i in range(20):
        transform = np.eye(4)
        transform[:3, 3] = i % 5 * 2.5, i // 5 * 2.5, 0
        scene.add_instance(mesh, transform)
    return scene


def single_pictures() -> None:
    """render() beside the Rust API, in turns; of each picture the best of three."""
    teapot = vitral.load("builtin:teapot")
    for width, height in ((64, 64), (640, 480)):
        renderer = vitral.Renderer(teapot, height=height, width=width, threads=1)
        cameras = renderer.turntable_cameras(TURN)
        ours, theirs = [], []
        for _ in range(3):
            ours.append([timed(lambda r=renderer, c=camera: r.render(c)) for camera in cameras])
            theirs.append(rust(f"{width}x{height}"))
        python, native = (sum(map(min, zip(*rounds, strict=True))) / TURN * 1e3 for rounds in (ours, theirs))
        print(f"render() {width} x {height}: {python:.3f} ms, Rust {native:.3f} ms, ratio {python / native:.2f}")


def batches() -> None:
    """render_batch of a scene that moves, with one and two threads, beside MuJoCo."""
    scene = articulated()
    triangles = scene.info()["triangles"]
    print(f"batch of {PICTURES} cameras at {SIDE} x {SIDE}, {len(scene)} instances, {triangles} triangles:")
    transforms = np.tile(scene.transforms, (PICTURES, 1, 1, 1))
    transforms[:, :, 2, 3] += np.linspace(0, 1, PICTURES)[:, None]
    rates, processors = {}, {}
    for threads in (1, 2):
        renderer = vitral.Renderer(scene, height=SIDE, width=SIDE, samples=1, threads=threads)
        cameras = renderer.turntable_cameras(PICTURES)
        renderer.render_batch(cameras[:10])
        for name, moved in (("still", None), ("moving", transforms)):
            before = time.process_time()
            seconds = timed(lambda r=renderer, c=cameras, m=moved: r.render_batch(c, m))
            each = (time.process_time() - before) / PICTURES * 1e3
            rates[threads, name] = PICTURES / seconds
            processors[threads, name] = each
            print(f"  {threads} threads, {name}: {rates[threads, name]:.0f} pictures a second, {each:.2f} ms of processors each")
    for name in ("still", "moving"):
        print(f"  2 threads are {rates[2, name] / rates[1, name]:.2f} times as fast, {name}")
    if any(importlib.util.find_spec(name) is None for name in ("mujoco", "OpenGL")):
        print("  MuJoCo or PyOpenGL is not installed: not compared")
        return
    environment = {**os.environ, "MUJOCO_GL": "osmesa", "PYOPENGL_PLATFORM": "osmesa"}
    program = f"PICTURES, SIDE = {PICTURES}, {SIDE}\n{MUJOCO}"
    ended = subprocess.run([sys.executable, "-c", program], env=environment, capture_output=True, text=True)
    if ended.returncode:
        print(f"  MuJoCo failed: {ended.stderr.strip().splitlines()[-1]}")
        return
    rate, each = map(float, ended.stdout.split())
    print(f"  mujoco.Renderer, moving: {rate:.0f} pictures a second, {each:.2f} ms of processors each;", end=" ")
    by_processors = each / processors[1, "moving"]
    print(f"ours are {rates[2, 'moving'] / rate:.2f} times as fast, by processors {by_processors:.2f} times")


def model_files(folder: Path | None, count: int) -> list[Path]:
    """So many small models: those of the folder, over and over, or balls."""
    small = []
    if folder is not None:
        kinds = (".obj", ".stl", ".ply", ".off", ".glb")
        found = sorted(path for path in folder.rglob("*") if path.suffix in kinds and path.stat().st_size < 300_000)
        small = [path for path in found if "malformed" not in path.parts]
    return [small[i % len(small)] for i in range(count)] if small else []


def files(folder: Path | None, count: int) -> None:
    """``vitral batch`` of small models beside its parts and a shell loop over F3D."""
    with tempfile.TemporaryDirectory() as name:
        # Copy models, each of which is read once.
        scratch = Path(name)
        sources = model_files(folder, count)
        if not sources:
            points, faces = (lambda names: (exec(BALL, names), names["ball"]())[1])({})
            lines = ["v {} {} {}".format(*point) for point in points] + ["f {} {} {}".format(*face) for face in faces + 1]
            (scratch / "ball.obj").write_text("\n".join(lines) + "\n")
            sources = [scratch / "ball.obj"] * count
        models = scratch / "models"
        models.mkdir()
        for i, source in enumerate(sources):
            shutil.copyfile(source, models / f"{i:03}{source.suffix}")

        # Time the batch, and the same pictures by one process with as many threads.
        command = [sys.executable, "-m", "vitral", "batch", "--glob", f"{models}/*", "--output", f"{scratch}/{{model}}.png"]
        command += ["--resolution", "256x256", "--json", "--quiet", "--record", f"{scratch}/record"]
        start, before = time.perf_counter(), children()
        ended = subprocess.run(command, capture_output=True, text=True)
        seconds, processors = time.perf_counter() - start, children() - before
        rows = [json.loads(line) for line in ended.stdout.splitlines()]
        done = [row for row in rows if row["status"] == "done"]
        parts = sum(row["seconds"] for row in done) / (os.cpu_count() or 1)
        print(f"vitral batch: {len(done)} of {len(rows)} models in {seconds:.2f} s, {len(done) / seconds:.0f} a second;", end=" ")
        print(f"the jobs themselves {parts:.2f} s on {os.cpu_count()} processors, ratio {seconds / parts:.2f};", end=" ")
        print(f"{processors:.2f} s of processors")

        # The loop, with one display for all.
        if shutil.which("f3d") is None:
            print("f3d is not on the path: not compared")
            return
        loop = 'for model in "$1"/*; do f3d --quiet --resolution=256,256 --output="$2/f3d.png" "$model" || true; done'
        words = ["sh", "-c", loop, "sh", str(models), str(scratch)]
        if "DISPLAY" not in os.environ:
            words = ["xvfb-run", "-a", *words]
        start, before = time.perf_counter(), children()
        subprocess.run(words, check=True, capture_output=True)
        theirs, used = time.perf_counter() - start, children() - before
        print(f"a loop over f3d: {theirs:.2f} s, {theirs / seconds:.1f} times as long;", end=" ")
        print(f"{used:.2f} s of processors, {used / processors:.1f} times as much")


def main() -> None:
    """Prints the figures."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--models", type=Path, help="a folder of models for the batch of files [default: balls]")
    parser.add_argument("--count", type=int, default=200, help="how many models [default: 200]")
    arguments = parser.parse_args()
    empty, numpy = processor("pass"), processor("import numpy")
    print(f"import vitral: {processor('import vitral') - empty:.0f} ms of processors over an empty program,", end=" ")
    print(f"numpy alone {numpy - empty:.0f} ms")
    single_pictures()
    batches()
    files(arguments.models, arguments.count)


if __name__ == "__main__":
    main()
