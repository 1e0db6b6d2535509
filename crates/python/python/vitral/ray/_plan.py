"""What there is to do: ``vitral batch`` reads the jobs and looks at the record."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .._errors import Error, UsageError

#: Exit codes of a batch that looked at its jobs.
_LOOKED = (0, 1)
_USAGE = 2


@dataclass
class Plan:
    """Jobs, sorted by what is known of them."""

    #: Rows about jobs that are done or can be none.
    told: list[dict[str, Any]]
    #: Orders for the others, as ``vitral batch-worker`` takes them.
    orders: list[str]
    #: The record of what is done.
    record: str


def of_file(path: Path, record: Path | None, words: list[str]) -> Plan:
    """The jobs of a file."""
    place = record if record is not None else path.with_suffix(".done.jsonl")
    return _planned(str(path), None, place, words)


def of_rows(rows: Iterable[Mapping[str, Any]], record: Path | None, words: list[str]) -> Plan:
    """Jobs that are given one by one. Datasets have nothing for what a row leaves out."""
    given = ({name: value for name, value in row.items() if value is not None} for row in rows)
    lines = "\n".join(json.dumps(row) for row in given)
    return _planned("-", lines, record or Path("batch.done.jsonl"), words)


def words_of(options: Mapping[str, Any]) -> list[str]:
    """Options as the command has them; a list gives its option several times."""
    words = []
    for name, value in options.items():
        option = "--" + name.replace("_", "-")
        for one in value if isinstance(value, list) else [value]:
            if one is True:
                words.append(option)
            elif one is False:
                words.append(f"{option}=off")
            elif isinstance(one, tuple):
                words.append(f"{option}={','.join(map(str, one))}")
            elif one is not None:
                words.append(f"{option}={one}")
    return words


def row(name: str, status: str, code: int, message: str, outputs: list[str], seconds: float) -> dict[str, Any]:
    """A row about a job."""
    return {
        "id": name,
        "status": status,
        "code": code,
        "message": message,
        "outputs": json.dumps(outputs),
        "seconds": seconds,
    }


def _planned(source: str, text: str | None, record: Path, words: list[str]) -> Plan:
    place = str(record.absolute())
    command = [sys.executable, "-m", "vitral", "batch", source, "--dry-run", "--json", "--quiet", "--record", place]
    ended = subprocess.run([*command, *words], input=text or "", capture_output=True, text=True)
    if ended.returncode not in _LOOKED or (ended.returncode and not ended.stdout):
        message, _, hint = ended.stderr.strip().removeprefix("vitral: ").partition("\nhint: ")
        raise (UsageError if ended.returncode == _USAGE else Error)(message, hint or None)

    # Jobs of a model stay together.
    plan = Plan([], [], place)
    waiting = []
    for line in map(json.loads, ended.stdout.splitlines()):
        if line["status"] == "waiting":
            waiting.append(line)
        else:
            about = line.get("code", 0), line.get("message", ""), line.get("outputs", [])
            plan.told.append(row(line["id"], line["status"], *about, 0.0))
    waiting.sort(key=lambda line: line["model"])
    for line in waiting:
        order = {"id": line["id"], "job": line["job"], "output": line["outputs"][0], "command": line["command"]}
        plan.orders.append(json.dumps(order))
    return plan
