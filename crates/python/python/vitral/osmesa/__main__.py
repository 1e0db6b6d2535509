"""``python -m vitral.osmesa PROGRAM ...``"""

import sys

from . import run

run(sys.argv[1:])
