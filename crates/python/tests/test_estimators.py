"""Estimators on arrays of rays: every one that claims no bias has the mean that quadrature has."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import tyndall
from tyndall import estimators

VALUES = np.random.default_rng(5).random((9, 8, 7)) ** 2
GRID = tyndall.Volume(VALUES, spacing=0.5)
# Thin, askew and thick ways through the grid.
RAYS: dict[str, Any] = {
    "origins": [[-5, 2, 2], [2, 9, 1.2], [-1, -1, -1]],
    "directions": [[1, 0, 0], [0.1, -1, 0.05], [1, 1, 0.9]],
    "distance": [6.0, np.inf, np.inf],
}
CAMERA = {"position": [0.0, 0.0, 9.0], "target": [0.0, 0.0, 0.0]}
# A closed form and a point light are there for those who need them.
BALL = tyndall.Scene(
    {
        "camera": CAMERA,
        "volume": [{"sphere": {"center": [0, 0, 0], "radius": 1}, "mu_t": 1.3, "albedo": 0.5}],
        "light": [{"type": "point", "position": [0, 2, 0], "intensity": 1}],
    }
)
BALL_RAYS: dict[str, Any] = {"origins": [[-3, 0.2, 0], [-3, 0, 0.9]], "directions": [1, 0, 0]}


def trilinear(place: np.ndarray) -> np.ndarray:
    """The field between voxel centres; none outside is active, and the field ends with the voxels' boxes."""
    index = place / 0.5
    padded = np.pad(VALUES, 1)
    low = np.clip(np.floor(index).astype(int), -1, np.array(VALUES.shape) - 1)
    part = index - low
    found = np.zeros(len(place))
    for corner in np.ndindex(2, 2, 2):
        weight = np.prod(np.where(corner, part, 1 - part), axis=1)
        found += weight * padded[tuple((low + corner + 1).T)]
    inside = np.all((index > -1) & (index < np.array(VALUES.shape)), axis=1)
    return np.where(inside, found, 0)


def test_the_optical_thickness_is_the_integral_of_the_field() -> None:
    exact = estimators.optical_thickness(GRID, **RAYS)
    for number, (origin, direction) in enumerate(zip(np.array(RAYS["origins"]), np.array(RAYS["directions"]))):
        direction = direction / np.linalg.norm(direction)
        steps = 200_000
        end = RAYS["distance"][number] if np.isfinite(RAYS["distance"][number]) else 20.0
        t = (np.arange(steps) + 0.5) / steps * end
        tau = trilinear(origin + t[:, None] * direction).mean() * end
        assert exact[number] == pytest.approx(tau, rel=1e-4)


@pytest.mark.parametrize("name", estimators.names("transmittance"))
def test_a_transmittance_estimator_has_the_mean_it_claims(name: str) -> None:
    [declared] = [each for each in estimators.properties("transmittance") if each.name == name]
    medium, rays = (BALL, BALL_RAYS) if "closed form" in declared.needs else (GRID, RAYS)
    truth = np.exp(-estimators.optical_thickness(medium, **rays))
    found = estimators.transmittance(medium, **rays, estimator=name, samples=4000, seed=11)
    z = (found.mean - truth) / np.hypot(found.standard_error, 1e-6)
    if declared.unbiased:
        assert np.abs(z).max() < 4.5, z
    assert np.all(np.abs(found.mean - truth) < 0.03) and np.all(found.lookups >= 0)


@pytest.mark.parametrize("name", estimators.names("distance"))
def test_a_distance_sampler_has_the_means_it_claims(name: str) -> None:
    [declared] = [each for each in estimators.properties("distance") if each.name == name]
    medium, rays = (BALL, BALL_RAYS) if {"closed form", "point light"} & set(declared.needs) else (GRID, RAYS)
    tau = estimators.optical_thickness(medium, **rays)
    flights = estimators.sample_distance(medium, **rays, sampler=name, samples=6000, seed=3)
    # Of f = 1 and f = [t < 3]: what collides in all, and before the distance 3.
    near = estimators.optical_thickness(medium, rays["origins"], rays["directions"], distance=3.0)
    checks = [
        (flights.weight, 1 - np.exp(-tau)),
        (flights.weight * (flights.distance < 3), 1 - np.exp(-np.minimum(near, tau))),
        (flights.escape, np.exp(-tau)),
    ]
    for values, truth in checks:
        error = np.hypot(values.std(axis=-1) / np.sqrt(values.shape[-1]), 1e-3 if not declared.unbiased else 1e-9)
        assert np.all(np.abs(values.mean(axis=-1) - truth) < 4.5 * error + (0 if declared.unbiased else 0.02)), name


def test_threads_change_nothing_and_each_ray_has_numbers_of_its_own() -> None:
    one, two = (estimators.transmittance(GRID, **RAYS, samples=500, seed=1, threads=threads) for threads in (1, 2))
    assert np.array_equal(one.mean, two.mean) and np.array_equal(one.lookups, two.lookups)
    same = estimators.transmittance(GRID, [[-5, 2, 2]] * 2, [1, 0, 0], samples=500)
    assert same.mean[0] != same.mean[1]
    flights = estimators.sample_distance(GRID, np.zeros((2, 3, 3)), [1, 1, 1], samples=4)
    assert flights.distance.shape == (2, 3, 4) and flights.lookups.shape == (2, 3)


def test_media_are_there_between_the_shapes_that_bound_them() -> None:
    scene = {
        "camera": CAMERA,
        "volume": [{"name": "milk", "mu_t": 2.0, "albedo": 0.9}],
        "shape": [
            {"box": {"min": [0, -1, -1], "max": [1.5, 1, 1]}, "material": {"type": "null"}, "interior": "milk"},
            {"sphere": {"center": [9, 0, 0], "radius": 1}, "material": {"type": "diffuse", "reflectance": 0.5}},
        ],
    }
    assert estimators.optical_thickness(scene, [-1, 0, 0], [1, 0, 0]) == pytest.approx(3)
    assert estimators.optical_thickness(scene, [0.5, 0, 0], [0, 1, 0]) == pytest.approx(2)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda: estimators.transmittance(GRID, **RAYS, estimator="ratio"),
            "estimator: there is no `ratio`; there are",
        ),
        (lambda: estimators.transmittance(GRID, **RAYS, estimator="closed-form"), "regular-tracking"),
        (lambda: estimators.transmittance(GRID, **RAYS, samples=1), "samples: a whole number from 2"),
        (lambda: estimators.sample_distance(GRID, **RAYS, sampler="equiangular"), "point light"),
        (lambda: estimators.sample_distance(GRID, **RAYS, samples=1 << 28), "more than 268435456 in all"),
        (lambda: estimators.optical_thickness(GRID, [0, 0], [1, 0]), "origins: the last axis must have 3"),
        (
            lambda: estimators.optical_thickness(GRID, [0, 0, np.inf], [1, 0, 0]),
            "origins: all components must be finite",
        ),
        (lambda: estimators.optical_thickness(GRID, [0, 0, 0], [0, 0, 0]), "directions: a direction has no length"),
        (lambda: estimators.optical_thickness(GRID, np.ones((2, 3)), np.ones((4, 3))), "the shapes do not broadcast"),
        (lambda: estimators.optical_thickness(GRID, [0, 0, 0], [1, 0, 0], distance=-1), "distance: distances are 0"),
        (lambda: estimators.names("time"), 'kind: write "distance" or "transmittance"'),
    ],
)
def test_mistakes_are_told_in_one_line(call: Callable[[], object], message: str) -> None:
    with pytest.raises(tyndall.Error) as caught:
        call()
    assert message in str(caught.value) and "\n" not in str(caught.value)
