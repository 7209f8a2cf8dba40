"""Volumes: any array is the grid that its .npy file would be."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
import tyndall


def picture(volume: tyndall.Volume | str) -> np.ndarray:
    scene = {
        "camera": {"position": [10, 12, 60], "target": [6, 9, 8], "vertical_fov": 25},
        "film": {"resolution": [16, 12]},
        "volume": {"file": volume, "mu_t": 0.3, "albedo": 0.9},
        "light": {"sun": {"type": "sun", "direction": [-1, -1, 0], "irradiance": 3}},
    }
    return tyndall.render(scene, spp=4, progress=False).image


@pytest.mark.parametrize("order", ["C", "F"])
def test_an_array_gives_the_same_picture_as_its_file(blob: np.ndarray, order: str) -> None:
    array = np.asarray(blob, order=order)
    np.save("blob.npy", array)
    from_file, from_array = picture("blob.npy"), picture(tyndall.Volume(array))
    assert from_file.mean() > 0.01
    np.testing.assert_array_equal(from_file, from_array)


def test_strides_types_and_byte_orders_do_not_matter(blob: np.ndarray) -> None:
    numbers = np.round(blob * 100)
    expected = tyndall.Volume(numbers.astype("f4"))
    for kind in ["f2", "i1", "u1", "i2", "u2", ">f4", ">i2"]:
        assert tyndall.Volume(numbers.astype(kind)).hash == expected.hash, kind
    doubles = tyndall.Volume(numbers.astype("f8"))
    for kind in ["i4", "u4", "i8", "u8", ">f8", ">u4"]:
        assert tyndall.Volume(numbers.astype(kind)).hash == doubles.hash, kind
    padded = np.zeros((24, 20, 32), "f4")
    padded[::2, ::-1, 1::2] = numbers
    assert tyndall.Volume(padded[::2, ::-1, 1::2]).hash == expected.hash
    packed = np.zeros(numbers.shape, dtype=[("a", "u1"), ("value", "f4")])
    packed["value"] = numbers
    assert tyndall.Volume(packed["value"]).hash == expected.hash
    assert tyndall.Volume(numbers.tolist()).hash == doubles.hash


def test_booleans_are_0_and_1_whatever_their_bytes(blob: np.ndarray) -> None:
    bytes_ = (blob > 0.5).astype("u1") * 7
    np.testing.assert_array_equal(tyndall.Volume(bytes_.view(bool)).array, (blob > 0.5).astype("f4"))


def test_a_volume_gives_its_array_and_place_back(blob: np.ndarray) -> None:
    volume = tyndall.Volume(blob, spacing=(1, 2, 0.5), origin=(10, 0, -1), name="soot")
    np.testing.assert_array_equal(volume.array, blob)
    assert volume.shape == blob.shape and volume.name == "soot"
    assert volume.index_to_world.tolist() == [[1, 0, 0, 10], [0, 2, 0, 0], [0, 0, 0.5, -1], [0, 0, 0, 1]]
    vectors = np.stack([blob, -blob, 0 * blob], axis=-1)
    np.testing.assert_array_equal(tyndall.Volume(vectors).array, vectors)
    matrix = np.array([[0, 0, 2, 1], [0, 1, 0, 0], [-1, 0, 0, 0], [0, 0, 0, 1.0]])
    np.testing.assert_array_equal(tyndall.Volume(blob, index_to_world=matrix).index_to_world, matrix)


@pytest.mark.parametrize("name", ["a.vdb", "a.nvdb", "a.vol", "a.npy", "a.nii.gz"])
def test_a_volume_is_saved_and_loaded(blob: np.ndarray, name: str) -> None:
    written = tyndall.Volume(blob).save(name)
    np.testing.assert_allclose(tyndall.Volume.load(written).array, blob, rtol=1e-6)


def test_pickling_keeps_the_hash(blob: np.ndarray) -> None:
    for array in [blob, blob.astype("f8"), np.stack([blob, blob, blob], axis=-1), np.pad(blob, 8)]:
        volume = tyndall.Volume(array, spacing=0.1, origin=(1, 2, 3))
        copy = pickle.loads(pickle.dumps(volume))
        assert copy.hash == volume.hash
        np.testing.assert_array_equal(copy.index_to_world, volume.index_to_world)


def test_later_changes_of_the_array_do_not_change_the_volume(blob: np.ndarray) -> None:
    volume = tyndall.Volume(blob)
    before = volume.array
    blob[:] = 0
    np.testing.assert_array_equal(volume.array, before)


@pytest.mark.parametrize(
    ("array", "options", "message"),
    [
        (np.zeros((4, 4)), {}, "an array of 2 axes [4, 4] is no volume; give one of shape (X, Y, Z) or (X, Y, Z, 3)"),
        (np.zeros((4, 4, 4, 2)), {}, "an array of 4 axes"),
        (np.zeros((4, 0, 4)), {}, "has none at all"),
        (np.zeros((2, 2, 2), complex), {}, "`complex128` is no volume; give it .astype('float32')"),
        (np.array([["a"]]), {}, "is no volume"),
        (np.broadcast_to(np.float32(1), (1 << 20,) * 3), {}, "too large for any memory"),
        (np.zeros((2, 2, 2)), {"spacing": 0}, "spacing: must be above 0"),
        (np.zeros((2, 2, 2)), {"spacing": (1, 2)}, "spacing: give a length, or three"),
        (np.zeros((2, 2, 2)), {"spacing": float("nan")}, "spacing: give a length"),
        (np.zeros((2, 2, 2)), {"spacing": "3 kg"}, 'spacing: "3 kg": `kg` is no unit of length or angle'),
        (np.zeros((2, 2, 2)), {"spacing": "1 mm", "origin": 1}, "give both as lengths with units"),
        (np.zeros((2, 2, 2)), {"index_to_world": np.zeros((4, 4))}, "index_to_world: give a 4x4 matrix"),
        (np.zeros((2, 2, 2)), {"index_to_world": np.eye(4), "spacing": 1}, "says spacing and origin too"),
    ],
)
def test_what_is_no_volume_is_refused_in_one_line(array: np.ndarray, options: dict, message: str) -> None:
    with pytest.raises(tyndall.Error) as error:
        tyndall.Volume(array, **options)
    assert message in str(error.value) and "\n" not in str(error.value)


def test_files_that_are_not_there_or_no_volumes_are_told() -> None:
    with pytest.raises(OSError, match="none.vdb: "):
        tyndall.Volume.load("none.vdb")
    with open("text.vdb", "w") as file:
        file.write("no volume")
    with pytest.raises(tyndall.Error, match="text.vdb: not a file of the format OpenVDB"):
        tyndall.Volume.load("text.vdb")
    with pytest.raises(tyndall.Error, match="the bytes are not those of a Volume"):
        tyndall.Volume.from_bytes(b"")


def test_values_that_are_not_finite_count_as_0_and_are_told(blob: np.ndarray) -> None:
    broken = blob.copy()
    broken[0, 0, :5] = np.nan
    scene = tyndall.Scene.of_volume(tyndall.Volume(broken))
    scene["film.resolution"] = [4, 4]
    picture = tyndall.render(scene, spp=1, progress=False)
    assert any("5 values" in note and "not finite" in note for note in picture.notes)
    assert np.isfinite(picture.image).all()
