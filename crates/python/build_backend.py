"""The build backend of the Python package: maturin's, with vitral's libOSMesa put into the wheel first.

``VITRAL_PROFILE`` names the cargo profile (``release`` if it is not set). ``VITRAL_OSMESA`` names a library that was
built already, or is empty for a wheel without one.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import maturin
from maturin import (
    build_sdist,
    get_requires_for_build_editable,
    get_requires_for_build_sdist,
    get_requires_for_build_wheel,
    prepare_metadata_for_build_wheel,
)

__all__ = [
    "build_editable",
    "build_sdist",
    "build_wheel",
    "get_requires_for_build_editable",
    "get_requires_for_build_sdist",
    "get_requires_for_build_wheel",
    "prepare_metadata_for_build_wheel",
]

ROOT = Path(__file__).resolve().parents[2]
LIBRARY = "libOSMesa.so.8"
#: Names of functions are of no use to programs; entry points begin with a cache line (see `cargo xtask osmesa`).
OPTIONS = ["-C", "strip=symbols", "-C", "llvm-args=-align-all-functions=6"]


def _profile() -> str:
    return os.environ.get("VITRAL_PROFILE") or "release"


def _built_library() -> Path | None:
    """The library: the given one, or one that cargo builds."""
    given = os.environ.get("VITRAL_OSMESA")
    if given is not None:
        return Path(given) if given else None
    if not sys.platform.startswith("linux"):
        return None
    command = [
        "cargo",
        "rustc",
        "--profile",
        _profile(),
        "--package",
        "vitral-osmesa",
        "--lib",
        "--crate-type",
        "cdylib",
    ]
    if _profile() == "release":
        command += ["--", *OPTIONS]
    subprocess.run(command, cwd=ROOT, check=True)
    target = ROOT / os.environ.get("CARGO_TARGET_DIR", "target")
    return target / _profile() / "libOSMesa.so"


def _put_library_into_package() -> None:
    """Lays the library into the package, and beside it a small one of the name that some programs load.

    The small one is linked with the library: two copies would be two OpenGLs in one process.
    """
    folder = ROOT / "crates/python/python/vitral/osmesa/lib"
    shutil.rmtree(folder, ignore_errors=True)
    library = _built_library()
    if library is None:
        return
    folder.mkdir(parents=True)
    shutil.copyfile(library, folder / LIBRARY)
    with tempfile.TemporaryDirectory() as scratch:
        empty = Path(scratch) / "empty.c"
        empty.write_text("")
        # What programs look for that were linked with no number, or with that of Mesa's library before version 9.
        for name in ("libOSMesa.so", "libOSMesa.so.6"):
            options = ["-shared", "-nostdlib", f"-Wl,-soname,{name}", "-Wl,--no-as-needed", "-Wl,-rpath,$ORIGIN"]
            linked = [str(empty), f"-L{folder}", f"-l:{LIBRARY}", "-o", str(folder / name)]
            subprocess.run([os.environ.get("CC", "cc"), *options, *linked], check=True)


def _configured(settings: dict[str, Any] | None) -> dict[str, Any]:
    """The settings with our profile for cargo."""
    settings = dict(settings or {})
    if _profile() != "release":
        settings.setdefault("build-args", f"--profile {_profile()}")
    return settings


def build_wheel(
    wheel_directory: str, config_settings: dict[str, Any] | None = None, metadata_directory: str | None = None
) -> str:
    _put_library_into_package()
    return maturin.build_wheel(wheel_directory, _configured(config_settings), metadata_directory)


def build_editable(
    wheel_directory: str, config_settings: dict[str, Any] | None = None, metadata_directory: str | None = None
) -> str:
    _put_library_into_package()
    return maturin.build_editable(wheel_directory, _configured(config_settings), metadata_directory)
