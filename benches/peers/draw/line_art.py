"""Blender's Line Art as a peer of `vitral draw`. Usage: drawing.py tells.

Tasks: `all` draws every edge, `creases` contours, boundaries and edges above the crease angle, `lines` those and the
lines in which faces cross. Line Art writes no file by itself here: its strokes go through `write_svg`.
"""

import math

import bpy
import numpy as np
from mathutils import Matrix

from drawing import BACK, RIGHT, UP, Watch, arguments, read_mesh, write_svg


def add_mesh(positions, triangles, mark_edges):
    """The mesh as an object of the scene; with `mark_edges` all of its edges have Freestyle's mark."""
    mesh = bpy.data.meshes.new("model")
    mesh.vertices.add(len(positions))
    mesh.vertices.foreach_set("co", positions.astype(np.float32).ravel())
    mesh.loops.add(triangles.size)
    mesh.loops.foreach_set("vertex_index", triangles.astype(np.int32).ravel())
    mesh.polygons.add(len(triangles))
    mesh.polygons.foreach_set("loop_start", np.arange(0, triangles.size, 3, dtype=np.int32))
    mesh.update(calc_edges=True)
    if mark_edges:
        marks = mesh.attributes.new("freestyle_edge", "BOOLEAN", "EDGE")
        marks.data.foreach_set("value", np.ones(len(mesh.edges), dtype=bool))
    model = bpy.data.objects.new("model", mesh)
    bpy.context.scene.collection.objects.link(model)
    return model


def add_camera(positions):
    """The isometric view of all positions."""
    across, upwards, depth = (positions @ axis for axis in (RIGHT, UP, BACK))
    extent = max(np.ptp(across), np.ptp(upwards), 1e-6)
    thickness = max(np.ptp(depth), 1e-6)
    middle = RIGHT * (across.min() + np.ptp(across) / 2) + UP * (upwards.min() + np.ptp(upwards) / 2)
    place = middle + BACK * (depth.max() + thickness)
    data = bpy.data.cameras.new("camera")
    data.type, data.ortho_scale = "ORTHO", 1.05 * extent
    data.clip_start, data.clip_end = 0.1 * thickness, 3.0 * thickness
    camera = bpy.data.objects.new("camera", data)
    camera.matrix_world = Matrix([[*row] for row in np.vstack([np.column_stack([RIGHT, UP, BACK, place]), [0, 0, 0, 1]])])
    scene = bpy.context.scene
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.render.resolution_x = scene.render.resolution_y = 1024


def add_line_art(model, task, crease_angle):
    """A Grease Pencil object whose strokes are Line Art's lines of the model."""
    pencil = bpy.data.grease_pencils.new("lines")
    pencil.layers.new("lines").frames.new(1)
    material = bpy.data.materials.new("lines")
    bpy.data.materials.create_gpencil_data(material)
    pencil.materials.append(material)
    lines = bpy.data.objects.new("lines", pencil)
    bpy.context.scene.collection.objects.link(lines)
    art = lines.modifiers.new("lines", "LINEART")
    art.source_type, art.source_object = "OBJECT", model
    art.target_layer, art.target_material = "lines", material
    art.use_edge_mark = task == "all"
    art.use_crease, art.use_contour, art.use_loose = task != "all", True, True
    art.use_intersection = task == "lines"
    art.crease_threshold = math.radians(180.0 - crease_angle)
    art.stroke_depth_offset = 0.0
    return lines


def strokes(lines):
    """The evaluated strokes as arrays of positions."""
    scene = lines.evaluated_get(bpy.context.evaluated_depsgraph_get())
    drawing = scene.data.layers[0].frames[0].drawing
    offsets = np.empty(len(drawing.curve_offsets), dtype=np.int32)
    drawing.curve_offsets.foreach_get("value", offsets)
    points = drawing.attributes["position"].data
    positions = np.empty(3 * len(points), dtype=np.float32)
    points.foreach_get("vector", positions)
    return np.split(positions.reshape(-1, 3).astype(float), offsets[1:-1])


def main():
    path, out, task, crease_angle = arguments()
    watch = Watch()
    bpy.ops.wm.read_factory_settings(use_empty=True)
    positions, triangles = read_mesh(path)
    model = add_mesh(positions, triangles, task == "all")
    add_camera(positions)
    watch.end("load")
    lines = add_line_art(model, task, crease_angle)
    bpy.context.view_layer.update()
    polylines = [line @ np.column_stack([RIGHT, UP]) for line in strokes(lines) if len(line) > 1]
    watch.end("draw")
    write_svg(out, polylines)
    watch.end("write")
    watch.report(bpy.app.version_string, len(polylines))


main()
