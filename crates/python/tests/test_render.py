"""Pictures as arrays."""

from __future__ import annotations

import io
import pickle
import threading
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import vitral


def test_channels_tell_what_is_where(two_squares: vitral.Scene, above: vitral.Camera) -> None:
    renderer = vitral.Renderer(two_squares, height=40, width=80, samples=1, background_color="black")
    rgb, depth, ids = renderer.render(above, channels=("rgb", "depth", "ids"))
    assert (rgb.dtype, depth.dtype, ids.dtype) == (np.uint8, np.float32, np.int32)
    assert (rgb.shape, depth.shape, ids.shape) == ((40, 80, 3), (40, 80), (40, 80))

    # A unit is ten pixels: the red square is in the columns 30 to 50, the green one in 50 to 70, both in rows 10 to 30.
    expected = np.full((40, 80), -1)
    expected[10:30, 30:50], expected[10:30, 50:70] = 0, 1
    assert np.array_equal(ids, expected)
    assert np.allclose(depth[expected == 0], 5, rtol=1e-6) and np.allclose(depth[expected == 1], 6, rtol=1e-6)
    assert np.isinf(depth[expected == -1]).all()
    assert (rgb[expected == 0] == (255, 0, 0)).all() and (rgb[expected == 1] == (0, 255, 0)).all()
    assert (rgb[expected == -1] == 0).all()
    for array in (rgb, depth, ids):
        assert array.flags.c_contiguous and array.flags.writeable


def test_depth_is_a_distance_along_the_axis_in_perspective(two_squares: vitral.Scene) -> None:
    camera = vitral.Camera.look_at((0, 0, 5), (0, 0, 0), view_angle=60)
    depth = vitral.Renderer(two_squares, height=30, width=60, samples=1).render(camera, channels="depth")
    # The whole square is 5 away, at its corners, too.
    seen = depth[np.isfinite(depth) & (depth < 5.5)]
    assert len(seen) > 50 and np.allclose(seen, 5, rtol=1e-5)


def test_intrinsics_are_those_of_a_measured_camera(two_squares: vitral.Scene) -> None:
    pose = np.eye(4)
    pose[2, 3] = 5
    matrix = [[100, 0, 30], [0, 50, 20], [0, 0, 1]]
    camera = vitral.Camera.from_matrix(pose, intrinsics=matrix)
    ids = vitral.Renderer(two_squares, height=60, width=100, samples=1).render(camera, channels=["ids"])
    rows, columns = np.nonzero(ids == 0)
    # 1 unit at the distance 5 is 100 / 5 columns and 50 / 5 rows from the principal point.
    assert (columns.min(), columns.max() + 1, rows.min(), rows.max() + 1) == (10, 50, 10, 30)
    with pytest.raises(ValueError, match="fx and fy above 0"):
        vitral.Camera.from_matrix(pose, intrinsics=np.zeros((3, 3)))
    with pytest.raises(ValueError, match="without scale"):
        vitral.Camera.from_matrix(np.diag([2.0, 2, 2, 1]))


def test_out_is_filled_in_place(two_squares: vitral.Scene, above: vitral.Camera) -> None:
    renderer = vitral.Renderer(two_squares, height=20, width=40)
    expected = renderer.render(above)
    out = np.zeros((20, 40, 3), np.uint8)
    assert renderer.render(above, out=out) is out
    assert np.array_equal(out, expected)
    stack = np.zeros((3, 20, 40, 3), np.uint8)
    renderer.render(above, out=stack[1])
    assert np.array_equal(stack[1], expected) and not stack[[0, 2]].any()
    read_only = np.zeros_like(out)
    read_only.setflags(write=False)
    cases: list[tuple[Any, type[Exception], str]] = [
        (np.zeros((20, 40, 4), np.uint8), ValueError, r"shape \(20, 40, 3\), got shape \(20, 40, 4\)"),
        (np.zeros((20, 40, 3), np.float32), TypeError, "dtype uint8 .*got dtype float32"),
        (np.zeros((20, 80, 3), np.uint8)[:, ::2], ValueError, "C-contiguous"),
        (read_only, ValueError, "writeable"),
        ([[0]], TypeError, "got list"),
    ]
    for wrong, error, text in cases:
        with pytest.raises(error, match=text):
            renderer.render(above, out=wrong)


def test_options_are_those_of_the_command_line(two_squares: vitral.Scene) -> None:
    with pytest.raises(vitral.UsageError) as caught:
        vitral.Renderer(two_squares, visiblity="z-buffer")
    assert caught.value.hint == "did you mean visibility?"
    for options in ({"visibility": "zbuffer"}, {"samples": 99}, {"shadow_map_size": 512}, {"view_angle": 3}):
        with pytest.raises(vitral.UsageError):
            vitral.Renderer(two_squares, **options)
    renderer = vitral.Renderer(
        two_squares,
        height=24,
        width=32,
        visibility="scan-line",
        shadows="map",
        cull=["frustum", "back-face"],
        light=[vitral.Light.ambient(ambient=0.4), "directional:direction=0,0,-1"],
        background_color=(1, 1, 1),
        edges=True,
        lighting=True,
    )
    assert renderer.render().shape == (24, 32, 3)


def test_every_visibility_gives_the_same_bytes() -> None:
    scene = vitral.load("builtin:cubs")
    pictures = [
        vitral.Renderer(scene, height=24, width=32, visibility=name, threads=threads).render()
        for name in ("z-buffer", "scan-line", "painter", "ray-cast")
        for threads in (1, 3)
    ]
    assert all(np.array_equal(picture, pictures[0]) for picture in pictures)


def test_a_batch_has_the_bytes_of_single_renders(two_squares: vitral.Scene) -> None:
    renderer = vitral.Renderer(two_squares, height=24, width=32, shadows="map", light="point:position=2,3,4")
    cameras = renderer.turntable_cameras(7)
    single = np.stack([renderer.render(camera) for camera in cameras])
    assert np.array_equal(renderer.render_batch(cameras), single)
    out = np.zeros_like(single)
    assert renderer.render_batch(cameras, out=out) is out and np.array_equal(out, single)

    # Instances move from picture to picture, and are back afterwards.
    transforms = np.tile(two_squares.transforms, (7, 1, 1, 1))
    transforms[:, 1, 1, 3] = np.arange(7) / 4
    rgb, ids = renderer.render_batch(cameras, transforms, channels=("rgb", "ids"))
    home = two_squares.transforms
    for i, camera in enumerate(cameras):
        two_squares.set_transforms([0, 1], transforms[i])
        fresh = vitral.Renderer(two_squares, height=24, width=32, shadows="map", light="point:position=2,3,4")
        expected = fresh.render(camera, channels=("rgb", "ids"))
        assert np.array_equal(rgb[i], expected[0]) and np.array_equal(ids[i], expected[1])
        assert np.array_equal(renderer.render(camera), rgb[i]), "a renderer follows its scene"
    two_squares.set_transforms([0, 1], home)
    assert np.array_equal(renderer.render_batch(cameras), single)
    assert renderer.render_batch([]).shape == (0, 24, 32, 3)
    with pytest.raises(ValueError, match=r"transforms: an array of shape \(7, 2, 4, 4\) is needed"):
        renderer.render_batch(cameras, transforms[:, :1])
    with pytest.raises(TypeError, match="not int"):
        renderer.render_batch([3])  # type: ignore[list-item]


def test_a_renderer_follows_its_scene(two_squares: vitral.Scene, above: vitral.Camera) -> None:
    renderer = vitral.Renderer(two_squares, height=20, width=40, samples=1)
    assert set(np.unique(renderer.render(above, channels="ids"))) == {-1, 0, 1}
    mesh = two_squares.add_mesh([[-2, -2, 1], [2, -2, 1], [2, 2, 1], [-2, 2, 1]], [[0, 1, 2, 3]])
    assert two_squares.add_instance(mesh) == 2
    assert 0 not in renderer.render(above, channels="ids")


def test_pictures_show_and_save_themselves(two_squares: vitral.Scene, above: vitral.Camera, tmp_path: Path) -> None:
    renderer = vitral.Renderer(two_squares, height=20, width=40)
    picture = renderer.picture(above, channels="depth")
    assert np.array_equal(picture.numpy(), renderer.render(above))
    assert np.isinf(picture.numpy("depth")).any() and picture.numpy("rgba").shape == (20, 40, 4)
    assert picture._repr_png_().startswith(b"\x89PNG") and "seconds" in picture.stats
    picture.save(tmp_path / "a.png")
    assert (tmp_path / "a.png").read_bytes() == picture._repr_png_()
    with pytest.raises(vitral.UnsupportedError, match=r"\.bmp"):
        picture.save(tmp_path / "a.bmp")
    with pytest.raises(vitral.UsageError, match="ids was not rendered"):
        picture.numpy("ids")
    turned = [p.numpy() for p in renderer.turntable(3)]
    assert np.array_equal(np.stack(turned), renderer.render_batch(renderer.turntable_cameras(3)))


def test_drawings_have_their_lines_in_millimetres(two_squares: vitral.Scene, tmp_path: Path) -> None:
    renderer = vitral.Renderer(two_squares)
    drawing = renderer.draw(view="front", scale="1:1", unit="cm", page="A4")
    assert drawing.size == (210, 297)
    lines = np.concatenate([line for lines in drawing.lines.values() for line in lines])
    # Two squares side by side: 4 x 2 units of a centimetre.
    assert np.allclose(np.ptp(lines, axis=0), (40, 20), atol=0.01)
    assert drawing._repr_svg_().startswith("<svg")
    for name, start in (("a.svg", b"<svg"), ("a.pdf", b"%PDF"), ("a.dxf", b"0")):
        drawing.save(tmp_path / name)
        assert (tmp_path / name).read_bytes().lstrip().startswith(start)
    with pytest.raises(vitral.UnsupportedError):
        drawing.save(tmp_path / "a.png")
    with pytest.raises(vitral.UsageError) as caught:
        renderer.draw(stile="filled")
    assert caught.value.hint == "did you mean style?"


def test_a_pixel_is_explained(two_squares: vitral.Scene, above: vitral.Camera) -> None:
    renderer = vitral.Renderer(two_squares, height=40, width=80, samples=1)
    explained = renderer.explain(40, 20, above)
    assert explained["pixel"] == [40, 20] and explained["bytes"] == [255, 0, 0, 255]
    assert explained["surfaces"][0]["mesh"] == "square 0"
    with pytest.raises(vitral.UsageError, match="no pixel 80,0"):
        renderer.explain(80, 0)


def test_limits_are_errors_of_their_kind() -> None:
    scene = vitral.load("builtin:teapot")
    with pytest.raises(vitral.LimitError) as caught:
        vitral.Renderer(scene, height=2000, width=2000, max_memory="1M").render()
    assert isinstance(caught.value, MemoryError)
    with pytest.raises(vitral.LimitError) as late:
        vitral.Renderer(scene, height=2000, width=2000, samples=16, time_limit=0.001).render()
    assert isinstance(late.value, TimeoutError)
    # The limit holds for each call.
    renderer = vitral.Renderer(scene, height=16, width=16, time_limit=60)
    renderer.render()
    renderer.render()


def test_renderers_and_cameras_can_be_pickled(two_squares: vitral.Scene) -> None:
    light = vitral.Light.point(position=(1, 2, 3))
    renderer = vitral.Renderer(two_squares, height=20, width=40, visibility="painter", light=[light])
    again = pickle.loads(pickle.dumps(renderer))
    assert np.array_equal(renderer.render(), again.render())
    pose = np.eye(4)
    pose[2, 3] = 5
    for camera in (
        vitral.Camera.look_at((1, 2, 3), (0, 0, 0), near=1, far=9),
        vitral.Camera.from_matrix(pose, intrinsics=[[9, 0, 8], [0, 9, 7], [0, 0, 1]]),
    ):
        assert pickle.loads(pickle.dumps(camera)) == camera
    assert pickle.loads(pickle.dumps(light)) == light
    buffer = io.BytesIO()
    pickle.dump(two_squares, buffer)


def test_other_threads_run_while_a_picture_is_made() -> None:
    scene = vitral.load("builtin:teapot")
    renderer = vitral.Renderer(scene, height=600, width=800, samples=16)
    ticks = 0
    done = threading.Event()

    def tick() -> None:
        nonlocal ticks
        while not done.is_set():
            ticks += 1
            time.sleep(0.001)

    thread = threading.Thread(target=tick)
    thread.start()
    renderer.render()
    before = ticks
    renderer.render()
    done.set()
    thread.join()
    assert ticks > before

    # Two threads may use one renderer, and others theirs.
    pictures: list[Any] = []
    small = vitral.Renderer(scene, height=24, width=32)
    threads = [threading.Thread(target=lambda: pictures.append(small.render())) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(pictures) == 4 and all(np.array_equal(p, pictures[0]) for p in pictures)
