"""What the peers of `vitral draw` share: the mesh, the isometric view, the SVG file and the report.

Usage of the scripts: SCRIPT MESH.ply OUT.svg TASK [CREASE_ANGLE]; TASK is one of those that the script names.

A script prints one JSON object: `version`, the seconds of its parts, and how many lines the drawing has.
"""

import json
import sys
import time

import numpy as np

# The viewer stands at equal distances before, above and right of the mesh; +Y is up.
BACK = np.array([1.0, 1.0, 1.0]) / np.sqrt(3.0)
RIGHT = np.array([1.0, 0.0, -1.0]) / np.sqrt(2.0)
UP = np.cross(BACK, RIGHT)

# Longer side of the drawing, micrometres.
SIDE = 180_000.0


def read_mesh(path):
    """Positions and triangles of a binary little-endian PLY file as `cargo xtask compare draw` writes it."""
    with open(path, "rb") as file:
        counts = {}
        for line in iter(file.readline, b"end_header\n"):
            words = line.split()
            if words[0] == b"element":
                counts[words[1]] = int(words[2])
        positions = np.fromfile(file, dtype=("<f4", 3), count=counts[b"vertex"])
        face = np.dtype([("corners", "u1"), ("corner", "<i4", 3)])
        faces = np.fromfile(file, dtype=face, count=counts[b"face"])
    return positions.astype(float), faces["corner"].copy()


def arguments():
    """The mesh's path, the drawing's path, the task and the crease angle in degrees."""
    mesh, out, task = sys.argv[1:4]
    return mesh, out, task, float(sys.argv[4]) if len(sys.argv) > 4 else 30.0


def write_svg(path, polylines):
    """Writes polylines of a plane whose y points upwards, 180 mm along the longer side, in micrometres."""
    points = np.concatenate(polylines) if polylines else np.zeros((1, 2))
    low, high = points.min(axis=0), points.max(axis=0)
    scale = SIDE / max((high - low).max(), 1e-300)
    width, height = (high - low) * scale
    with open(path, "w", encoding="ascii") as out:
        out.write(f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="-2500 -2500 {width + 5000:.0f} {height + 5000:.0f}">\n')
        out.write('<g fill="none" stroke="#000" stroke-width="350">\n')
        for line in polylines:
            x, y = np.rint((line[:, 0] - low[0]) * scale), np.rint((high[1] - line[:, 1]) * scale)
            steps = " ".join(f"{a:.0f},{b:.0f}" for a, b in zip(x, y))
            out.write(f'<polyline points="{steps}"/>\n')
        out.write("</g>\n</svg>\n")


class Watch:
    """Seconds of the parts of the work, one after the other."""

    def __init__(self):
        self.parts, self.last = {}, time.perf_counter()

    def end(self, part):
        """What was done since the last part is `part`."""
        now = time.perf_counter()
        self.parts[part], self.last = round(now - self.last, 4), now

    def report(self, version, lines):
        """Prints the one JSON object."""
        print(json.dumps({"version": version, "lines": lines, "seconds": self.parts}))
