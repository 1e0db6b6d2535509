"""Scenes by hand and from files."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import pytest
import vitral


def test_a_scene_by_hand_is_what_was_given(two_squares: vitral.Scene) -> None:
    low, high = two_squares.bounds
    assert low.tolist() == [-1, -1, -1] and high.tolist() == [3, 1, 0]
    info = two_squares.info()
    assert (info["instances"], info["faces"], info["triangles"]) == (2, 2, 4)
    assert [m["name"] for m in info["materials"]] == ["red", "green"]
    assert two_squares.transforms[1, :3, 3].tolist() == [2, 0, -1]
    assert len(two_squares) == 2


def test_transforms_move_instances(two_squares: vitral.Scene) -> None:
    move = np.eye(4)
    move[:3, 3] = 7, 0, 0
    two_squares.set_transforms([1], move[None])
    assert two_squares.bounds[1].tolist() == [8, 1, 0]
    assert two_squares.transforms[0].tolist() == np.eye(4).tolist()


def test_a_nested_scene_is_moved_part_by_part() -> None:
    scene = vitral.load("builtin:cubs")
    before = scene.transforms
    moved = before.copy()
    moved[0, 0, 3] += 10
    scene.set_transforms(list(range(len(scene))), moved)
    assert np.array_equal(scene.transforms, moved)


def test_wrong_input_names_what_is_needed() -> None:
    scene = vitral.Scene()
    cube = np.zeros((4, 3))
    with pytest.raises(ValueError, match=r"vertices: an array of shape \(n, 3\) is needed, got \(4, 2\)"):
        scene.add_mesh(np.zeros((4, 2)), [[0, 1, 2]])
    with pytest.raises(TypeError, match="faces: integers are needed, got dtype float64"):
        scene.add_mesh(cube, [[0.0, 1.0, 2.0]])
    with pytest.raises(IndexError, match="no vertex 4, there are 4"):
        scene.add_mesh(cube, [[0, 1, 4]])
    with pytest.raises(IndexError, match="no vertex -1"):
        scene.add_mesh(cube, [[0, 1, -1]])
    with pytest.raises(ValueError, match=r"normals: an array of shape \(4, 3\) is needed"):
        scene.add_mesh(cube, [[0, 1, 2]], normals=np.zeros((3, 3)))
    with pytest.raises(IndexError, match="no material 3"):
        scene.add_mesh(cube, [[0, 1, 2]], material=3)
    with pytest.raises(IndexError, match="no mesh 0"):
        scene.add_instance(0)
    mesh = scene.add_mesh(cube, [[0, 1, 2, 3]])
    with pytest.raises(ValueError, match=r"transform: an array of shape \(4, 4\)"):
        scene.add_instance(mesh, np.eye(3))
    with pytest.raises(ValueError, match="last row of 0, 0, 0, 1"):
        scene.add_instance(mesh, np.ones((4, 4)))
    with pytest.raises(vitral.UsageError, match="colour_of_hope"):
        scene.add_material(colour_of_hope="green")


def test_polygons_of_several_lengths_keep_their_faces() -> None:
    scene = vitral.Scene()
    corners: list[list[float]] = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 2, 0]]
    scene.add_instance(scene.add_mesh(corners, [[0, 1, 2, 3], [3, 2, 4]]))
    assert (scene.info()["faces"], scene.info()["triangles"]) == (2, 3)


def test_files_and_bytes_are_read(tmp_path: Path) -> None:
    text = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
    file = tmp_path / "triangle.obj"
    file.write_bytes(text)
    for scene in (vitral.load(file), vitral.load(str(file)), vitral.load(text, format="obj")):
        assert scene.info()["triangles"] == 1
    assert vitral.load([file, file]).info()["triangles"] == 2
    with pytest.raises(vitral.UsageError, match="bytes need a format"):
        vitral.load(text)
    with pytest.raises(TypeError, match="not float"):
        vitral.load(3.5)  # type: ignore[arg-type]


def test_errors_tell_the_place(tmp_path: Path) -> None:
    file = tmp_path / "bad.obj"
    file.write_text("v 0 0 0\nv 1 0 x\n")
    with pytest.raises(vitral.InputError) as caught:
        vitral.load(file)
    assert isinstance(caught.value, ValueError)
    assert caught.value.path == str(file)
    assert caught.value.where is not None and "2" in caught.value.where
    with pytest.raises(vitral.InputError, match=r"missing\.obj"):
        vitral.load(tmp_path / "missing.obj")
    with pytest.raises(vitral.Error, match="crease_angel") as unknown:
        vitral.load("builtin:teapot", crease_angel=30)
    assert unknown.value.hint == "did you mean crease_angle?"


def test_a_scene_can_be_pickled(two_squares: vitral.Scene) -> None:
    image = np.zeros((2, 2, 3), np.uint8)
    image[0, 0] = 255, 0, 0
    material = two_squares.add_material(name="checked", texture=image, unlit=True, color=(1, 1, 1))
    square = [[-1, -1, 1], [1, -1, 1], [0, 1, 1]]
    mesh = two_squares.add_mesh(square, [[0, 1, 2]], uvs=np.array([[0, 1], [1, 1], [0.5, 0]]), material=material)
    two_squares.add_instance(mesh)
    two_squares.add_light(vitral.Light.point(position=(1, 2, 3)))
    for scene in (two_squares, vitral.load("builtin:teapot"), vitral.load("builtin:refraction")):
        again = pickle.loads(pickle.dumps(scene))
        assert again.info() == scene.info()
        first, second = (vitral.Renderer(s, height=24, width=32, samples=1).render() for s in (scene, again))
        assert np.array_equal(first, second)


class FakeGraph:
    """Places the same part twice."""

    nodes_geometry = ("a", "b")

    def __getitem__(self, node: str) -> tuple[np.ndarray, str]:
        transform = np.eye(4)
        transform[0, 3] = 0 if node == "a" else 5
        return transform, "part"


class FakeMesh:
    """What trimesh's meshes have."""

    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], float)
    faces = np.array([[0, 1, 2]])
    visual = None


class FakeScene:
    """What trimesh's scenes have."""

    graph = FakeGraph()
    geometry = {"part": FakeMesh()}  # noqa: RUF012


def test_scenes_of_other_libraries_are_told_by_what_they_have() -> None:
    assert vitral.Scene.from_trimesh(FakeMesh()).info()["triangles"] == 1
    scene = vitral.Scene.from_trimesh(FakeScene())
    assert (scene.info()["instances"], len(scene.info()["meshes"])) == (2, 1)
    assert scene.bounds[1].tolist() == [6, 1, 0]

    class Poly:
        points = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
        faces = np.array([4, 0, 1, 2, 3])

    assert vitral.from_pyvista(Poly()).info()["faces"] == 1
    with pytest.raises(TypeError, match="not int"):
        vitral.Scene.from_trimesh(3)


def test_trimesh_itself() -> None:
    trimesh = pytest.importorskip("trimesh", reason="trimesh is not installed")
    box = trimesh.creation.box(extents=(1, 2, 3))
    box.visual.vertex_colors = np.tile([255, 0, 0, 255], (8, 1))
    scene = vitral.Scene.from_trimesh(box)
    assert scene.bounds[1].tolist() == [0.5, 1, 1.5]
    picture = vitral.Renderer(scene, height=32, width=32, samples=1).render()
    red, green, blue = picture[16, 16].tolist()
    assert red > 60 and red > 3 * green and red > 3 * blue
