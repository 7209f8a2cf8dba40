"""Holds a file that Tyndall wrote against the file it was made from, both read by OpenVDB itself.

usage: openvdb_roundtrip.py ORIGINAL.vdb WRITTEN.vdb   (exit code 0: the same; 1: not, with the difference)
"""

import sys

import numpy

try:
    import openvdb as vdb
except ImportError:
    import pyopenvdb as vdb


def topology(grid):
    """The boxes of all active voxels and tiles."""
    return [(item.min, item.max, item.depth) for item in grid.citerOnValues()]


def values(grid, bbox, margin):
    """The bytes of all values in a box, so that NaN equals itself and -0 is not 0."""
    if grid.activeVoxelCount() == 0:
        return b""
    first = [coordinate - margin for coordinate in bbox[0]]
    shape = [last + margin + 1 - least for last, least in zip(bbox[1], first)]
    kind = {"BoolGrid": bool}.get(type(grid).__name__, numpy.float32)
    array = numpy.zeros(shape + [3] * isinstance(grid, vdb.Vec3SGrid), kind)
    grid.copyToArray(array, first)
    return array.tobytes()


def main(original_path, written_path):
    original = sorted(vdb.readAllGridMetadata(original_path), key=lambda grid: grid.name)
    written = sorted(vdb.readAllGridMetadata(written_path), key=lambda grid: grid.name)
    assert [g.name for g in original] == [g.name for g in written], "names"
    originals, writtens = vdb.readAll(original_path)[0], vdb.readAll(written_path)[0]
    # Sorting is stable, and grids of one name keep the order of the file.
    originals.sort(key=lambda grid: grid.name)
    writtens.sort(key=lambda grid: grid.name)
    for a, b in zip(originals, writtens):
        place = f"{written_path}: {a.name}: "
        assert type(a) is type(b), place + "type"
        assert a.gridClass == b.gridClass, place + "class"
        assert a.saveFloatAsHalf == b.saveFloatAsHalf, place + "half"
        assert repr(a.background) == repr(b.background), place + "background"
        for corner in [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]:
            x, y = a.transform.indexToWorld(corner), b.transform.indexToWorld(corner)
            assert all(abs(s - t) <= 1e-12 * (1 + abs(s)) for s, t in zip(x, y)), place + "transform"
        assert a.activeVoxelCount() == b.activeVoxelCount(), place + "voxels"
        assert a.leafCount() == b.leafCount(), place + "leaves"
        assert a.nonLeafCount() == b.nonLeafCount(), place + "inner nodes"
        bbox = a.evalActiveVoxelBoundingBox()
        assert topology(a) == topology(b), place + "which voxels and tiles are active"
        # A margin of two leaves shows inactive values, tiles among them, and the background.
        assert values(a, bbox, 16) == values(b, bbox, 16), place + "values"
        statistics = dict(b.metadata)
        assert statistics["file_voxel_count"] == a.activeVoxelCount(), place + "file_voxel_count"
        assert tuple(map(tuple, bbox)) == (statistics["file_bbox_min"], statistics["file_bbox_max"]), place + "box"
        assert statistics["is_saved_as_half_float"] == b.saveFloatAsHalf, place + "metadata of half"


if __name__ == "__main__":
    try:
        main(*sys.argv[1:])
    except AssertionError as difference:
        sys.exit(str(difference))
