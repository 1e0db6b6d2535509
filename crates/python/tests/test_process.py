"""Signals, forks, fresh processes, the command."""

from __future__ import annotations

import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
import vitral


def long_renderer() -> vitral.Renderer:
    """A picture of many seconds."""
    light = vitral.Light.disc(center=(3, 5, 3), normal=(-1, -1, -1), radius=1)
    scene = vitral.load("builtin:teapot")
    return vitral.Renderer(scene, height=4000, width=4000, samples=32, shadows="ray", light_samples=16, light=[light])


def test_ctrl_c_ends_a_long_picture() -> None:
    renderer = long_renderer()
    sent = 0.0

    def interrupt() -> None:
        nonlocal sent
        sent = time.monotonic()
        os.kill(os.getpid(), signal.SIGINT)

    timer = threading.Timer(1.0, interrupt)
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        renderer.render()
    late = time.monotonic() - sent
    timer.join()
    print(f"Ctrl-C took {late:.3f} s")
    # 0.2 s on a machine with nothing else to do.
    assert late < 2.0
    small = vitral.Renderer(renderer.scene, height=16, width=16)
    assert small.render().shape == (16, 16, 3), "the next picture is made"


def render_small(renderer: vitral.Renderer) -> np.ndarray:
    """In another process."""
    return renderer.render()


_inherited: vitral.Renderer | None = None


def render_inherited(_: int) -> np.ndarray:
    """With a renderer that a fork took over."""
    assert _inherited is not None
    return _inherited.render()


@pytest.mark.parametrize("method", ["fork", "spawn"])
def test_other_processes_make_the_same_picture(method: str) -> None:
    global _inherited
    renderer = vitral.Renderer(vitral.load("builtin:teapot"), height=24, width=32, threads=2)
    expected = renderer.render()
    context = multiprocessing.get_context(method)
    with context.Pool(2) as pool:
        for picture in pool.map(render_small, [renderer] * 3):
            assert np.array_equal(picture, expected)
    if method == "fork":
        _inherited = renderer
        with context.Pool(2) as pool:
            for picture in pool.map(render_inherited, range(3)):
                assert np.array_equal(picture, expected)
        assert np.array_equal(renderer.render(), expected)


def run(*arguments: str) -> subprocess.CompletedProcess[str]:
    """The command, as ``python -m vitral``."""
    return subprocess.run([sys.executable, "-m", "vitral", *arguments], capture_output=True, text=True)


def test_the_command_is_the_program() -> None:
    version = run("--version")
    assert (version.returncode, version.stdout.strip()) == (0, f"vitral {vitral.__version__}")
    info = run("info", "builtin:cubs")
    assert info.returncode == 0 and "triangles" in info.stdout
    wrong = run("render", "missing.obj", "-o", "a.png")
    assert wrong.returncode == 3 and wrong.stderr.startswith("vitral: missing.obj")


def test_importing_takes_little_time() -> None:
    def seconds(code: str) -> float:
        def once() -> float:
            start = time.perf_counter()
            subprocess.run([sys.executable, "-c", code], check=True)
            return time.perf_counter() - start

        return min(once() for _ in range(3))

    over_numpy = seconds("import vitral") - seconds("pass")
    print(f"import vitral: {over_numpy:.3f} s")
    # 0.15 s on a machine with nothing else to do.
    assert over_numpy < 1.5
