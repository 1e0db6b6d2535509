"""F3D (PyPI `f3d`) on Mesa's software GL: a turntable, or one file to one PNG. See common.py for the arguments.

Anti-aliasing. F3D's library draws one sample a pixel by default and has no multisampling: its modes are fxaa (a filter),
taa (several frames) and ssaa (VTK's pass, which draws at several times the width and height). Four samples a pixel are
therefore asked for as F3D's user would have to: a picture of twice the width and height. The averaging down to the
final size is not charged to F3D.

`render_to_image` is what hands a picture to F3D's caller, and what is timed. It costs more than one `render`, which only
draws; that time is reported as `render_only_ms`.
"""

import statistics
import time

import common

args = common.arguments()

import f3d  # noqa: E402  (the environment must be set first)

f3d.Log.set_verbose_level(f3d.Log.ERROR)


def engine():
    """An off-screen engine: EGL without a device, else OSMesa."""
    try:
        return f3d.Engine.create_egl()
    except RuntimeError:
        return f3d.Engine.create_osmesa()


def frame_every_view(camera, count):
    """Widens the view angle until the model fits in each of `count` views round it; ends at the first view."""
    angles = []
    for _ in range(count):
        camera.reset_to_bounds()
        angles.append(camera.view_angle)
        camera.azimuth(360.0 / count)
    camera.reset_to_bounds()
    camera.view_angle = max(angles)


def turn(camera, count, draw):
    """The times of `count` calls of `draw`, one for each view round the model."""
    times = common.Turntable()
    for _ in range(count):
        camera.azimuth(360.0 / count)
        times.frame(draw)
    return times


def main():
    scale = 2 if args.samples == "4" else 1
    viewer = engine()
    window = viewer.window
    window.size = args.width * scale, args.height * scale

    start = time.perf_counter()
    viewer.scene.add(args.model)
    loaded = time.perf_counter() - start
    if args.output:
        window.camera.reset_to_bounds()
        window.render_to_image().save(args.output)
        return

    # Warm up: upload of the mesh, compilation of shaders.
    frame_every_view(window.camera, args.frames)
    window.render_to_image()
    frames = turn(window.camera, args.frames, window.render_to_image)
    render_only = turn(window.camera, args.frames, window.render)

    # See how much of the picture the model fills: without a background its alpha says so.
    image = window.render_to_image(no_background=True)
    assert (image.width, image.height) == (args.width * scale, args.height * scale), "F3D gave another size"
    if args.look:
        image.save(args.look)
    alpha = bytes(image.content)[3::4]
    coverage = 1.0 - alpha.count(0) / len(alpha)

    how = "none, at twice the width and height" if scale == 2 else "none"
    info = f3d.Engine.get_lib_info()
    version = f"{info.version}, VTK {info.vtk_version.split(' ')[0]}"
    common.report(
        "f3d", version, " ".join(common.software_gl()), how, loaded, frames, coverage,
        render_only_ms=common.milliseconds(statistics.median(render_only.wall)),
    )


main()
