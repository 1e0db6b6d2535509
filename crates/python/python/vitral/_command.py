"""The command ``vitral``."""

from __future__ import annotations

import sys
from pathlib import Path

from ._vitral import command


def main() -> None:
    """Runs the command with the process's arguments and ends the process."""
    library = Path(__file__).parent / "osmesa" / "lib"
    program = [sys.executable, "-m", "vitral"]
    sys.exit(command(["vitral", *sys.argv[1:]], library, program))
