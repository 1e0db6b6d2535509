"""What both peer scripts share: the arguments, the renderer that really ran, and the report.

Usage of either script: SCRIPT MODEL --samples default|1|4 [--frames N] [--resolution WxH] [--output OUT.png]

With --output one picture is written and nothing is timed: `cargo xtask compare` times the whole process from outside.
Otherwise a turntable of N frames is rendered into memory after one frame of warm-up, and one JSON object is printed.

The camera circles the centre of the model's bounding box about +Y, starting at +Z, at half the box's diagonal divided by
sin(15 degrees); its vertical view angle is the smallest at which the model fits 0.9 of the picture in every frame (VTK's
`ResetCameraScreenSpace`, the widest of all views). `coverage` is the share of pixels of the last frame that show the
model, so that a reader sees whether two tools drew the same amount.
"""

import argparse
import json
import os
import statistics
import time

# Ask for Mesa's software rasteriser even where a GPU is present. Must happen before the peer loads its GL.
os.environ.setdefault("LIBGL_ALWAYS_SOFTWARE", "1")
os.environ.setdefault("GALLIUM_DRIVER", "llvmpipe")


def arguments():
    """The command line."""
    parser = argparse.ArgumentParser()
    parser.add_argument("model")
    parser.add_argument("--samples", choices=["default", "1", "4"], default="default")
    parser.add_argument("--frames", type=int, default=8)
    parser.add_argument("--resolution", default="1024x768")
    parser.add_argument("--output")
    parser.add_argument("--look", help="also write the last frame, untimed")
    parsed = parser.parse_args()
    parsed.width, parsed.height = (int(side) for side in parsed.resolution.split("x"))
    return parsed


def software_gl():
    """Names of the software GL libraries in this process's memory; empty means that a GPU driver may have drawn."""
    try:
        with open("/proc/self/maps", encoding="utf-8", errors="replace") as maps:
            paths = {os.path.basename(line.split()[-1]) for line in maps if "/" in line}
    except OSError:
        return []
    marks = ("swrast_dri", "libgallium", "libOSMesa", "libLLVM")
    return sorted(name for name in paths if name.startswith(marks))


class Turntable:
    """Times frames: seconds by the clock, and of all threads' processors."""

    def __init__(self):
        self.wall, self.cpu = [], []

    def frame(self, draw):
        """Calls `draw` and keeps what it took."""
        wall, cpu = time.perf_counter(), time.process_time()
        draw()
        self.wall.append(time.perf_counter() - wall)
        self.cpu.append(time.process_time() - cpu)


def milliseconds(seconds):
    """Three digits are enough."""
    return round(1000 * seconds, 3)


def report(tool, version, renderer, how, load_seconds, turntable, coverage, **more):
    """Prints the one JSON object."""
    print(
        json.dumps(
            {
                "tool": tool,
                "version": version,
                "renderer": renderer,
                "anti_aliasing": how,
                "load_ms": milliseconds(load_seconds),
                "frames": len(turntable.wall),
                "median_ms": milliseconds(statistics.median(turntable.wall)),
                "min_ms": milliseconds(min(turntable.wall)),
                "cpu_ms": milliseconds(statistics.median(turntable.cpu)),
                "coverage": round(coverage, 4),
                **more,
            }
        )
    )
