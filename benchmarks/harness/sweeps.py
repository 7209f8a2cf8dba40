"""The sweeps of `growth`: what is varied, and what is measured at each step."""

import json
import os
import random
from dataclasses import dataclass
from typing import Callable

import numpy as np

from . import picture
from .command import run
from .environment import BENCHMARKS, SHARED, WORK

TO_ERROR = 1e-3
EQUAL_ERROR = "seconds to relMSE 0.1 %"


@dataclass(frozen=True)
class Sweep:
    """One scene along one axis."""

    name: str
    title: str
    axis: str
    steps: list
    # Names of figures that `measure` gives, which are plotted and fitted.
    quantities: list
    measure: Callable
    # Where a step stands on the axis.
    x: Callable = float


def every(tyndall, quick):
    """All sweeps."""
    seeds = 2 if quick else 4
    size = "64x64" if quick else "128x128"

    def render(scene, spp, *options):
        return time_at_equal_error(tyndall, scene, spp, seeds, ["--resolution", size, *options])

    cloud = BENCHMARKS / "scenes" / "A_cloud.toml"
    threads = sorted({1, max(os.cpu_count() // 2, 1), os.cpu_count()})
    return [
        Sweep(
            "thickness",
            "Scene A, extinction times a factor",
            "factor on the optical thickness",
            [1, 4, 16, 64] if quick else [1, 2, 4, 8, 16, 32, 64],
            [EQUAL_ERROR],
            lambda factor: render(cloud, 16, "--set", f"volume.0.mu_t={50 * factor}"),
        ),
        Sweep(
            "albedo",
            "Scene A, albedo 0 to 1",
            "1 / (1.0001 - albedo)",
            [0.0, 0.9, 0.999, 1.0] if quick else [0.0, 0.5, 0.8, 0.9, 0.97, 0.99, 0.999, 1.0],
            [EQUAL_ERROR],
            lambda albedo: render(cloud, 16, "--set", f"volume.0.albedo={albedo}"),
            lambda albedo: 1.0 / (1.0001 - albedo),
        ),
        Sweep(
            "voxels",
            "Built-in cumulus, finer and finer",
            "voxels along an edge",
            [64, 128, 256] if quick else [64, 128, 256, 512, 1024],
            [EQUAL_ERROR],
            lambda edge: render(None, 16, "--set", f"volume.0.procedural.resolution={edge}"),
        ),
        Sweep(
            "load",
            "A .vdb file of finer and finer detail",
            "active voxels",
            [128, 256] if quick else [128, 192, 256, 384, 512],
            ["seconds to load", "peak memory / MB"],
            lambda edge: load(tyndall, edge),
            active_voxels,
        ),
        Sweep(
            "lights",
            "Scene B, its light from more and more points",
            "point lights",
            [1, 10, 100, 1000],
            [EQUAL_ERROR],
            lambda number: render(many_lights(number), 16),
        ),
        Sweep(
            "cores",
            "Scene A on more threads",
            "threads",
            threads,
            ["seconds"],
            lambda number: time_at_equal_error(tyndall, cloud, 4 if quick else 16, 2, ["--threads", number]),
        ),
        Sweep(
            "samples",
            "Scene A with more samples",
            "samples a pixel",
            [1, 4, 16, 64] if quick else [1, 4, 16, 64, 256],
            ["relMSE", "seconds"],
            lambda spp: render(cloud, spp),
        ),
    ]


def time_at_equal_error(tyndall, scene, spp, seeds, options):
    """Renders a scene (None: the built-in one) with several seeds, and compares them with each other."""
    out, told = WORK / "growth.exr", WORK / "growth.json"
    pictures, seconds, walls = [], [], []
    for seed in range(1, seeds + 1):
        command = [tyndall, "render", *([scene] if scene else []), "--spp", spp, "--seed", seed, *options]
        done = run([*command, "--progress", "none", "-o", out, "-o", told])
        pictures.append(picture.read(out))
        seconds.append(json.loads(told.read_text())["seconds"])
        walls.append(done.wall)
    # Over the picture's mean, not each pixel's, which few seeds at few samples know too badly to divide by.
    relmse = float((np.var(pictures, 0, ddof=1).mean((0, 1)) / np.mean(pictures, (0, 1, 2)) ** 2).mean())
    took = float(np.mean(seconds))
    return {
        "spp": spp,
        "seeds": seeds,
        "seconds": took,
        "seconds outside rendering": float(np.mean(walls)) - took,
        "relMSE": relmse,
        EQUAL_ERROR: took * relmse / TO_ERROR,
    }


def many_lights(number):
    """Scene B with its lights replaced by `number` on a sphere around it, which are as bright together."""
    text = (BENCHMARKS / "scenes" / "B_smoke.toml").read_text().replace("../../../shared", str(SHARED))
    place = random.Random(7)
    lights = []
    for _ in range(number):
        direction = [place.gauss(0, 1) for _ in range(3)]
        length = sum(c * c for c in direction) ** 0.5
        position = [2.5 * c / length for c in direction]
        position[1] = abs(position[1]) + 0.2
        intensity = [c / number for c in (10, 10, 11)]
        lights.append(f'[[light]]\ntype = "point"\nposition = {position}\nintensity = {intensity}\n')
    file = WORK / f"lights_{number}.toml"
    file.write_text(text[: text.index("[[light]]")] + "\n".join(lights))
    return file


def detailed_file(tyndall, edge):
    """A .vdb of a ball with ripples of ever smaller length, down to a few voxels; made once."""
    file = WORK / f"detail_{edge}.vdb"
    if not file.exists():
        array = WORK / f"detail_{edge}.npy"
        axis = np.linspace(-1, 1, edge, dtype=np.float32)
        y, z = axis[:, None], axis[None, :]
        # Never all of it at once: what this process holds counts as its children's, until they hold more.
        with array.open("wb") as out:
            header = {"descr": "<f4", "fortran_order": False, "shape": (edge,) * 3}
            np.lib.format.write_array_header_1_0(out, header)
            for x in axis:
                slab, waves = 0.8 - np.sqrt(x * x + y * y + z * z), 4.0
                while waves < edge / 2:
                    ripple = np.sin(waves * x + 1) * np.sin(waves * y + 2) * np.sin(waves * z + 3)
                    slab, waves = slab + ripple / np.sqrt(waves), 2 * waves
                out.write(np.clip(slab, 0, 1).astype("<f4").tobytes())
        part = file.with_suffix(".part.vdb")
        run([tyndall, "convert", array, part])
        part.rename(file)
        array.unlink()
    return file


def load(tyndall, edge):
    """Seconds and memory that a file takes, beyond one of 16 voxels along an edge."""
    seconds, memory = load_once(tyndall, edge)
    least_seconds, least_memory = load_once(tyndall, 16)
    file = detailed_file(tyndall, edge)
    described = json.loads(run([tyndall, "inspect", file, "--json"]).output)["grids"][0]
    (WORK / f"detail_{edge}.active").write_text(str(described["active_voxels"]))
    return {
        "seconds to load": seconds - least_seconds,
        "peak memory / MB": (memory - least_memory) / 1e6,
        "of the least file": [least_seconds, least_memory / 1e6],
        "file / MB": file.stat().st_size / 1e6,
        "active voxels": described["active_voxels"],
    }


def load_once(tyndall, edge):
    """The least of three: seconds that a small render takes besides rendering, and the bytes it holds at most."""
    told = WORK / "growth.json"
    command = [tyndall, "render", detailed_file(tyndall, edge), "--spp", 1, "--resolution", "8x8", "--progress", "none"]
    taken = []
    for _ in range(3):
        done = run([*command, "-o", told])
        taken.append((done.wall - json.loads(told.read_text())["seconds"], done.memory))
    return tuple(min(values) for values in zip(*taken))


def active_voxels(edge):
    """Active voxels of the file of that edge, once it is measured."""
    return float((WORK / f"detail_{edge}.active").read_text())
