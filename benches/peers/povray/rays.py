#!/usr/bin/env python3
"""vitral's ray tracing beside POV-Ray's: the same triangles, one light, one ray a pixel, in turns; prints a table.

Usage: rays.py [--threads N] [--rounds N] [--look FOLDER] MODEL.obj...

Needs POV-Ray 3.7 (Debian: povray) and the command `vitral` in release mode, which is built. Textures are left out for
both: the model is written anew, for vitral as an OBJ without maps, for POV-Ray as a `mesh2` with a texture for each
material. Both see it from one camera, under one parallel light with shadows, through the same pixels; transparent faces
let rays and light straight through, in the part that their opacity leaves. vitral casts its eye rays, too
(`--visibility ray-cast`): whole processes are compared, by the processor time that they took, model and picture
included. Rays are counted by vitral: those of the eye, those that go on, and those to the light. POV-Ray has to follow
the same ones, so the ratio of the times for a ray is that of the times.
"""

import argparse
import json
import math
import os
import pathlib
import resource
import statistics
import subprocess
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[3]
WIDTH, HEIGHT = 1024, 768
VIEW_ANGLE = 30.0
LIGHT = (-1.0, -2.0, -1.0)


class Model:
    """Corners, and faces by material; everything else of the file is left out."""

    def __init__(self, path):
        self.corners, self.faces, self.materials = [], [], {}
        material = None
        for line in path.read_text(encoding="utf-8", errors="replace").splitlines():
            word, *rest = line.split() or [""]
            if word == "mtllib":
                self.read_materials(path.parent / rest[0])
            elif word == "v":
                self.corners.append(tuple(float(x) for x in rest[:3]))
            elif word == "usemtl":
                material = rest[0]
            elif word == "f":
                indices = [int(corner.split("/")[0]) for corner in rest]
                face = [i - 1 if i > 0 else len(self.corners) + i for i in indices]
                # A fan, for both: no face is cut in two ways.
                self.faces += [(material, (face[0], face[k], face[k + 1])) for k in range(1, len(face) - 1)]

    def read_materials(self, path):
        """Diffuse and specular colour, shininess, opacity."""
        for line in path.read_text(encoding="utf-8", errors="replace").splitlines():
            word, *rest = line.split() or [""]
            if word == "newmtl":
                current = self.materials[rest[0]] = {"Kd": [0.8] * 3, "Ks": [0.0] * 3, "Ns": [10.0], "d": [1.0]}
            elif word in ("Kd", "Ks", "Ns", "d"):
                current[word] = [float(x) for x in rest]

    def camera(self):
        """Where the viewer is and looks: from the front, above and to the right, so far that the box's sphere fits."""
        low, high = ([f(c[k] for c in self.corners) for k in range(3)] for f in (min, max))
        middle = [(a + b) / 2 for a, b in zip(low, high)]
        radius = math.dist(low, high) / 2
        way = (0.5, 0.35, 1.0)
        distance = radius / math.sin(math.radians(VIEW_ANGLE / 2)) / math.hypot(*way)
        return [m + w * distance for m, w in zip(middle, way)], middle

    def write_obj(self, path):
        """For vitral."""
        with path.open("w", encoding="ascii") as out:
            print("mtllib model.mtl", file=out)
            for corner in self.corners:
                print("v", *corner, file=out)
            for name, face in self.faces:
                print(f"usemtl {name}", file=out)
                print("f", *(i + 1 for i in face), file=out)
        with path.with_name("model.mtl").open("w", encoding="ascii") as out:
            for name, material in self.materials.items():
                print(f"newmtl {name}\nKa 0 0 0\nillum 2", file=out)
                for key, values in material.items():
                    print(key, *values, file=out)

    def write_pov(self, path):
        """For POV-Ray, whose z axis points away from the viewer: the picture is mirrored by the camera instead."""
        position, target = self.camera()
        angle = 2 * math.degrees(math.atan(math.tan(math.radians(VIEW_ANGLE / 2)) * WIDTH / HEIGHT))
        vector = lambda v: "<" + ", ".join(f"{x:.9g}" for x in v) + ">"  # noqa: E731
        away = [t - 1e5 * d for t, d in zip(target, LIGHT)]
        numbers = {name: number for number, name in enumerate(self.materials)}
        with path.open("w", encoding="ascii") as out:
            print("#version 3.7; global_settings { assumed_gamma 1 max_trace_level 16 }", file=out)
            print(f"camera {{ location {vector(position)} right -x*{WIDTH}/{HEIGHT} up y angle {angle:.9g}", file=out)
            print(f"  look_at {vector(target)} }}", file=out)
            print(f"light_source {{ {vector(away)} rgb 1 parallel point_at {vector(target)} }}", file=out)
            print("mesh2 { vertex_vectors {", len(self.corners), *(f", {vector(c)}" for c in self.corners), "}", file=out)
            print("texture_list {", len(self.materials), file=out)
            for m in self.materials.values():
                print(f", texture {{ pigment {{ rgb {vector(m['Kd'])} transmit {1 - m['d'][0]:.9g} }}", file=out)
                shine = f"phong {max(m['Ks']):.9g} phong_size {max(m['Ns'][0], 1):.9g}"
                print(f"  finish {{ ambient 0 diffuse 1 {shine} }} }}", file=out)
            print("} face_indices {", len(self.faces), file=out)
            for name, face in self.faces:
                print(f", {vector(face)}, {numbers[name]}", file=out)
            print("} }", file=out)


def run(command):
    """Seconds by the clock, processor seconds, and what it told."""
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    done = subprocess.run([str(c) for c in command], check=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    wall, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    return wall, after.ru_utime - before.ru_utime, done.stderr


def measure(path, vitral, arguments, folder):
    """A row of the table."""
    model = Model(path)
    model.write_obj(folder / "model.obj")
    model.write_pov(folder / "model.pov")
    position, target = model.camera()
    comma = lambda v: ",".join(f"{x:.9g}" for x in v)  # noqa: E731
    ours = [vitral, "render", folder / "model.obj", "-o", folder / "vitral.png", "--stats"]
    ours += ["--resolution", f"{WIDTH}x{HEIGHT}", "--samples", 1, "--threads", arguments.threads]
    ours += ["--global", "ray-trace", "--visibility", "ray-cast", f"--light=directional:direction={comma(LIGHT)}"]
    ours += [f"--camera-position={comma(position)}", f"--camera-focal-point={comma(target)}"]
    ours += ["--camera-view-up=0,1,0", f"--camera-view-angle={VIEW_ANGLE}", "--background-color=black"]
    theirs = ["povray", f"+I{folder / 'model.pov'}", f"+O{folder / 'povray.png'}", f"+W{WIDTH}", f"+H{HEIGHT}"]
    theirs += [f"+WT{arguments.threads}", "-A", "-D", "-P", "-GA"]
    times = {"ours": [], "theirs": []}
    for _ in range(arguments.rounds):
        wall, cpu, told = run(ours)
        times["ours"].append((cpu, wall))
        wall, cpu, _ = run(theirs)
        times["theirs"].append((cpu, wall))
    tracing = json.loads(told[told.index("{") :])["frames"][0]["tracing"]
    rays = WIDTH * HEIGHT + tracing["rays"] + tracing["shadow-rays"]
    best = {who: [min(t[k] for t in of) for k in (0, 1)] for who, of in times.items()}
    ratio = statistics.median(b[0] / a[0] for a, b in zip(times["ours"], times["theirs"]))
    cells = [path.stem, len(model.faces), f"{rays / 1e6:.2f} M"]
    for who in ("ours", "theirs"):
        cells += [f"{best[who][0]:.2f} ({best[who][1]:.2f})", f"{best[who][0] / rays * 1e9:.0f}"]
    print("|", " | ".join(str(c) for c in [*cells, f"{ratio:.1f}"]), "|")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("models", nargs="+", type=pathlib.Path)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--vitral", type=pathlib.Path, help="the command, if it is not to be built")
    parser.add_argument("--look", type=pathlib.Path, help="leave scenes and pictures here")
    arguments = parser.parse_args()
    vitral = arguments.vitral
    if vitral is None:
        subprocess.run(["cargo", "build", "--release", "-p", "vitral-cli"], check=True, cwd=ROOT)
        vitral = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "release" / "vitral"
    print("| model | triangles | rays | vitral, s (clock) | ns a ray | POV-Ray, s (clock) | ns a ray | ratio |")
    print("|---|---|---|---|---|---|---|---|")
    for path in arguments.models:
        with tempfile.TemporaryDirectory() as folder:
            folder = arguments.look or pathlib.Path(folder)
            measure(path, vitral, arguments, folder)


if __name__ == "__main__":
    main()
