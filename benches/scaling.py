"""Measures jobs by ``vitral batch`` and by ``vitral.ray``, with one and two workers: ``python benches/scaling.py [JOBS]``."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import ray
import vitral.ray


def main() -> None:
    """Prints pictures a second."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 500
    with tempfile.TemporaryDirectory() as name:
        os.chdir(name)
        options = {"resolution": [256, 192]}
        lines = [
            {"model": "builtin:teapot", "output": f"{i}.png", "options": {**options, "camera-azimuth-angle": i * 360 / count}}
            for i in range(count)
        ]
        Path("jobs.jsonl").write_text("".join(json.dumps(line) + "\n" for line in lines))
        for workers in (1, 2):
            words = ["batch", "jobs.jsonl", "--quiet", "--jobs", str(workers), "--record", f"batch-{workers}", "--threads", "1"]
            start = time.perf_counter()
            subprocess.run([sys.executable, "-m", "vitral", *words], check=True)
            print(f"vitral batch, {workers} processes: {count / (time.perf_counter() - start):.1f} pictures a second", flush=True)
        ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False, logging_level=40)
        ray.data.DataContext.get_current().enable_progress_bars = False
        for workers in (1, 2):
            start = time.perf_counter()
            rows = vitral.ray.render("jobs.jsonl", record=f"ray-{workers}", actors=workers).take_all()
            assert all(row["status"] == "done" for row in rows)
            seconds = time.perf_counter() - start
            # What an actor takes to start is there once, however many jobs there are.
            inside = sum(row["seconds"] for row in rows) / workers
            print(f"vitral.ray, {workers} actors: {count / seconds:.1f} pictures a second, {count / inside:.1f} without start", flush=True)
        ray.shutdown()


if __name__ == "__main__":
    main()
