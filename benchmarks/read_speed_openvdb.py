"""Times full loads of .vdb files by OpenVDB, as the example `read_speed` of tyndall-volumes times Tyndall's.

usage: read_speed_openvdb.py [--runs N] FILE...      read_speed_openvdb.py --version

One line a file: its name, the number of runs, the least and the median time in milliseconds, and the number of
active voxels. OpenVDB puts off the reading of leaves until they are touched unless OPENVDB_DISABLE_DELAYED_LOAD is
set, as it is here; that all leaves are in memory is checked once a file.
"""

import os
import sys
import time

os.environ["OPENVDB_DISABLE_DELAYED_LOAD"] = "1"
try:
    import openvdb as vdb
except ImportError:
    import pyopenvdb as vdb


def in_memory(grid):
    """Whether the memory of the grid is at least what the values of its leaves take."""
    bytes_a_value = {"BoolGrid": 1 / 8, "Vec3SGrid": 12}.get(type(grid).__name__, 4)
    return grid.memUsage() >= grid.leafCount() * 512 * bytes_a_value


def time_loads(path, runs):
    grids, _ = vdb.readAll(path)
    assert all(map(in_memory, grids)), f"{os.path.basename(path)}: leaves were left on disk"
    active_voxels = sum(grid.activeVoxelCount() for grid in grids)
    del grids
    milliseconds = []
    for _ in range(runs):
        start = time.perf_counter()
        grids = vdb.readAll(path)
        milliseconds.append((time.perf_counter() - start) * 1e3)
        del grids
    milliseconds.sort()
    least, median = milliseconds[0], milliseconds[runs // 2]
    print(f"{os.path.basename(path)} {runs} {least:.3f} {median:.3f} {active_voxels}", flush=True)


def main(arguments):
    if arguments == ["--version"]:
        return print(".".join(map(str, vdb.LIBRARY_VERSION)))
    runs = 15
    if arguments[:1] == ["--runs"]:
        runs, arguments = int(arguments[1]), arguments[2:]
    for path in arguments:
        time_loads(path, runs)


if __name__ == "__main__":
    main(sys.argv[1:])
