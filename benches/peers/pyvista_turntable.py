"""PyVista (PyPI `pyvista`, VTK's wheel) on Mesa's software GL: a turntable, or one file to one PNG.

See common.py for the arguments. PyVista's default theme asks for eight multisamples; llvmpipe gives at most four.
glTF files, and OBJ files with an MTL file beside them, come in through VTK's importers, with materials and textures;
everything else through `pyvista.read`.
"""

import pathlib
import time
import warnings

import common

args = common.arguments()

import pyvista  # noqa: E402  (the environment must be set first)
import vtk  # noqa: E402

# VTK tries an X display first and says so on stderr before it takes EGL.
vtk.vtkObject.GlobalWarningDisplayOff()
vtk.vtkLogger.SetStderrVerbosity(vtk.vtkLogger.VERBOSITY_OFF)
warnings.simplefilter("ignore")


def add(plotter, model):
    """Puts the model into the scene, with materials where PyVista can."""
    materials = pathlib.Path(model).with_suffix(".mtl")
    if model.lower().endswith((".gltf", ".glb")):
        plotter.import_gltf(model)
    elif model.lower().endswith(".obj") and materials.exists():
        plotter.import_obj(model, filename_mtl=str(materials))
    else:
        plotter.add_mesh(pyvista.read(model))


def frame_every_view(plotter, count):
    """Widens the view angle until the model fits in each of `count` views round it; ends at the first view."""
    angles = []
    for _ in range(count):
        plotter.renderer.ResetCameraScreenSpace(0.9)
        angles.append(plotter.camera.view_angle)
        plotter.camera.azimuth += 360.0 / count
    plotter.renderer.ResetCameraScreenSpace(0.9)
    plotter.camera.view_angle = max(angles)


def turn(plotter, count):
    """The times of `count` frames round the model, from the new camera to the pixels."""
    times = common.Turntable()
    for _ in range(count):
        plotter.camera.azimuth += 360.0 / count
        plotter.reset_camera_clipping_range()
        times.frame(lambda: (plotter.render(), plotter.screenshot(return_img=True)))
    return times


def main():
    plotter = pyvista.Plotter(off_screen=True, window_size=(args.width, args.height))
    if args.samples == "1":
        plotter.disable_anti_aliasing()
    elif args.samples == "4":
        plotter.enable_anti_aliasing("msaa", multi_samples=4)

    start = time.perf_counter()
    add(plotter, args.model)
    loaded = time.perf_counter() - start
    plotter.view_xy()
    if args.output:
        plotter.renderer.ResetCameraScreenSpace(0.9)
        plotter.screenshot(args.output)
        return

    # Warm up: upload of the mesh, compilation of shaders.
    plotter.show(auto_close=False)
    frame_every_view(plotter, args.frames)
    plotter.reset_camera_clipping_range()
    plotter.render()
    frames = turn(plotter, args.frames)

    # See how much of the picture the model fills: without a background its alpha says so.
    image = plotter.screenshot(return_img=True, transparent_background=True)
    assert image.shape == (args.height, args.width, 4), f"PyVista gave {image.shape}"
    if args.look:
        plotter.screenshot(args.look)
    coverage = float((image[:, :, 3] > 0).mean())

    capabilities = plotter.render_window.ReportCapabilities().splitlines()
    renderer = next((line.split(":", 1)[1].strip() for line in capabilities if "renderer string" in line), "unknown")
    how = f"{plotter.render_window.GetMultiSamples()} multisamples"
    version = f"{pyvista.__version__}, VTK {vtk.vtkVersion.GetVTKVersion()}"
    common.report("pyvista", version, renderer, how, loaded, frames, coverage)


main()
