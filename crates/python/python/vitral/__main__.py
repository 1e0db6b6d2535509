"""``python -m vitral``: the command ``vitral``."""

from ._command import main

main()
