"""What the tests share."""

from __future__ import annotations

import numpy as np
import pytest
import vitral


@pytest.fixture
def two_squares() -> vitral.Scene:
    """Two squares of side 2 that face +z: red in the middle, green two units to the right and one farther away."""
    scene = vitral.Scene()
    corners = [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]
    red = scene.add_material(name="red", diffuse=(0.8, 0.0, 0.0), unlit=True, color=(1, 0, 0))
    green = scene.add_material(name="green", unlit=True, color=(0, 1, 0))
    for number, material in enumerate((red, green)):
        mesh = scene.add_mesh(corners, [[0, 1, 2, 3]], material=material, name=f"square {number}")
        transform = np.eye(4)
        transform[0, 3], transform[2, 3] = 2 * number, -number
        scene.add_instance(mesh, transform)
    return scene


@pytest.fixture
def above() -> vitral.Camera:
    """Looks at the first square from (0, 0, 5) with parallel projectors, 4 units high."""
    return vitral.Camera.orthographic((0, 0, 5), (0, 0, 0), height=4)
