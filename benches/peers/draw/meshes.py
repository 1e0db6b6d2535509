"""Writes the meshes of `cargo xtask compare draw`.

Usage: meshes.py knot TRIANGLES OUT.ply        a closed tube round a (2,3) torus knot
       meshes.py slivers TRIANGLES OUT.ply     thin triangles across the unit cube, which cross
       meshes.py small TRIANGLES OUT.ply       triangles with corners within 1/40 of random points of the unit cube
       meshes.py large TRIANGLES OUT.ply       triangles with corners anywhere in the unit cube
       meshes.py glass TRIANGLES OUT.obj       a knot behind a glass ball on a floor, with OUT.mtl beside it
       meshes.py triangles IN.obj OUT.ply      all faces of an OBJ file as triangles

PLY files are binary, little-endian, without normals and colours. Only the standard library is used: the meshes can be
made without the peers.
"""

import array
import math
import os
import random
import struct
import sys

# Radius of the knot's tube.
TUBE = 0.4


def knot(wanted):
    """At most `wanted` triangles: a ring of ten times as many steps as the tube, which makes them about equilateral."""
    tube = max(3, math.isqrt(wanted // 20))
    ring = wanted // (2 * tube)
    circle = [(math.cos(2 * math.pi * j / tube), math.sin(2 * math.pi * j / tube)) for j in range(tube)]
    positions = []
    for i in range(ring):
        t = 2.0 * math.pi * i / ring
        reach = 2.0 + math.cos(3 * t)
        middle = (reach * math.cos(2 * t), math.sin(3 * t), reach * math.sin(2 * t))
        slope = -3 * math.sin(3 * t)
        along = unit(
            slope * math.cos(2 * t) - 2 * reach * math.sin(2 * t),
            3 * math.cos(3 * t),
            slope * math.sin(2 * t) + 2 * reach * math.cos(2 * t),
        )
        side = unit(-along[2], 0.0, along[0])
        above = cross(side, along)
        for c, s in circle:
            positions.append(tuple(m + TUBE * (c * a + s * b) for m, a, b in zip(middle, side, above)))
    triangles = []
    for i in range(ring):
        here, there = i * tube, (i + 1) % ring * tube
        for j in range(tube):
            up = (j + 1) % tube
            triangles += [(here + j, there + j, there + up), (here + j, there + up, here + up)]
    return positions, triangles


def ball(rings):
    """A ball of radius 1."""
    sides = 2 * rings
    positions = [(0.0, 1.0, 0.0)]
    for i in range(1, rings):
        height, radius = math.cos(math.pi * i / rings), math.sin(math.pi * i / rings)
        for j in range(sides):
            angle = 2 * math.pi * j / sides
            positions.append((radius * math.cos(angle), height, -radius * math.sin(angle)))
    positions.append((0.0, -1.0, 0.0))
    last = len(positions) - 1
    triangles = []
    for j in range(sides):
        k = (j + 1) % sides
        triangles += [(0, 1 + j, 1 + k), (last, last - sides + k, last - sides + j)]
        for i in range(rings - 2):
            above, below = 1 + i * sides, 1 + (i + 1) * sides
            triangles += [(above + j, below + j, below + k), (above + j, below + k, above + k)]
    return positions, triangles


def scattered(count, corners):
    """`count` triangles with corners of their own; random numbers are the same on every machine."""
    source = random.Random(1)
    positions = [corner for _ in range(count) for corner in corners(source)]
    return positions, [(3 * i, 3 * i + 1, 3 * i + 2) for i in range(count)]


def anywhere(source):
    """A point of the unit cube."""
    return source.random(), source.random(), source.random()


def near(source, point, distance):
    """A point whose coordinates are at most `distance` from those of `point`."""
    return tuple(x + distance * (2 * source.random() - 1) for x in point)


def sliver(source):
    """A triangle as wide as 1/1000 of the cube."""
    a, b = anywhere(source), anywhere(source)
    return a, b, near(source, b, 0.001)


def small(source):
    """A triangle round a point."""
    middle = anywhere(source)
    return [near(source, middle, 0.025) for _ in range(3)]


def large(source):
    """A triangle across the cube."""
    return [anywhere(source) for _ in range(3)]


def unit(x, y, z):
    """The vector with length 1."""
    length = math.sqrt(x * x + y * y + z * z)
    return x / length, y / length, z / length


def cross(a, b):
    """The vector across two others."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def read_obj(path):
    """Positions and triangles of an OBJ file; polygons become fans."""
    positions, triangles = [], []
    with open(path, encoding="utf-8", errors="replace") as file:
        for line in file:
            words = line.split()
            if words[:1] == ["v"]:
                positions.append(tuple(map(float, words[1:4])))
            elif words[:1] == ["f"]:
                numbers = [int(word.split("/")[0]) for word in words[1:]]
                corners = [n - 1 if n > 0 else len(positions) + n for n in numbers]
                triangles += [(corners[0], b, c) for b, c in zip(corners[1:], corners[2:])]
    return positions, triangles


def write_ply(path, positions, triangles):
    """Binary little-endian PLY with a byte count before each face."""
    header = (
        "ply\nformat binary_little_endian 1.0\n"
        f"element vertex {len(positions)}\nproperty float x\nproperty float y\nproperty float z\n"
        f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    floats = array.array("f", [x for position in positions for x in position])
    if sys.byteorder != "little":
        floats.byteswap()
    face = struct.Struct("<B3i")
    with open(path, "wb") as out:
        out.write(header.encode("ascii"))
        out.write(floats.tobytes())
        out.write(b"".join(face.pack(3, *triangle) for triangle in triangles))


def write_glass(path, wanted):
    """A knot, a glass ball with a fifth of the triangles, and a floor."""
    name = os.path.splitext(path)[0]
    with open(name + ".mtl", "w", encoding="ascii") as out:
        out.write("newmtl floor\nKd .8 .8 .75\nnewmtl knot\nKd .8 .3 .2\nnewmtl glass\nKd .5 .7 .9\nd .35\n")
    rings = max(4, math.isqrt(wanted // 5) // 2)
    globe, globe_triangles = ball(rings)
    globe = [(1.2 * x + 2.2, 1.2 * y + 0.2, 1.2 * z + 2.2) for x, y, z in globe]
    floor = [(-5.0, -1.5, -5.0), (-5.0, -1.5, 5.0), (5.0, -1.5, 5.0), (5.0, -1.5, -5.0)]
    parts = [
        ("floor", floor, [(0, 1, 2), (0, 2, 3)]),
        ("knot", *knot(wanted - 2 - len(globe_triangles))),
        ("glass", globe, globe_triangles),
    ]
    first = 1
    with open(path, "w", encoding="ascii") as out:
        out.write(f"mtllib {os.path.basename(name)}.mtl\n")
        for material, positions, triangles in parts:
            out.write(f"o {material}\nusemtl {material}\n")
            out.writelines(f"v {x:.9g} {y:.9g} {z:.9g}\n" for x, y, z in positions)
            out.writelines(f"f {a + first} {b + first} {c + first}\n" for a, b, c in triangles)
            first += len(positions)


def main():
    kind, what, out = sys.argv[1:4]
    if kind == "triangles":
        write_ply(out, *read_obj(what))
    elif kind == "glass":
        write_glass(out, int(what))
    elif kind == "knot":
        write_ply(out, *knot(int(what)))
    else:
        corners = {"slivers": sliver, "small": small, "large": large}[kind]
        write_ply(out, *scattered(int(what), corners))


main()
