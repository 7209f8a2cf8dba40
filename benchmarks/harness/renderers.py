"""The renderers of the bench, each in the mode that was best for it among the unbiased ones, and how to run them once.

Mitsuba's roulette, capped at 0.95, makes scene A heavy-tailed, and `volpathmis` biased: off there. Cycles renders by
null scattering, pbrt-v4 by `volpath`, Tyndall with evener samples on B, C and D, and adaptive ones on B and D (Cycles' own
adaptive sampling stops pixels by their own samples, which is biased). `seconds` is the time of rendering alone: without reading, building and
compiling, but for Cycles, which prepares its octrees inside the call; `cpu_seconds` is that of all threads.
"""

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from . import dense, environment
from .command import Failed, run
from .environment import SHARED, WORK


class Tyndall:
    """This renderer, by its command."""

    name, label = "tyndall", "Tyndall"
    samples = {"A": 16, "B": 64, "C": 64, "D": 64, "E": 64, "G": 16}
    sobol = ["--sampler", "sobol"]
    settings = {"B": [*sobol, "--adaptive"], "C": sobol, "D": [*sobol, "--adaptive"]}

    def __init__(self, binary, threads, options=()):
        self.binary, self.threads, self.options = binary, threads, list(options)

    def missing(self):
        """Why it cannot be run; None if it can."""
        return None

    def measure(self, scene, spp, seed):
        """Renders once; figures and the picture's file."""
        out, told = WORK / "tyndall.exr", WORK / "tyndall.json"
        command = [self.binary, "render", scene.file, "--spp", spp, "--seed", seed, "--threads", self.threads]
        settings = self.settings.get(scene.letter, [])
        done = run([*command, *settings, "--progress", "none", "-o", out, "-o", told, *self.options])
        # What reading and writing take is in the CPU seconds: from outside they cannot be told apart.
        figures = {"seconds": json.loads(told.read_text())["seconds"], "cpu_seconds": done.cpu}
        return figures | {"wall": done.wall, "memory": done.memory}, out


class Mitsuba:
    """Mitsuba 3 from the package index, one of its variants."""

    settings = {
        "A": {"rr": "1000000"},
        "D": {"integrator": "volpath_emis"},
        "E": {"integrator": "volpathmis", "rr": "1000000"},
        "G": {"rr": "1000000"},
    }
    files = {"D": "D_fire_noemission"}

    def __init__(self, variant, tyndall, threads):
        self.variant, self.tyndall, self.threads = variant, tyndall, threads
        self.vector = variant.startswith("llvm")
        self.name = "mitsuba-llvm" if self.vector else "mitsuba-scalar"
        self.label = "Mitsuba 3 LLVM" if self.vector else "Mitsuba 3 scalar"
        if self.vector:
            self.samples = {"A": 8, "B": 128, "C": 128, "D": 256, "E": 64, "G": 4}
        else:
            # The integrator with emission is written for the variants that compile.
            self.samples = {"A": 2, "B": 64, "C": 64, "E": 32, "G": 1}

    def missing(self):
        if not environment.has(sys.executable, ["mitsuba"]):
            return "the Python package mitsuba is not installed"
        if self.vector and environment.llvm_library() is None:
            return "no LLVM library was found; install libllvm19 or set DRJIT_LIBLLVM_PATH"
        return None

    def measure(self, scene, spp, seed):
        source = SHARED / "bench" / "mitsuba"
        folder = WORK / "mitsuba"
        shutil.copytree(source, folder, dirs_exist_ok=True)
        dense.make(self.tyndall, scene.letter)
        file = folder / (self.files.get(scene.letter, f"{scene.letter}_{scene.name}") + ".xml")
        out = WORK / f"{self.name}.npy"
        settings = [f"{key}={value}" for key, value in self.settings.get(scene.letter, {}).items()]
        worker = Path(__file__).with_name("mitsuba_worker.py")
        variant = self.variant
        environ = dict(os.environ)
        if self.vector:
            environ["DRJIT_LIBLLVM_PATH"] = environment.llvm_library()
        command = [sys.executable, worker, variant, file, out, spp, seed, self.threads, *settings]
        done = run(command, environ)
        return last_json(done.output) | {"wall": done.wall, "memory": done.memory}, out


class Cycles:
    """Blender's Cycles from the package index, by the script beside the scenes."""

    name, label = "cycles", "Cycles"
    samples = {"A": 8, "B": 64, "C": 64, "D": 32, "E": 32, "G": 4}
    settings = {"B": "~mis=DISTANCE"}

    def __init__(self, threads):
        self.threads = threads

    def missing(self):
        if not environment.has(sys.executable, ["bpy"]):
            return "the Python package bpy is not installed (it needs the Python that Blender is built for)"
        return None

    def measure(self, scene, spp, seed):
        script = SHARED / "bench" / "cycles" / "render_cycles.py"
        job = f"bench:null{self.settings.get(scene.letter, '')}:{spp}:{seed}"
        environ = {**os.environ, "THREADS": str(self.threads)}
        done = run([sys.executable, script, scene.letter, WORK / "cycles", job], environ)
        told = last_json(done.output.replace("JSON {", "\n{"))
        figures = {"seconds": told["wall"], "cpu_seconds": told["cpu"], "wall": done.wall, "memory": done.memory}
        return figures, WORK / "cycles_bench.exr"


class Pbrt:
    """pbrt-v4, if TYNDALL_PBRT names its program."""

    name, label = "pbrt", "pbrt-v4"
    samples = {"A": 16, "B": 128, "C": 32, "E": 32, "G": 8}

    def __init__(self, threads):
        self.threads, self.binary = threads, os.environ.get("TYNDALL_PBRT")

    def missing(self):
        if not self.binary:
            return "TYNDALL_PBRT does not name its program"
        return None if Path(self.binary).exists() else f"TYNDALL_PBRT: there is no {self.binary}"

    def measure(self, scene, spp, seed):
        out = WORK / "pbrt.exr"
        file = SHARED / "bench" / "pbrt" / f"{scene.letter}.pbrt"
        command = [self.binary, "--spp", spp, "--seed", seed, "--nthreads", self.threads, "--outfile", out, file]
        done = run(command)
        rendering = re.findall(r"Rendering.*?\(([\d.]+)s\)", done.output)
        seconds = float(rendering[-1]) if rendering else done.wall
        return {"seconds": seconds, "cpu_seconds": done.cpu, "wall": done.wall, "memory": done.memory}, out


def last_json(text):
    """The last line of a text that is an object."""
    lines = [line for line in text.splitlines() if line.startswith("{")]
    if not lines:
        raise Failed("it printed no figures")
    return json.loads(lines[-1])


def peers(tyndall, threads):
    """All but our own."""
    scalar, vector = (Mitsuba(variant, tyndall, threads) for variant in ("scalar_rgb", "llvm_ad_rgb"))
    return [vector, scalar, Cycles(threads), Pbrt(threads)]


def build():
    """Compiles the release build; the program's path."""
    command = ["cargo", "build", "--release", "--locked", "-p", "tyndall", "--message-format", "json-render-diagnostics"]
    done = subprocess.run(command, cwd=environment.ROOT, stdout=subprocess.PIPE, text=True)
    if done.returncode != 0:
        sys.exit("the release build failed")
    built = [json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")]
    return next(one["executable"] for one in reversed(built) if one.get("executable"))
