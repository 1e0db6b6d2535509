"""Pictures on a cluster, by Ray Data: ``pip install "vitral[ray]"``.

:func:`render` does jobs of ``vitral batch``, as does ``python -m vitral.ray JOBS.jsonl``. With ``scene=`` it renders a
scene for each row of a dataset of cameras.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from .._errors import UsageError
from .._vitral import Scene
from . import _plan
from ._actors import Jobs, Views

if TYPE_CHECKING:
    from ray.data import Dataset

__all__ = ["render"]

_Path: TypeAlias = "str | os.PathLike[str]"


def render(
    jobs: _Path | Iterable[Mapping[str, Any]] | Dataset,
    scene: Scene | _Path | None = None,
    *,
    channels: str | Sequence[str] | None = None,
    record: _Path | None = None,
    actors: int | tuple[int, int] | None = None,
    threads: int = 1,
    batch_size: int = 16,
    **options: Any,
) -> Dataset:
    """Renders on all machines of a Ray cluster; gives a dataset, which is computed when it is read.

    Without ``scene``, ``jobs`` are those of ``vitral batch``: a file of JSON lines, or dicts with ``model``,
    ``output``, ``options`` and ``id``, or a dataset of these. Each writes its file; all machines need the folders. What
    ``record`` has (``JOBS.done.jsonl``, or ``batch.done.jsonl`` where there is no file) is skipped, and what is done is
    added there, as ``vitral batch`` does. The rows: ``id``; ``status``, which is ``"done"``, ``"skipped"`` or
    ``"failed"``; ``code``, the exit code; ``message``; ``outputs``, the paths as JSON; ``seconds``.

    With ``scene``, a :class:`vitral.Scene` or the path of a model on each machine, ``jobs`` are rows of cameras:
    ``world_from_camera`` (4, 4), and where they are there ``intrinsics`` (3, 3), ``view_angle`` in degrees, ``near``
    and ``far``, and ``transforms`` (K, 4, 4) of the scene's instances. The rows come back with a column for each of
    ``channels`` as :meth:`vitral.Renderer.render` has them, and ``error``, which is empty where there is none.

    ``actors`` is how many processes render, or the least and the most of them; ``None``: as many as the cluster has
    room for. Each has ``threads`` threads and keeps its models. ``batch_size`` rows go to one at a time. All other
    ``options`` are those of ``vitral batch``, or with ``scene`` those of :class:`vitral.Renderer`.

    Raises :class:`vitral.UsageError` for jobs that write over each other and for options that are not there. A job that
    fails does not end the others. An actor that is lost is replaced, and the jobs that it had are done over.
    """
    if scene is not None:
        return _views(jobs, scene, channels, record, actors, threads, batch_size, options)
    if channels is not None:
        raise UsageError("channels: jobs have theirs among their options", "give scene= to render rows of cameras")
    words, place = _plan.words_of(options), Path(record) if record is not None else None
    if isinstance(jobs, (str, os.PathLike)):
        plan = _plan.of_file(Path(jobs), place, words)
    else:
        rows: Any = jobs.iter_rows() if hasattr(jobs, "iter_rows") else jobs
        plan = _plan.of_rows(rows, place, words)
    return do(plan, actors, threads, batch_size)


def do(plan: _plan.Plan, actors: int | tuple[int, int] | None, threads: int, batch_size: int = 16) -> Dataset:
    """What is known of jobs, then what comes of the others."""
    import ray.data

    results = [ray.data.from_items(plan.told)] if plan.told or not plan.orders else []
    if plan.orders:
        blocks = -(-len(plan.orders) // batch_size)
        orders = ray.data.from_items([{"order": order} for order in plan.orders], override_num_blocks=blocks)
        done = orders.map_batches(
            Jobs,
            batch_size=None,
            batch_format="numpy",
            num_cpus=threads,
            compute=_pool(actors),
            fn_constructor_kwargs={"record": plan.record, "threads": threads, "folder": str(Path.cwd())},
        )
        results.append(done)
    return results[0].union(*results[1:]) if len(results) > 1 else results[0]


def _views(
    jobs: Any,
    scene: Scene | _Path,
    channels: str | Sequence[str] | None,
    record: _Path | None,
    actors: int | tuple[int, int] | None,
    threads: int,
    batch_size: int,
    options: Mapping[str, Any],
) -> Dataset:
    """Pictures of a scene. It goes to the cluster's store once; of a file only the name is sent."""
    import ray.data

    if record is not None:
        raise UsageError("record: with a scene no files are written", "leave it out")
    if isinstance(jobs, (str, os.PathLike)):
        raise UsageError("with a scene, jobs are rows of cameras, not a file", "give dicts or a dataset")
    shipped: Any = ray.put(scene) if isinstance(scene, Scene) else os.fspath(scene)
    rows = jobs if hasattr(jobs, "map_batches") else ray.data.from_items([dict(row) for row in jobs])
    names = ["rgb"] if channels is None else [channels] if isinstance(channels, str) else list(channels)
    done: Dataset = rows.map_batches(
        Views,
        batch_size=batch_size,
        batch_format="numpy",
        num_cpus=threads,
        compute=_pool(actors),
        fn_constructor_kwargs={"scene": shipped, "channels": names, "options": {"threads": threads, **options}},
    )
    return done


def _pool(actors: int | tuple[int, int] | None) -> Any:
    """How many actors there are."""
    from ray.data import ActorPoolStrategy

    if isinstance(actors, tuple):
        return ActorPoolStrategy(min_size=actors[0], max_size=actors[1])
    return ActorPoolStrategy(min_size=1) if actors is None else ActorPoolStrategy(size=actors)
