"""Every distance sampler and transmittance estimator of the field, on arrays of rays.

Rays are `origins` and `directions`, arrays (..., 3) that broadcast; directions need not be of unit length, and distances
are along them in scene units. They go through the media of a scene, up to the first surface, or through a `Volume`, whose
values are then the extinction, per scene unit. Where extinction depends on colour, the mean of its channels counts.

>>> import numpy as np
>>> import tyndall
>>> cube = tyndall.Volume(np.full((16, 16, 16), 0.5), spacing=0.25)
>>> rays = dict(origins=[-10.0, 2.0, 2.0], directions=[1.0, 0.0, 0.0])
>>> truth = np.exp(-tyndall.estimators.optical_thickness(cube, **rays))
>>> found = tyndall.estimators.transmittance(cube, **rays, estimator="ratio-tracking", samples=1000, seed=1)
>>> bool(abs(found.mean - truth) < 5 * found.standard_error)
True
"""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from tyndall import _arrays, _tyndall
from tyndall._arrays import Floats
from tyndall._errors import Error
from tyndall._render import as_scene
from tyndall._tyndall import Scene, Volume

__all__ = [
    "Estimator",
    "Flights",
    "Transmittance",
    "names",
    "optical_thickness",
    "properties",
    "sample_distance",
    "transmittance",
]

Medium = Scene | Volume | Mapping[str, Any] | str | PathLike[str]
"""A volume, or what a scene is made of."""

_GREATEST_SEED = 2**64 - 1
# Flights are in memory at once.
_MOST_FLIGHTS = 1 << 28


class Estimator(NamedTuple):
    """What an estimator declares of itself."""

    name: str
    kind: str
    """`"distance"` or `"transmittance"`."""
    unbiased: bool
    """Whether its mean is the true value."""
    majorant: str
    """How it uses an upper bound of the extinction."""
    needs: tuple[str, ...]
    """What must be known beside the extinction at single places."""
    source: str
    """Where it is from."""


class Transmittance(NamedTuple):
    """Estimates of the transmittance, in the shape of the rays."""

    mean: Floats
    standard_error: Floats
    lookups: Floats
    """Mean number of lookups of the extinction for one sample: the cost."""


class Flights(NamedTuple):
    """Samples of distances: the mean of weight · f(distance) is ∫ μt T f dt, that of escape is T. Samples are the last axis."""

    distance: Floats
    """Distance of the collision; infinite without one."""
    weight: Floats
    """Weight of the collision; 1 or 0 of samplers that do as nature does."""
    escape: Floats
    """Weight of what arrives from beyond the ray's end."""
    lookups: Floats
    """Mean number of lookups of the extinction for one sample, in the shape of the rays."""


def names(kind: str = "transmittance") -> list[str]:
    """Names of the estimators of a kind, `"distance"` or `"transmittance"`.

    >>> names("transmittance")[:3]
    ['closed-form', 'regular-tracking', 'ray-marching']
    """
    return [estimator.name for estimator in properties(kind)]


def properties(kind: str | None = None) -> list[Estimator]:
    """What all estimators, or those of a kind, declare of themselves.

    >>> [estimator.name for estimator in properties() if not estimator.unbiased]
    ['ray-marching', 'ray-marching']
    """
    if kind is not None and (not isinstance(kind, str) or kind not in ("distance", "transmittance")):
        raise Error(f'kind: write "distance" or "transmittance", not {kind!r}')
    declared = (
        Estimator(name, of, unbiased, majorant, tuple(needs), source)
        for of, name, unbiased, majorant, needs, source in _tyndall.declared_estimators()
    )
    return [estimator for estimator in declared if kind in (None, estimator.kind)]


def transmittance(
    medium: Medium,
    origins: ArrayLike,
    directions: ArrayLike,
    *,
    distance: ArrayLike = np.inf,
    estimator: str = "ratio-tracking",
    samples: int = 1024,
    seed: int = 0,
    threads: int | None = None,
) -> Transmittance:
    """The transmittance along rays up to a `distance`, estimated `samples` times each by one of `names("transmittance")`.

    Ray number n has the random numbers of (seed, n), whatever the number of threads.
    """
    sampling = _sampling(estimator, samples, seed, least=2)
    shape, rays = _rays(origins, directions, distance, threads)
    found = _tyndall.estimate_transmittance(_scene_of(medium), rays, sampling)
    return Transmittance(*(column.reshape(shape)[()] for column in found))


def sample_distance(
    medium: Medium,
    origins: ArrayLike,
    directions: ArrayLike,
    *,
    distance: ArrayLike = np.inf,
    sampler: str = "delta-tracking",
    samples: int = 1,
    seed: int = 0,
    threads: int | None = None,
) -> Flights:
    """Distances of collisions along rays, sampled `samples` times each by one of `names("distance")`.

    >>> cube = Volume(np.ones((8, 8, 8)))
    >>> flights = sample_distance(cube, [[-1, 4, 4], [-1, 99, 4]], [1, 0, 0], samples=5)
    >>> flights.distance.shape, bool(np.all(flights.distance[1] == np.inf)), float(flights.escape[1].sum())
    ((2, 5), True, 5.0)
    """
    sampling = _sampling(sampler, samples, seed, least=1)
    samples = int(samples)
    shape, rays = _rays(origins, directions, distance, threads)
    if np.prod(shape, dtype=float) * samples > _MOST_FLIGHTS:
        raise Error(f"samples: {samples} of each ray are more than {_MOST_FLIGHTS} in all; take them in several calls")
    *columns, lookups = _tyndall.sample_distances(_scene_of(medium), rays, sampling)
    t, weight, escape = (column.reshape(*shape, samples) for column in columns)
    return Flights(t, weight, escape, lookups.reshape(shape)[()])


def optical_thickness(
    medium: Medium,
    origins: ArrayLike,
    directions: ArrayLike,
    *,
    distance: ArrayLike = np.inf,
    threads: int | None = None,
) -> Floats:
    """The optical thickness τ = ∫ μt dt along rays up to a `distance`, by formula or voxel by voxel: no estimate. exp(-τ) is
    the truth that estimators of transmittance aim at. Beyond τ = 800, where nothing gets through, media may be cut.

    >>> cube = Volume(np.ones((8, 8, 8)))
    >>> optical_thickness(cube, [-10, 3.5, 3.5], [1, 0, 0], distance=[0, 13.5, np.inf]).round(3)
    array([0., 4., 8.])
    """
    shape, rays = _rays(origins, directions, distance, threads)
    return _tyndall.optical_thickness(_scene_of(medium), rays).reshape(shape)[()]


def _sampling(name: str, samples: int, seed: int, least: int) -> dict[str, object]:
    return {
        "name": str(name),
        "samples": _arrays.whole("samples", samples, least, _MOST_FLIGHTS),
        "seed": _arrays.whole("seed", seed, 0, _GREATEST_SEED),
    }


def _rays(
    origins: ArrayLike, directions: ArrayLike, distance: ArrayLike, threads: int | None
) -> tuple[tuple[int, ...], dict[str, object]]:
    ends = _arrays.floats("distance", distance)
    if not np.all(ends >= 0):
        raise Error("distance: distances are 0 or more")
    start, toward, end = _arrays.broadcast_rows(
        origins=_arrays.vectors("origins", origins),
        directions=_arrays.directions("directions", directions),
        distance=ends[..., None],
    )
    return start.shape[:-1], {
        "origins": _arrays.rows(start),
        "directions": _arrays.rows(toward),
        "distances": np.ascontiguousarray(end).ravel(),
        "threads": None if threads is None else _arrays.whole("threads", threads, 1, 65535),
    }


def _scene_of(medium: Medium) -> Scene:
    if isinstance(medium, Volume):
        # Rays do not ask for the camera, which a scene has to have.
        camera = {"position": [0.0, 0.0, 1.0], "target": [0.0, 0.0, 0.0]}
        return Scene({"camera": camera, "volume": [{"file": medium, "mu_t": 1.0, "albedo": 0.0, "storage": "f32"}]})
    return as_scene(medium)
