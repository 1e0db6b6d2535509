"""OpenGL for existing programs: vitral's ``libOSMesa.so.8``.

``install()`` at the top of a program, ``python -m vitral.osmesa program.py``, or ``eval "$(vitral osmesa-env)"`` in a
shell.
"""

from __future__ import annotations

import ctypes
import os
import sys
from pathlib import Path

from .._errors import Error

__all__ = ["folder", "install", "run"]

_NAME = "libOSMesa.so.8"
_VARIABLES = {"MUJOCO_GL": "osmesa", "PYOPENGL_PLATFORM": "osmesa"}
#: Modules that choose their OpenGL when they are imported.
_CHOOSERS = ("OpenGL.platform", "OpenGL.GL", "mujoco.gl_context", "dm_control._render")

#: Keeps the libraries.
_libraries: list[ctypes.CDLL] = []


def folder() -> Path:
    """The folder with ``libOSMesa.so.8``.

    Raises :class:`vitral.Error` where the package was built without it.

    >>> import vitral.osmesa
    >>> (vitral.osmesa.folder() / "libOSMesa.so.8").exists()
    True
    """
    lib = Path(__file__).parent / "lib"
    if not (lib / _NAME).is_file():
        raise Error(
            f"{_NAME} is not in {lib}",
            "this package was built without it; `cargo xtask wheel` builds it in",
        )
    return lib


def _loaded() -> list[str]:
    """The paths of all libraries of that name that the process has loaded."""
    try:
        lines = Path("/proc/self/maps").read_text().splitlines()
    except OSError:
        return []
    paths = {line.split(maxsplit=5)[5] for line in lines if len(line.split(maxsplit=5)) == 6}
    return sorted(path for path in paths if Path(path).name.startswith("libOSMesa"))


def install() -> Path:
    """Makes this process, and those that it starts, use vitral's OpenGL; gives the library's path.

    To be called before ``mujoco``, ``gymnasium``'s MuJoCo environments, ``dm_control`` or ``OpenGL`` are imported. It
    sets ``MUJOCO_GL``, ``PYOPENGL_PLATFORM`` and, for processes that are started, ``LD_LIBRARY_PATH``, and loads the
    library.

    Raises :class:`vitral.Error` if one of these modules is there already, or another libOSMesa is loaded.
    """
    library = folder() / _NAME
    others = [path for path in _loaded() if not os.path.samefile(Path(path).parent, folder())]
    if others:
        hint = "call vitral.osmesa.install() before anything that loads it"
        raise Error(f"another libOSMesa is loaded: {others[0]}", hint)
    if _libraries:
        return library
    early = [name for name in _CHOOSERS if name in sys.modules]
    if early:
        hint = "call vitral.osmesa.install() before it is imported, or run `python -m vitral.osmesa PROGRAM`"
        raise Error(f"{early[0].split('.')[0]} is imported already, and has chosen its OpenGL", hint)

    # Programs that are started look here.
    os.environ.update(_VARIABLES)
    before = [part for part in os.environ.get("LD_LIBRARY_PATH", "").split(":") if part]
    path = [str(folder()), *(part for part in before if part != str(folder()))]
    os.environ["LD_LIBRARY_PATH"] = ":".join(path)

    # This process finds a library that is loaded by its name, whatever its paths are. Both names lead to one library.
    _libraries.extend(ctypes.CDLL(str(folder() / name), mode=ctypes.RTLD_GLOBAL) for name in (_NAME, "libOSMesa.so"))
    return library


def run(arguments: list[str]) -> None:
    """Runs a Python program with its arguments, as ``python PROGRAM ...`` would, on vitral's OpenGL.

    The process starts anew, so that the library is in front of all others from the beginning.
    """
    if not arguments:
        print("usage: python -m vitral.osmesa PROGRAM [ARGUMENT...]", file=sys.stderr)
        raise SystemExit(2)
    environment = {**os.environ, **_VARIABLES}
    before = [part for part in environment.get("LD_LIBRARY_PATH", "").split(":") if part]
    path = [str(folder()), *(part for part in before if part != str(folder()))]
    environment["LD_LIBRARY_PATH"] = ":".join(path)
    sys.stdout.flush()
    sys.stderr.flush()
    os.execve(sys.executable, [sys.executable, *arguments], environment)
