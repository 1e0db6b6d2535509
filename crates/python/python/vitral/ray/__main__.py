"""``python -m vitral.ray JOBS.jsonl``: the jobs of ``vitral batch`` on a Ray cluster, with the same record."""

from __future__ import annotations

import argparse
import json
import sys
import time
from pathlib import Path
from typing import Any

from .._errors import Error
from . import _plan, do


def main() -> int:
    """Runs the command; gives its exit code."""
    parser = argparse.ArgumentParser(
        prog="python -m vitral.ray",
        description="Does the jobs of `vitral batch` on a Ray cluster. All machines need the folders of models and "
        "pictures. Other options are those of `vitral batch`, of render and of draw.",
        allow_abbrev=False,
    )
    parser.add_argument("jobs", metavar="JOBS", type=Path, help="the jobs, one JSON object a line")
    parser.add_argument("--address", help="the cluster, such as auto; without it, Ray starts on this machine")
    parser.add_argument("--actors", type=int, help="processes that render [default: as many as there is room for]")
    parser.add_argument("--threads", type=int, default=1, help="threads of each [default: 1]")
    parser.add_argument("--record", type=Path, help="the record of what is done [default: JOBS.done.jsonl]")
    parser.add_argument("--json", action="store_true", help="one JSON object for each job on standard output")
    arguments, words = parser.parse_known_args()
    import ray

    start = time.monotonic()
    try:
        plan = _plan.of_file(arguments.jobs, arguments.record, words)
    except Error as error:
        print(f"vitral: {error}", file=sys.stderr)
        return 2
    ray.init(address=arguments.address, log_to_driver=False, logging_level="warning")
    counts = {"done": 0, "skipped": 0, "failed": 0}
    row: dict[str, Any]
    for row in do(plan, arguments.actors, arguments.threads).iter_rows():
        counts[row["status"]] += 1
        if arguments.json:
            print(json.dumps({**row, "outputs": json.loads(row["outputs"])}), flush=True)
        elif row["status"] == "failed":
            print(f"job {row['id']} failed ({row['code']}): {row['message']}", file=sys.stderr)
    seconds = time.monotonic() - start
    told = ", ".join(f"{count} {status}" for status, count in counts.items())
    rate = counts["done"] / max(seconds, 1e-9)
    print(f"{sum(counts.values())} jobs: {told} in {seconds:.1f} s ({rate:.1f} a second)", file=sys.stderr)
    return 1 if counts["failed"] else 0


if __name__ == "__main__":
    sys.exit(main())
