"""Meters of scenes: with the command's figures, and arrays in the right order."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import tyndall
from tyndall import measure

SCENE = {
    "camera": {"position": [0.0, 0.0, 9.0], "target": [0.0, 0.0, 0.0]},
    "volume": [{"box": {"min": [0, 0, 0], "max": [1, 1, 2]}, "mu_t": 3, "albedo": 0.8}],
    "light": [{"type": "constant", "radiance": [1, 2, 3]}],
    "meter": [
        {
            "type": "layer",
            "name": "field",
            "bottom": 0,
            "top": 1,
            "direction": [0, -1, 0],
            "periodic": [0, 0, 2, 3],
            "columns": [2, 3],
            "radiance": [[0, 0], [150, 30]],
        },
        {"type": "body", "direction": [0, -1, 0], "bins": 4},
        {"type": "irradiance", "name": "below", "position": [0.5, -0.1, 0.5], "normal": [0, 1, 0]},
    ],
}


def test_meters_answer_as_the_command(answer: Callable[..., str], tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(tyndall.Scene(SCENE).to_toml())
    told = json.loads(answer("measure", str(path), "--samples", "3000", "--seed", "2", "--json"))["meters"]
    found = measure.meters(SCENE, samples=3000, seed=2)
    assert sorted(found) == sorted(told) == ["below", "field", "meter.1"]
    for key in ("reflectance", "transmittance", "unscattered", "absorptance"):
        assert found["field"][key] == tuple(told["field"][key].values())
    assert np.array_equal(found["meter.1"]["bins"].mean, told["meter.1"]["bins"]["mean"])
    assert np.array_equal(found["below"]["irradiance"].standard_error, told["below"]["irradiance"]["standard_error"])
    view = found["field"]["radiance"][1]
    assert (view["theta"], view["phi"], view["radiance"].mean) == (150, 30, told["field"]["radiance"][1]["mean"])
    columns = found["field"]["columns"]["transmittance"].mean
    # The box takes one column in x and two of three in z.
    assert columns.shape == (3, 2) and view["columns"].mean.shape == (3, 2)
    assert np.all(columns[:2, 0] < columns[2, 1])
    assert columns.ravel().tolist() == told["field"]["columns"]["transmittance"]["mean"]


def test_fluxes_of_a_layer_need_no_meter_in_the_scene_and_leave_it_alone() -> None:
    scene = tyndall.Scene({key: SCENE[key] for key in ("camera", "volume", "light")})
    found = measure.flux(scene, bottom=0, top=1, periodic=[0, 0, 1, 2], samples=4000)
    slab = measure.slab(3, 0.8, samples=4000)
    for key in ("reflectance", "transmittance"):
        one, other = found[key], getattr(slab, key)
        assert abs(one.mean - other.mean) < 4.5 * np.hypot(one.standard_error, other.standard_error)
    assert "meter" not in scene


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: measure.meters({**SCENE, "meter": []}), "has no meters; add a"),
        (lambda: measure.flux(SCENE, bottom=0, top=1), "give the meter a `periodic` tile"),
        (lambda: measure.flux(SCENE, bottom=1, top=0), "top"),
        (lambda: measure.flux(SCENE, bottom=0, top=1, periodc=[0, 0, 1, 1]), "periodc"),
        (lambda: measure.meters(SCENE, error="1 %%"), "error: "),
    ],
)
def test_scenes_that_a_meter_does_not_fit_are_refused_in_one_line(call: Callable[[], object], message: str) -> None:
    with pytest.raises(tyndall.Error) as caught:
        call()
    assert message in str(caught.value) and "\n" not in str(caught.value)
