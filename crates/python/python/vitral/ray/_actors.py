"""What runs on the machines of a cluster."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from typing import Any

import numpy as np

from .._errors import Error
from .._vitral import Camera, Renderer, Scene, load
from ._plan import row

#: Exit code of a job whose process ended.
_BROUGHT_DOWN = 1

#: What a row may say of its camera besides where it is.
_LENS = ("intrinsics", "view_angle", "near", "far")


class Jobs:
    """Does jobs of ``vitral batch`` in a process that keeps its models."""

    def __init__(self, record: str, threads: int, folder: str) -> None:
        self._command = [sys.executable, "-m", "vitral", "batch-worker", "--record", record, f"--threads={threads}"]
        self._folder = folder
        self._process: subprocess.Popen[str] | None = None

    def __call__(self, batch: dict[str, Any]) -> dict[str, Any]:
        """Does the jobs of the column ``order``."""
        orders = [str(order) for order in batch["order"]]
        rows = [self._done(order) for order in orders]
        return {name: np.array([one[name] for one in rows]) for name in rows[0]} if rows else {}

    def _done(self, order: str) -> dict[str, Any]:
        """What came of a job."""
        process = self._process or self._start()
        reply = ""
        try:
            print(order, file=process.stdin, flush=True)
            reply = process.stdout.readline() if process.stdout else ""
        except BrokenPipeError:
            pass
        if not reply:
            # A job that brings its process down leaves the others alone.
            code = process.wait()
            self._process = None
            reply = json.dumps(
                {
                    "code": code if 0 < code < 256 else _BROUGHT_DOWN,
                    "outputs": [],
                    "told": [f"it brought its process down: exit code {code}"],
                    "seconds": 0.0,
                }
            )
        told = json.loads(reply)
        name, code, message = json.loads(order)["id"], told["code"], "; ".join(told["told"])
        return row(name, "failed" if code else "done", code, message, told["outputs"], told["seconds"])

    def _start(self) -> subprocess.Popen[str]:
        # Paths of jobs begin where the driver is.
        os.makedirs(self._folder, exist_ok=True)
        pipe = subprocess.PIPE
        self._process = subprocess.Popen(self._command, cwd=self._folder, stdin=pipe, stdout=pipe, text=True)
        return self._process


class Views:
    """Renders a scene from the cameras of its rows."""

    def __init__(self, scene: Any, channels: list[str], options: dict[str, Any]) -> None:
        if not isinstance(scene, (str, Scene)):
            import ray

            scene = ray.get(scene)
        self._renderer = Renderer(load(scene) if isinstance(scene, str) else scene, **options)
        self._channels: Any = channels
        self._home = np.array(self._renderer.scene.transforms)

    def __call__(self, batch: dict[str, Any]) -> dict[str, Any]:
        """Adds a column for each channel, and one for what went wrong."""
        count = len(next(iter(batch.values())))
        pictures: list[list[Any]] = [[] for _ in self._channels]
        errors = []
        for number in range(count):
            planes, error = self._rendered({name: column[number] for name, column in batch.items()})
            errors.append(error)
            for column, plane in zip(pictures, planes, strict=True):
                column.append(plane)
        columns = {name: np.stack(planes) for name, planes in zip(self._channels, pictures, strict=True)}
        return {**batch, **columns, "error": np.array(errors)}

    def _rendered(self, view: dict[str, Any]) -> tuple[tuple[Any, ...], str]:
        """The planes of a row, and why they are empty if they are."""
        try:
            lens = {name: view[name] for name in _LENS if view.get(name) is not None}
            camera = Camera.from_matrix(np.array(view["world_from_camera"].tolist()), **lens)
            moved = view.get("transforms")
            transforms = self._home if moved is None else np.array(moved.tolist())
            planes = self._renderer.render_batch([camera], transforms[None], channels=self._channels)
            return tuple(plane[0] for plane in planes), ""
        except (Error, ValueError, TypeError, KeyError) as error:
            empty = self._renderer.render_batch([None], channels=self._channels)
            return tuple(np.zeros_like(plane[0]) for plane in empty), f"{type(error).__name__}: {error}"
