#!/usr/bin/env python3
"""vitral's rays beside Embree's: the same triangles, the same rays, in turns; prints a table of times and ratios.

Usage: compare.py [--threads 1 --threads N] [--rounds N] MODEL...

Needs a C++ compiler and Embree 3 (Debian: libembree-dev). Builds the harness beside this file and the example
`ray_bench` of the crate `vitral` in release mode; works in a temporary folder. A ratio above 1 means that vitral is faster.
`picture` is a pass of `--visibility ray-cast`, with everything that a view needs, for one ray in the middle of each pixel;
`single` follows the same rays one by one.
"""

import argparse
import json
import os
import pathlib
import statistics
import subprocess
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[2]


def build(folder):
    """The two programs."""
    harness = folder / "harness"
    flags = ["-O3", "-march=native", "-std=c++17", "-Wall", "-Wextra"]
    source = str(HERE / "harness.cpp")
    subprocess.run(["g++", *flags, source, "-o", str(harness), "-lembree3", "-lpthread"], check=True)
    cargo = ["cargo", "build", "--release", "-p", "vitral", "--example", "ray_bench"]
    subprocess.run(cargo, check=True, cwd=ROOT)
    target = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
    return harness, target / "release" / "examples" / "ray_bench"


def run(*command):
    """The JSON object that a program prints."""
    done = subprocess.run([str(c) for c in command], check=True, stdout=subprocess.PIPE)
    return json.loads(done.stdout) if done.stdout.strip() else None


def measure(harness, bench, folder, model, threads, rounds):
    """Both in turns, two times each; the times of all rounds together."""
    rays, answers = folder / "rays.bin", folder / "answers.bin"
    run(bench, "prepare", model, rays)
    theirs = {"build_ms": [], "rays_ms": []}
    ours = {"build_ms": [], "picture_ms": [], "single_ms": []}
    for _ in range(2):
        times = run(harness, rays, answers, threads, rounds)
        report = run(bench, "measure", model, answers, threads, rounds)
        for key in theirs:
            theirs[key] += times[key]
        for key in ours:
            ours[key] += report[key]
    return theirs, ours, report


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("models", nargs="+", type=pathlib.Path)
    parser.add_argument("--threads", action="append", type=int)
    parser.add_argument("--rounds", type=int, default=7)
    options = parser.parse_args()
    threads_list = options.threads or [1, os.cpu_count()]
    print("| model | threads | build: Embree, vitral (ratio) | rays: Embree | picture (ratio) | single (ratio) "
          "| rays that differ: picture, single, between structures | octree: build, picture | grid: build, picture |")
    print("|---|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        harness, bench = build(folder)
        for model in options.models:
            for threads in threads_list:
                theirs, ours, report = measure(harness, bench, folder, model.resolve(), threads, options.rounds)
                theirs = {key: statistics.median(times) for key, times in theirs.items()}
                ours = {key: statistics.median(times) for key, times in ours.items()}
                build_ratio = theirs["build_ms"] / ours["build_ms"]
                picture, single = (theirs["rays_ms"] / ours[key] for key in ("picture_ms", "single_ms"))
                print(f"| {model.stem}, {report['triangles']} triangles, {report['hits']} hits | {threads} "
                      f"| {theirs['build_ms']:.1f}, {ours['build_ms']:.1f} ({build_ratio:.2f}) "
                      f"| {theirs['rays_ms']:.1f} "
                      f"| {ours['picture_ms']:.1f} ({picture:.2f}) | {ours['single_ms']:.1f} ({single:.2f}) "
                      f"| {report['picture_differs']}, {report['single_differs']}, {report['structures_differ']} "
                      f"| {report['octree_build_ms']:.1f}, {report['octree_picture_ms']:.1f} "
                      f"| {report['grid_build_ms']:.1f}, {report['grid_picture_ms']:.1f} |", flush=True)


if __name__ == "__main__":
    main()
