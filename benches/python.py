"""Measures the Python package: import, render() against the Rust API, render_batch with 1 and 2 threads.

Run with the package installed: ``python benches/python.py``. The Rust API is that of ``vitral bench``.
"""

from __future__ import annotations

import json
import statistics
import subprocess
import sys
import time
from collections.abc import Callable

import numpy as np
import vitral


def median(work: Callable[[], object], times: int) -> float:
    """Milliseconds."""
    work()
    seconds = []
    for _ in range(times):
        start = time.perf_counter()
        work()
        seconds.append(time.perf_counter() - start)
    return statistics.median(seconds) * 1e3


def process(code: str) -> float:
    """Milliseconds of a fresh interpreter."""
    return min(median(lambda: subprocess.run([sys.executable, "-c", code], check=True), 3) for _ in range(3))


def rust(size: str) -> float:
    """Milliseconds of a picture by the Rust API."""
    words = [sys.executable, "-m", "vitral", "bench", "builtin:teapot", "--visibility", "z-buffer", "--json"]
    words += ["--resolution", size, "--samples", "4", "--frames", "50", "--quiet"]
    report = json.loads(subprocess.run(words, capture_output=True, text=True, check=True).stdout)
    row = next(row for row in report["algorithms"] if row["algorithm"] == "z-buffer")
    return float(row["median-seconds"]) * 1e3


def articulated() -> vitral.Scene:
    """20 instances of a ball, 5,000 triangles in all."""
    scene = vitral.Scene()
    u, v = np.meshgrid(np.arange(13), np.arange(11))
    theta, phi = u / 12 * 2 * np.pi, v / 10 * np.pi
    points = np.stack([np.cos(theta) * np.sin(phi), np.cos(phi), -np.sin(theta) * np.sin(phi)], -1).reshape(-1, 3)
    first = np.array([row * 13 + column for row in range(10) for column in range(12)])
    faces = np.concatenate([np.stack([first, first + 13, first + 14], 1), np.stack([first, first + 14, first + 1], 1)])
    mesh = scene.add_mesh(points, faces)
    for i in range(20):
        transform = np.eye(4)
        transform[:3, 3] = i % 5 * 2.5, i // 5 * 2.5, 0
        scene.add_instance(mesh, transform)
    return scene


def main() -> None:
    """Prints the table."""
    print(f"import vitral: {process('import vitral') - process('pass'):.0f} ms over an empty program,", end=" ")
    print(f"numpy alone {process('import numpy') - process('pass'):.0f} ms")
    teapot = vitral.load("builtin:teapot")
    for width, height in ((64, 64), (640, 480)):
        renderer = vitral.Renderer(teapot, height=height, width=width)
        camera = renderer.camera
        ours = median(lambda r=renderer, c=camera: r.render(c), 50)
        print(f"render() {width} x {height}: {ours:.3f} ms, Rust {rust(f'{width}x{height}'):.3f} ms")
    scene = articulated()
    print(f"batch of 1,000 cameras at 84 x 84, {len(scene)} instances, {scene.info()['triangles']} triangles:")
    transforms = np.tile(scene.transforms, (1000, 1, 1, 1))
    transforms[:, :, 2, 3] += np.linspace(0, 1, 1000)[:, None]
    seconds = {}
    for threads in (1, 2):
        renderer = vitral.Renderer(scene, height=84, width=84, samples=1, threads=threads)
        cameras = renderer.turntable_cameras(1000)
        renderer.render_batch(cameras[:10])
        for name, moved in (("still", None), ("moving", transforms)):
            start = time.perf_counter()
            renderer.render_batch(cameras, moved)
            seconds[threads, name] = time.perf_counter() - start
            print(f"  {threads} threads, {name}: {1000 / seconds[threads, name]:.0f} pictures a second")
    for name in ("still", "moving"):
        print(f"  2 threads are {seconds[1, name] / seconds[2, name]:.2f} times as fast, {name}")


if __name__ == "__main__":
    main()
