"""Units: text and quantities of pint where lengths, coefficients and angles are."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import tyndall

Ball = dict[str, Any]


def test_lengths_coefficients_and_angles_are_in_units_of_the_scene(ball: Ball) -> None:
    ball["unit"] = "cm"
    ball["camera"].update(position=["0 mm", 0, "4 cm"], vertical_fov="0.6108652381980153 rad")
    ball["volume"] = [
        {"sphere": {"center": [0, 0, 0], "radius": "10 mm"}, "mu_t": "0.2 1/mm", "albedo": 0.8},
        {"box": {"min": ["-1e-2 m"] * 3, "max": ["1cm"] * 3}, "mu_a": ["100 /m", "1 cm^-1", "1/cm"], "mu_s": "3e2 m-1"},
        {
            "box": {"min": [0, 0, 0], "max": [1, 1, 1]},
            "mean_free_path": {"wavelengths": [450, 650], "values": ["1 mm", "2 mm"]},
            "albedo": 1,
        },
    ]
    scene = tyndall.Scene(ball)
    assert scene["camera.position"] == [0, 0, 4] and scene["camera.vertical_fov"] == pytest.approx(35)
    assert scene["volume.0.mu_t"] == pytest.approx(2) and scene["volume.0.sphere.radius"] == pytest.approx(1)
    assert scene["volume.1.box.min"] == [-1, -1, -1] and scene["volume.1.box.max"] == [1, 1, 1]
    assert scene["volume.1.mu_a"] == pytest.approx([1, 1, 1]) and scene["volume.1.mu_s"] == pytest.approx(3)
    assert scene["volume.2.mean_free_path.values"] == pytest.approx([0.1, 0.2])
    scene["volume.0.mu_t"] = "5 1/m"
    assert scene["volume.0.mu_t"] == pytest.approx(0.05)


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        ("camera.position", ["1/mm", 0, 0], 'camera.position.0: "1/mm" is not a length, such as "3 mm"'),
        ("camera.focus_distance", "3 deg", 'camera.focus_distance: "3 deg" is not a length'),
        ("volume.0.mu_t", "3 mm", 'volume.0.mu_t: "3 mm" is not a quantity per length, such as "0.3 1/mm"'),
        ("volume.0.mu_t", "3 1/mm2", 'volume.0.mu_t: "3 1/mm2" is not a quantity per length'),
        ("volume.0.mu_t", "thick", 'volume.0.mu_t: "thick" is no number with a unit; give a quantity per length'),
        ("volume.0.mu_t", "1 kg", '"1 kg": `kg` is no unit of length or angle; give a quantity per length'),
        ("volume.0.mu_t", "inf 1/m", "is no number"),
        ("volume.0.mu_t", "1e308 1/nm", "is too large a number"),
        ("volume.0.mu_t", "1 mm^99", "`mm^99` is no unit"),
        ("camera.vertical_fov", "3 m", 'camera.vertical_fov: "3 m" is not an angle, such as "30 deg"'),
        ("volume.0.albedo", "0.5 m", "`albedo` must be"),
    ],
)
def test_a_wrong_dimension_is_refused_by_its_key(ball: Ball, path: str, value: Any, message: str) -> None:
    scene = tyndall.Scene(ball)
    with pytest.raises(tyndall.Error) as error:
        scene[path] = value
    assert message in str(error.value) and "\n" not in str(error.value)


def test_lengths_of_volumes_are_those_of_the_scene_they_come_into(ball: Ball, blob: np.ndarray) -> None:
    hashes = set()
    for unit, spacing in [("mm", "0.5 mm"), ("mm", 0.5), ("m", "0.5 m"), ("m", 0.5)]:
        ball["volume"] = {"file": tyndall.Volume(blob, spacing=spacing), "mu_t": 1, "albedo": 1}
        hashes.add(tyndall.Scene({**ball, "unit": unit}).hash)
    assert len(hashes) == 1
    ball["volume"] = {"file": tyndall.Volume(blob, spacing="0.5 mm"), "mu_t": 1, "albedo": 1}
    scene = tyndall.Scene({**ball, "unit": "mm"})
    before = scene.hash
    scene["unit"] = "cm"
    assert scene.hash != before


def test_quantities_of_pint_are_taken(ball: Ball, blob: np.ndarray) -> None:
    units = pytest.importorskip("pint").UnitRegistry()
    ball["unit"] = "cm"
    ball["camera"]["position"] = units.Quantity(np.array([0, 0, 40.0]), "mm")
    ball["camera"]["vertical_fov"] = units.Quantity(np.pi / 6, "radian")
    ball["volume"][0]["mu_t"] = units.Quantity(0.2, "1/mm")
    ball["volume"][0]["albedo"] = units.Quantity(0.5, "dimensionless")
    scene = tyndall.Scene(ball)
    assert scene["camera.position"] == [0, 0, 4] and scene["camera.vertical_fov"] == pytest.approx(30)
    assert scene["volume.0.mu_t"] == pytest.approx(2) and scene["volume.0.albedo"] == 0.5
    with pytest.raises(tyndall.Error, match="volume.0.mu_t: 3 meter is not a quantity per length"):
        scene["volume.0.mu_t"] = units.Quantity(3, "m")
    with pytest.raises(tyndall.Error, match="volume.0.albedo: 3 meter is not a number without a unit"):
        scene["volume.0.albedo"] = units.Quantity(3, "m")
    volume = tyndall.Volume(blob, spacing=units.Quantity(2, "mm"))
    assert volume.index_to_world[0, 0] == pytest.approx(2e-3)
