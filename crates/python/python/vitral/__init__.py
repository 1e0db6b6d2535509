"""Pictures and drawings of 3D models as numpy arrays, without GPU, display or GL driver.

>>> import vitral
>>> scene = vitral.load("builtin:teapot")
>>> vitral.Renderer(scene, height=48, width=64).render().shape
(48, 64, 3)
"""

from ._errors import Error, InputError, LimitError, UnsupportedError, UsageError
from ._vitral import (
    Camera,
    Drawing,
    Light,
    Picture,
    Renderer,
    Scene,
    Turntable,
    __version__,
    load,
)


def from_pyvista(mesh: object) -> Scene:
    """A scene of a ``pyvista.PolyData``: its points, faces, and normals if it has some."""
    return Scene.from_pyvista(mesh)


__all__ = [
    "Camera",
    "Drawing",
    "Error",
    "InputError",
    "Light",
    "LimitError",
    "Picture",
    "Renderer",
    "Scene",
    "Turntable",
    "UnsupportedError",
    "UsageError",
    "__version__",
    "from_pyvista",
    "load",
]
