"""Pictures on a cluster: Ray for real, with two processors. Skipped where ray is not installed."""

from __future__ import annotations

import importlib.util
import json
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import vitral
from vitral import UsageError

if importlib.util.find_spec("ray") is None:
    pytest.skip("ray is not installed", allow_module_level=True)

import vitral.ray


@pytest.fixture(scope="module", autouse=True)
def cluster() -> Iterator[None]:
    """A cluster of this machine."""
    import ray

    ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False, logging_level="error")
    ray.data.DataContext.get_current().enable_progress_bars = False
    yield
    ray.shutdown()


def job(number: int, **options: Any) -> dict[str, Any]:
    """A small picture of one of two models, from a direction of its own."""
    model = ("builtin:teapot", "builtin:cubs")[number % 2]
    seen = {"resolution": [24, 16], "camera-azimuth-angle": number * 0.72, **options}
    return {"model": model, "output": f"out/{number}.png", "options": seen, "id": f"picture {number}"}


def write(folder: Path, jobs: list[dict[str, Any]]) -> Path:
    """The file of these jobs."""
    folder.mkdir(exist_ok=True)
    path = folder / "jobs.jsonl"
    path.write_text("".join(json.dumps(job) + "\n" for job in jobs))
    return path


def batch(folder: Path, *words: str) -> list[dict[str, Any]]:
    """What ``vitral batch`` tells of the jobs of a folder."""
    command = [sys.executable, "-m", "vitral", "batch", "jobs.jsonl", "--json", "--quiet", *words]
    ended = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    assert ended.returncode in (0, 1), ended.stderr
    return [json.loads(line) for line in ended.stdout.splitlines()]


def pictures(folder: Path) -> dict[str, bytes]:
    """The files that are there."""
    return {path.name: path.read_bytes() for path in sorted((folder / "out").glob("*.png"))}


def test_five_hundred_pictures_are_those_of_a_batch(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    jobs = [job(number) for number in range(500)]
    write(tmp_path / "batch", jobs)
    assert len(batch(tmp_path / "batch")) == 500
    path = write(tmp_path / "ray", jobs)
    monkeypatch.chdir(tmp_path / "ray")
    rows = vitral.ray.render(path).take_all()
    assert {row["id"] for row in rows} == {job["id"] for job in jobs}
    assert {(row["status"], row["code"], row["message"]) for row in rows} == {("done", 0, "")}
    assert json.loads(rows[0]["outputs"]) and rows[0]["seconds"] > 0
    expected = pictures(tmp_path / "batch")
    assert len(expected) == 500 and pictures(tmp_path / "ray") == expected

    # Nothing is left to do, for whoever asks.
    assert {row["status"] for row in vitral.ray.render(path).take_all()} == {"skipped"}
    assert {line["status"] for line in batch(tmp_path / "ray")} == {"skipped"}


def worker_of(record: Path) -> int | None:
    """The process that does jobs of a record."""
    for entry in Path("/proc").glob("[0-9]*"):
        try:
            words = (entry / "cmdline").read_bytes().split(b"\0")
        except OSError:
            continue
        if b"batch-worker" in words and str(record).encode() in words:
            return int(entry.name)
    return None


def parent_of(process: int) -> int:
    """Who started a process."""
    return int((Path("/proc") / str(process) / "stat").read_text().rpartition(")")[2].split()[1])


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="processes are looked for in /proc")
def test_an_actor_that_is_killed_costs_time_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    jobs = [job(number, resolution=[256, 192]) for number in range(200)]
    write(tmp_path / "batch", jobs)
    batch(tmp_path / "batch")
    path = write(tmp_path / "ray", jobs)
    monkeypatch.chdir(tmp_path / "ray")
    killed: list[int] = []

    def kill() -> None:
        # Wait for the first pictures, then kill an actor at work.
        until = time.monotonic() + 60
        while not killed and time.monotonic() < until:
            worker = worker_of(tmp_path / "ray" / "jobs.done.jsonl")
            if worker is not None and len(pictures(tmp_path / "ray")) > 20:
                killed.append(parent_of(worker))
                os.kill(killed[0], signal.SIGKILL)
            time.sleep(0.01)

    killer = threading.Thread(target=kill)
    killer.start()
    rows = vitral.ray.render(path, actors=2).take_all()
    killer.join()
    assert killed, "no actor was found at work"
    assert [row["status"] for row in rows] == ["done"] * 200
    assert pictures(tmp_path / "ray") == pictures(tmp_path / "batch")
    assert {line["status"] for line in batch(tmp_path / "ray")} == {"skipped"}


def test_bad_jobs_do_not_end_the_others(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    jobs = [job(number) for number in range(40)]
    jobs[3]["options"]["sampels"] = 4
    jobs[11]["model"] = "missing.obj"
    # Reading ends the process where memory runs out.
    corners = "".join(f"v {i} {i * i % 7} {i % 3}\n" for i in range(60_000))
    (tmp_path / "large.obj").write_text(corners + "".join(f"f {i} {i + 1} {i + 2}\n" for i in range(1, 59_000)))
    jobs[17] = {**jobs[17], "model": "large.obj", "options": {"resolution": [24, 16], "max-memory": "1M"}}
    path = write(tmp_path, jobs)
    monkeypatch.chdir(tmp_path)
    rows = {row["id"]: row for row in vitral.ray.render(path).take_all()}
    failed = {row["id"]: (row["code"], row["message"]) for row in rows.values() if row["status"] == "failed"}
    assert len(rows) == 40 and set(failed) == {"picture 3", "picture 11", "picture 17"}, failed
    assert failed["picture 3"][0] == 2 and "sampels" in failed["picture 3"][1]
    assert failed["picture 11"][0] == 3 and "missing.obj" in failed["picture 11"][1]
    assert failed["picture 17"][0] == 7, failed
    assert len(pictures(tmp_path)) == 37

    # Options that no job can have are told before anything is done.
    with pytest.raises(UsageError, match="sampels"):
        vitral.ray.render(path, sampels=4)
    with pytest.raises(UsageError, match="both write"):
        vitral.ray.render([job(1), job(1)])


def test_what_a_batch_began_is_finished(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = write(tmp_path, [job(number) for number in range(60)])
    begun = {line["id"] for line in batch(tmp_path, "--shard", "1/2", "--samples", "1")}
    assert 10 < len(begun) < 50
    monkeypatch.chdir(tmp_path)
    command = [sys.executable, "-m", "vitral.ray", str(path), "--json", "--samples", "1", "--actors", "1"]
    ended = subprocess.run(command, capture_output=True, text=True)
    assert ended.returncode == 0, ended.stderr
    rows = [json.loads(line) for line in ended.stdout.splitlines()]
    assert {row["id"] for row in rows if row["status"] == "skipped"} == begun
    assert sum(row["status"] == "done" for row in rows) == 60 - len(begun)
    assert f"{60 - len(begun)} done, {len(begun)} skipped, 0 failed" in ended.stderr
    assert {line["status"] for line in batch(tmp_path, "--samples", "1")} == {"skipped"}


def test_a_scene_is_rendered_for_each_row(two_squares: vitral.Scene) -> None:
    renderer = vitral.Renderer(two_squares, height=24, width=32)
    cameras = renderer.turntable_cameras(20)
    moved = np.tile(two_squares.transforms, (20, 1, 1, 1))
    moved[:, 1, 0, 3] += np.linspace(-1, 1, 20)
    rows = [
        {"number": number, "world_from_camera": camera.world_from_camera, "transforms": transforms}
        for number, (camera, transforms) in enumerate(zip(cameras, moved, strict=True))
    ]
    rows[7]["world_from_camera"] = np.zeros((4, 4))
    wanted: Any = ("rgb", "depth", "ids")
    done = vitral.ray.render(rows, scene=two_squares, channels=wanted, batch_size=4, height=24, width=32).take_all()
    assert sorted(row["number"] for row in done) == list(range(20))
    seen = [vitral.Camera.from_matrix(camera.world_from_camera) for camera in cameras]
    expected = renderer.render_batch(seen, moved, channels=wanted)
    for row in done:
        if row["number"] == 7:
            assert row["error"] and not row["rgb"].any()
            continue
        assert row["error"] == ""
        for name, planes in zip(wanted, expected, strict=True):
            assert row[name].dtype == planes.dtype and np.array_equal(row[name], planes[row["number"]]), name
