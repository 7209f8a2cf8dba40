"""Volumes from xarray, and pictures to it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import tyndall

xarray = pytest.importorskip("xarray")


def labelled(blob: np.ndarray, **attributes: str) -> Any:
    """The blob with coordinates, its axes in the order that models of the air have."""
    nx, ny, nz = blob.shape
    places = {
        "z": ("z", 10 + 2.0 * np.arange(nz), attributes),
        "y": ("y", -3 + 0.5 * np.arange(ny), attributes),
        "x": ("x", 1.0 * np.arange(nx), attributes),
    }
    return xarray.DataArray(blob.transpose(2, 1, 0), dims=("z", "y", "x"), coords=places)


def test_coordinates_give_the_place_and_names_the_axes(blob: np.ndarray) -> None:
    volume = tyndall.Volume(labelled(blob))
    assert volume.hash == tyndall.Volume(blob, spacing=(1, 0.5, 2), origin=(0, -3, 10)).hash


def test_falling_coordinates_are_turned(blob: np.ndarray) -> None:
    data = labelled(blob)
    assert tyndall.Volume(data.isel(y=slice(None, None, -1))).hash == tyndall.Volume(data).hash


def test_units_of_coordinates_are_lengths(blob: np.ndarray) -> None:
    scene: dict[str, Any] = {
        "camera": {"position": [0, 0, 5], "target": [0, 0, 0]},
        "volume": {"file": tyndall.Volume(labelled(blob, units="km")), "mu_t": 1, "albedo": 1},
    }
    in_metres = tyndall.Scene(scene).hash
    scene["volume"]["file"] = tyndall.Volume(blob, spacing=["1 km", "500 m", "2 km"], origin=["0 m", "-3 km", "10 km"])
    assert tyndall.Scene(scene).hash == in_metres


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda data: data.assign_coords(z=data.z**2), "the coordinates along z are not evenly spaced; interpolate"),
        (lambda data: data.rename(z="height"), "has the dimensions x, y and z, not height, y, x; rename"),
        (lambda data: data.drop_vars("y"), "there are no coordinates along y; give spacing and origin"),
        (lambda data: data.isel(z=[3]), "a single coordinate along z"),
        (lambda data: data.isel(z=3), "has the dimensions x, y and z"),
        (lambda data: data.assign_coords(x=[f"{place}" for place in data.x.values]), "along x are no numbers"),
    ],
)
def test_coordinates_that_are_no_place_are_refused(blob: np.ndarray, change: Any, message: str) -> None:
    with pytest.raises(tyndall.Error, match=message):
        tyndall.Volume(change(labelled(blob)))


def test_units_that_are_no_lengths_or_differ_are_refused(blob: np.ndarray) -> None:
    with pytest.raises(tyndall.Error, match="in `degrees`, which is no length"):
        tyndall.Volume(labelled(blob, units="degrees"))
    data = labelled(blob, units="m")
    data.z.attrs["units"] = "km"
    with pytest.raises(tyndall.Error, match="in different units"):
        tyndall.Volume(data)
    assert tyndall.Volume(data, spacing=1).shape == blob.shape


def test_a_picture_becomes_a_dataset(ball: dict[str, Any]) -> None:
    picture = tyndall.render(ball, spp=4, seed=3, progress=False)
    data = picture.to_xarray()
    assert dict(data.sizes) == {"y": 14, "x": 20, "channel": 3}
    np.testing.assert_array_equal(data.image.sel(channel="G"), picture.image[..., 1])
    assert data.attrs["seed"] == 3 and data.attrs["samples"] == "0..4"
    assert {"standard_error", "Depth", "Albedo", "Single"} <= set(data.data_vars)
