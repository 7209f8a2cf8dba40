"""Layers: against published tables, and as the command answers."""

from __future__ import annotations

import json
import math
import os
import signal
import threading
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import tyndall
from tyndall import measure

TABLE = Path(__file__).parents[2] / "transport" / "tests" / "truth" / "slab_matched.json"


def test_layers_reflect_and_transmit_as_the_tables_say() -> None:
    rows = np.array(json.loads(TABLE.read_text())["rows"])[::12]
    albedo, tau, g = rows[:, 0], rows[:, 1], rows[:, 2]
    incidence = np.array([0.0, 60.0])[:, None]
    slab = measure.slab(tau, albedo, g, incidence=incidence, samples=4000, seed=2)
    diffuse = measure.slab(tau, albedo, g, incidence="diffuse", samples=4000, seed=2)
    for number, layer in enumerate([slab, diffuse]):
        columns = rows[:, [7, 8]].T if number else rows[:, [3, 4, 5, 6]].T.reshape(2, 2, -1).swapaxes(0, 1)
        for estimate, truth in zip([layer.reflectance, layer.transmittance], columns):
            z = (estimate.mean - truth) / np.hypot(estimate.standard_error, 1e-6)
            # Some 120 values: one beyond 4.5 in 1,200 such tests.
            assert np.abs(z).max() < 4.5 and 0.5 < np.std(z) < 1.5, z


def test_each_layer_has_random_numbers_of_its_own_and_the_first_those_of_the_command(
    answer: Callable[..., str],
) -> None:
    slab = measure.slab([2.0, 2.0], 0.9, 0.75, samples=5000, seed=4, radiance=[1.0, 0.5])
    assert slab.reflectance.mean[0] != slab.reflectance.mean[1]
    line = "slab --tau 2 --albedo 0.9 --g 0.75 --samples 5000 --seed 4 --radiance 1,0.5 --json"
    told = json.loads(answer(*line.split()))
    for name in ("reflectance", "transmittance", "unscattered", "absorptance"):
        estimate = getattr(slab, name)
        assert estimate.mean[0] == told[name]["mean"]
        assert estimate.standard_error[0] == told[name]["standard_error"]
    assert slab.reflected_radiance is not None and slab.transmitted_radiance is not None
    assert slab.reflected_radiance.mean[0, 1] == told["radiance"][1]["reflected"]["mean"]
    assert slab.transmitted_radiance.standard_error[0, 0] == told["radiance"][0]["transmitted"]["standard_error"]


def test_threads_change_nothing_and_seeds_do() -> None:
    one, two = (measure.slab(1, 1, samples=3000, threads=threads) for threads in (1, 2))
    assert one.reflectance == two.reflectance
    assert measure.slab(1, 1, samples=3000, seed=1).reflectance != one.reflectance


def test_ctrl_c_ends_a_long_measurement() -> None:
    interrupt = threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT))
    interrupt.start()
    with pytest.raises(KeyboardInterrupt):
        measure.slab(50, 1, samples=1 << 31)
    interrupt.join()


def test_half_spaces_have_no_bottom_and_what_is_conserved_adds_up() -> None:
    slab = measure.slab([1.0, math.inf], 0.8, phase="rayleigh", samples=3000, radiance=0.5, n=1)
    assert slab.transmittance.mean[1] == 0 and slab.reflected_radiance is not None
    assert slab.reflected_radiance.mean.shape == (2, 1)
    assert slab.transmitted_radiance is not None and np.isnan(slab.transmitted_radiance.mean[1, 0])
    total = slab.reflectance.mean + slab.transmittance.mean + slab.absorptance.mean
    assert np.allclose(total, 1, atol=0.03)
    assert measure.slab(1, 1, error=0.05).samples < 50_000
    assert measure.slab(np.empty(0), 1).reflectance.mean.shape == (0,)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"tau": -1, "albedo": 1}, "tau: write a number from 0 to 1e6, or inf, not -1"),
        ({"tau": math.nan, "albedo": 1}, "tau: write"),
        ({"tau": 1, "albedo": [0.5, 1.5]}, "albedo: write a number from 0 to 1, not 1.5"),
        ({"tau": 1, "albedo": 1, "g": 1}, "g: write a number between -1 and 1"),
        ({"tau": 1, "albedo": 1, "g": 0.5, "phase": "rayleigh"}, "give `g` or `phase`"),
        ({"tau": 1, "albedo": 1, "phase": "raleigh"}, "raleigh"),
        ({"tau": 1, "albedo": 1, "n": 0.5}, "n: write a number from 1 to 10"),
        ({"tau": 1, "albedo": 1, "incidence": 90}, "incidence: write normal, diffuse, or degrees"),
        ({"tau": 1, "albedo": 1, "incidence": "slanted"}, "incidence: write"),
        ({"tau": math.inf, "albedo": 0.5, "ground_albedo": 0.5}, "ground_albedo: there is no ground"),
        ({"tau": 1, "albedo": 1, "n": 1.3, "radiance": 1}, "radiance: is not known behind reflecting faces"),
        ({"tau": 1, "albedo": 1, "radiance": [0]}, "radiance: write cosines"),
        ({"tau": [1, 2], "albedo": [1, 1, 1]}, "do not broadcast: tau (2,), albedo (3,)"),
        ({"tau": "thick", "albedo": 1}, "tau: numbers are needed, not 'thick'"),
        ({"tau": 1, "albedo": 1, "samples": 0}, "samples: a whole number from 1 to 2147483648"),
        ({"tau": 1, "albedo": 1, "samples": 1.5}, "samples: a whole number"),
        ({"tau": 1, "albedo": 1, "error": 0}, "error: a number above 0"),
        ({"tau": 1, "albedo": 1, "seed": -1}, "seed: a whole number"),
        ({"tau": 1, "albedo": 1, "threads": 0}, "threads: a whole number"),
    ],
)
def test_impossible_layers_are_refused_in_one_line(arguments: dict[str, object], message: str) -> None:
    with pytest.raises(tyndall.Error) as caught:
        measure.slab(**arguments)  # type: ignore[arg-type]
    assert message in str(caught.value) and "\n" not in str(caught.value)
