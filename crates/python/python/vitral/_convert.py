"""Scenes of other libraries, told by what they have rather than by their class."""

from __future__ import annotations

from typing import Any

import numpy as np

from ._vitral import Renderer, Scene


def renderer(scene: Scene, options: dict[str, Any]) -> Renderer:
    """The renderer that was pickled."""
    return Renderer(scene, **options)


def from_trimesh(source: Any) -> Scene:
    """A scene of a ``trimesh.Trimesh`` or ``trimesh.Scene``."""
    scene = Scene()
    if not hasattr(source, "geometry"):
        scene.add_instance(_add_trimesh(scene, source, ""))
        return scene

    # Add each geometry once, and place it wherever the graph names it.
    meshes: dict[str, int] = {}
    for node in source.graph.nodes_geometry:
        transform, name = source.graph[node]
        if not hasattr(source.geometry[name], "faces"):
            continue
        if name not in meshes:
            meshes[name] = _add_trimesh(scene, source.geometry[name], name)
        scene.add_instance(meshes[name], transform=transform)
    return scene


def _add_trimesh(scene: Scene, mesh: Any, name: str) -> int:
    if not hasattr(mesh, "vertices") or not hasattr(mesh, "faces"):
        raise TypeError(f"a trimesh.Trimesh or trimesh.Scene is needed, not {type(mesh).__name__}")
    visual: Any = getattr(mesh, "visual", None)
    kind = getattr(visual, "kind", None)
    material = None
    colors = uvs = None
    if kind == "vertex":
        colors = np.asarray(visual.vertex_colors)
    elif kind == "face":
        # Colours of faces need corners of their own.
        faces = np.asarray(mesh.faces)
        vertices = np.asarray(mesh.vertices)[faces.reshape(-1)]
        colors = np.repeat(np.asarray(visual.face_colors), 3, axis=0)
        corners = np.arange(len(vertices)).reshape(-1, 3)
        white = scene.add_material(name=name, diffuse=(1, 1, 1))
        return scene.add_mesh(vertices, corners, colors=colors, material=white, name=name)
    elif kind == "texture":
        material, uvs = _add_trimesh_material(scene, visual)
    if colors is not None:
        material = scene.add_material(name=name, diffuse=(1, 1, 1))
    return scene.add_mesh(
        np.asarray(mesh.vertices),
        np.asarray(mesh.faces),
        uvs=uvs,
        colors=colors,
        material=material,
        name=name,
    )


def _add_trimesh_material(scene: Scene, visual: Any) -> tuple[int, Any]:
    """The material of a textured mesh, and its texture coordinates with v downwards."""
    material = visual.material
    image = getattr(material, "baseColorTexture", None) or getattr(material, "image", None)
    texture = None if image is None else np.asarray(image.convert("RGBA"))
    color = np.asarray(material.main_color, dtype=float)[:3] / 255
    linear = np.where(color <= 0.04045, color / 12.92, ((color + 0.055) / 1.055) ** 2.4)
    diffuse = (1, 1, 1) if texture is not None else tuple(float(c) for c in linear)
    number = scene.add_material(name=getattr(material, "name", None) or "", texture=texture, diffuse=diffuse)
    uv = getattr(visual, "uv", None)
    if uv is None:
        return number, None
    uvs = np.array(uv, dtype=np.float32)
    uvs[:, 1] = 1 - uvs[:, 1]
    return number, uvs


def from_pyvista(mesh: Any) -> Scene:
    """A scene of a ``pyvista.PolyData``."""
    if not hasattr(mesh, "points") or not hasattr(mesh, "faces"):
        hint = "extract_surface() makes one of other data sets"
        raise TypeError(f"a pyvista.PolyData is needed, not {type(mesh).__name__}; {hint}")

    # Faces lie one after the other, each after its number of corners.
    flat = np.asarray(mesh.faces).reshape(-1)
    polygons: list[Any] = []
    at = 0
    while at < len(flat):
        count = int(flat[at])
        if count >= 3:
            polygons.append(flat[at + 1 : at + 1 + count])
        at += 1 + count
    faces: Any = polygons
    if polygons and all(len(polygon) == len(polygons[0]) for polygon in polygons):
        faces = np.stack(polygons)
    scene = Scene()
    normals = mesh.point_data["Normals"] if "Normals" in getattr(mesh, "point_data", {}) else None
    scene.add_instance(scene.add_mesh(np.asarray(mesh.points), faces, normals=normals))
    return scene
