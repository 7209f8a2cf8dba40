"""The dense grids that Mitsuba's scenes name, made from the .vdb files.

Mitsuba's format: "VOL", a byte 3, then little-endian i32: encoding 1 (f32), sizes along x, y, z, channels; six f32, the
box; the values, x fastest. Mitsuba holds the outermost value beyond a grid, so the box has to be the scene's, not that
of the active voxels alone.
"""

import json
import struct
import subprocess
from dataclasses import dataclass

import numpy as np

from .environment import SHARED, WORK


@dataclass(frozen=True)
class Dense:
    """A grid of a file, and the voxels that the dense one begins and ends with."""

    name: str
    file: str
    grid: str
    first: tuple
    last: tuple


FIRE = ((0, 0, 0), (127, 191, 127))
GRIDS = {
    "A": [Dense("cloud", "bench/cloud.vdb", "density", (0, 0, 0), (199, 139, 199))],
    "B": [Dense("smoke", "bench/smoke.vdb", "density", (0, 0, 0), (127, 255, 127))],
    "D": [
        Dense("fire", "bench/fire.vdb", "density", *FIRE),
        Dense("fire_emission", "bench/fire.vdb", "emission", *FIRE),
    ],
    "G": [Dense("wdas", "volumes/wdas_cloud_sixteenth.vdb", "density", (-67, -22, -91), (60, 65, 64))],
}


def make(tyndall, letter):
    """Makes the grids of a scene in the working folder, if they are not there."""
    for dense in GRIDS.get(letter, []):
        target = WORK / f"{dense.name}.vol"
        if not target.exists():
            write(target, *load(tyndall, dense))


def load(tyndall, dense):
    """The values, indexed x, y, z, and the box's corners in the world."""
    file = SHARED / dense.file
    described = json.loads(subprocess.check_output([tyndall, "inspect", file, "--json"]))
    grid = next(grid for grid in described["grids"] if grid["name"] == dense.grid)
    active = WORK / f"{dense.name}.npy"
    command = [tyndall, "convert", file, active, "--grid", dense.grid]
    subprocess.run(command, check=True, capture_output=True)
    first, last = np.array(dense.first), np.array(dense.last)
    values = np.zeros(last - first + 1, np.float32)
    start = np.array(grid["index_bbox"][0]) - first
    part = np.load(active)
    active.unlink()
    values[tuple(slice(s, s + n) for s, n in zip(start, part.shape))] = part
    to_world = np.array(grid["index_to_world"])
    corners = [to_world[:3, :3] @ corner + to_world[:3, 3] for corner in (first - 0.5, last + 0.5)]
    return values, corners


def write(path, values, corners):
    """Writes the format above."""
    header = b"VOL\x03" + struct.pack("<5i6f", 1, *values.shape, 1, *corners[0], *corners[1])
    part = path.with_suffix(".part")
    part.write_bytes(header + np.ascontiguousarray(values.transpose(2, 1, 0)).tobytes())
    part.rename(path)
