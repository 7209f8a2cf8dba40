"""Transfer functions: linear between points, exact at them, and mapped onto what scenes can say."""

from __future__ import annotations

import numpy as np
import pytest
import tyndall
from tyndall import TransferFunction


def test_coefficients_are_linear_between_points_and_constant_beyond() -> None:
    function = TransferFunction(
        [0, 10, 20], extinction=[0, 2, 1], albedo=[0.5, 1.0, 0.0], emission=[[0, 0, 0], [1, 2, 3], [0, 0, 0]]
    )
    assert np.allclose(function.extinction([-5, 0, 5, 10, 15, 20, 99, np.nan]), [0, 0, 1, 2, 1.5, 1, 1, 0])
    assert np.allclose(function.albedo(5), [0.75, 0.75, 0.75])
    assert np.allclose(function.emission([[5], [15]]), [[[0.5, 1, 1.5]], [[0.5, 1, 1.5]]])


def test_a_scene_has_the_coefficients_of_every_voxel() -> None:
    values = np.random.default_rng(2).uniform(-1, 4, (7, 5, 6)).astype(np.float32)
    function = TransferFunction([0, 1, 3], extinction=[0, 4, 8], albedo=[[0.9, 0.1, 0.2], [0.5, 0.5, 0.5], [1, 1, 1]])
    density, keys, glows = function.medium(values)
    assert density.dtype == np.float32 and density.max() <= 1 and not glows
    assert np.allclose(density * keys["mu_t"], function.extinction(values), atol=1e-5)
    assert np.allclose(keys["albedo"] * keys["albedo_grid"], function.albedo(values), atol=1e-6)


def test_a_glow_of_one_colour_is_one_grid_and_others_are_one_for_each_primary() -> None:
    values = np.linspace(-1, 2, 60).reshape(3, 4, 5)
    one = TransferFunction([0, 1], extinction=1, emission=[[0, 0, 0], [4, 2, 1]])
    several = TransferFunction([0, 1], extinction=1, emission=[[0, 1, 0], [4, 2, 0]])
    for function, count in ((one, 1), (several, 2)):
        _, _, glows = function.medium(values)
        assert len(glows) == count
        total = sum(strength[..., None] * np.array(radiance) for strength, radiance in glows)
        assert np.allclose(total, function.emission(values), atol=1e-6)


def test_colour_maps_are_spread_over_the_points_and_linear_light() -> None:
    def grey(x: np.ndarray) -> np.ndarray:
        return np.stack([x, x, x, np.ones_like(x)], axis=-1)

    function = TransferFunction([10, 30], extinction=1, albedo=grey, emission=grey, emission_scale=3)
    # Half the code value of sRGB is 0.2140 of the light.
    assert np.allclose(function.albedo(20), 0.2140, atol=5e-4)
    assert np.allclose(function.emission([10, 30]), [[0] * 3, [3] * 3])


def test_colour_maps_of_matplotlib_are_known_by_name() -> None:
    maps = pytest.importorskip("matplotlib").colormaps
    function = TransferFunction([0, 1], extinction=0, emission="inferno")
    # Its last colour, (252, 255, 164) of 255, in linear light.
    assert np.allclose(maps["inferno"](1.0)[:3], np.array([252, 255, 164]) / 255, atol=2e-3)
    assert np.allclose(function.emission(1), [0.974, 1.0, 0.371], atol=5e-3)


def test_a_reflectance_is_what_a_thick_layer_reflects() -> None:
    function = TransferFunction([0, 1], extinction=1, reflectance=[[0.2, 0.5, 0.8], [0.2, 0.5, 0.8]], g=0.3)
    albedo = function.albedo(0.5)
    fluxes = tyndall.measure.slab(np.inf, albedo, 0.3, incidence="diffuse", samples=20_000).reflectance
    assert np.all(np.abs(fluxes.mean - [0.2, 0.5, 0.8]) < 4 * fluxes.standard_error + 0.005)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"values": [1, 0], "extinction": 1}, "values: a list of increasing numbers"),
        ({"values": [], "extinction": []}, "values: a list"),
        ({"values": [0, np.nan], "extinction": 1}, "values: a list"),
        ({"values": [0, 1], "extinction": [1, 2, 3]}, "extinction: a number for each of the 2 points"),
        ({"values": [0, 1], "extinction": [-1, 2]}, "extinction: numbers of 0 or more"),
        ({"values": [0, 1], "extinction": 1, "albedo": 1.5}, "albedo: numbers from 0 to 1"),
        ({"values": [0, 1], "extinction": 1, "albedo": [0.5, 0.5, 0.5]}, "albedo: a number, a number or three"),
        ({"values": [0, 1], "extinction": 1, "albedo": 0.5, "reflectance": 0.5}, "albedo: give `albedo` or"),
        ({"values": [0, 1], "extinction": 1, "reflectance": 2}, "reflectance: numbers from 0 to 1"),
        ({"values": [0, 1], "extinction": 1, "emission": -1}, "emission: numbers of 0 or more"),
        ({"values": [0, 1], "extinction": 1, "emission_scale": -1}, "emission_scale: a number of 0 or more"),
        ({"values": [0, 1], "extinction": 1, "emission": "no such map"}, "emission: "),
        ({"values": [0, 1], "extinction": 1, "emission": lambda x: x}, "emission: the colour map must make"),
        ({"values": [0, 1], "extinction": 1, "g": 1}, "g: a number between -1 and 1"),
    ],
)
def test_impossible_functions_are_refused_in_one_line(arguments: dict[str, object], message: str) -> None:
    with pytest.raises(tyndall.Error) as caught:
        TransferFunction(**arguments)  # type: ignore[arg-type]
    assert message in str(caught.value) and "\n" not in str(caught.value)
