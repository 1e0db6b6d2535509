"""Writes the generated benchmark mesh: a torus as a grid of triangles, binary little-endian PLY.

Usage: torus.py OUT.ply [TRIANGLES]       (default 1000000)

The tube has half as many steps as the ring, so the number of triangles is ring * tube * 2, rounded down to such a
grid. Only the standard library is used: the mesh can be made without the peers.
"""

import array
import math
import struct
import sys


def torus(triangles):
    """Positions (flat floats) and triangles (flat indices) of a torus with at most `triangles` triangles."""
    tube = max(3, int(math.sqrt(triangles / 4.0)))
    ring = max(3, triangles // (2 * tube))
    positions = array.array("f")
    for i in range(ring):
        u = 2.0 * math.pi * i / ring
        for j in range(tube):
            v = 2.0 * math.pi * j / tube
            r = 1.0 + 0.4 * math.cos(v)
            positions.extend((r * math.cos(u), 0.4 * math.sin(v), -r * math.sin(u)))
    indices = array.array("I")
    for i in range(ring):
        here, there = i * tube, (i + 1) % ring * tube
        for j in range(tube):
            up = (j + 1) % tube
            indices.extend((here + j, there + j, there + up, here + j, there + up, here + up))
    return positions, indices


def write_ply(path, positions, indices):
    """Binary little-endian PLY with a byte count before each face."""
    vertices, faces = len(positions) // 3, len(indices) // 3
    header = (
        "ply\nformat binary_little_endian 1.0\n"
        f"element vertex {vertices}\nproperty float x\nproperty float y\nproperty float z\n"
        f"element face {faces}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    if sys.byteorder != "little":
        positions.byteswap()
    face = struct.Struct("<B3i")
    body = bytearray(13 * faces)
    for f in range(faces):
        face.pack_into(body, 13 * f, 3, indices[3 * f], indices[3 * f + 1], indices[3 * f + 2])
    with open(path, "wb") as out:
        out.write(header.encode("ascii"))
        out.write(positions.tobytes())
        out.write(body)
    return faces


if __name__ == "__main__":
    wanted = int(sys.argv[2]) if len(sys.argv) > 2 else 1_000_000
    print(write_ply(sys.argv[1], *torus(wanted)), "triangles")
