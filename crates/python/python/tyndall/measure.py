"""Fluxes with their standard errors: of plane-parallel layers, and of what the meters of a scene see.

>>> import tyndall
>>> layer = tyndall.measure.slab(tau=2, albedo=0.9, g=0.75, samples=20_000)
>>> bool(abs(layer.reflectance.mean - 0.0974) < 5 * layer.reflectance.standard_error)
True
"""

from __future__ import annotations

import math
import time
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from tyndall import _arrays, _tyndall
from tyndall._arrays import Floats
from tyndall._errors import Error
from tyndall.phase import PhaseFunction

__all__ = ["Estimate", "Slab", "slab"]

_GREATEST_SEED = 2**32 - 1


class Estimate(NamedTuple):
    """Means with their standard errors: twice as much either way holds the true value in 95 of 100 cases."""

    mean: Floats
    standard_error: Floats


class Slab(NamedTuple):
    """What a layer does, as fractions of the incident flux, in the common shape of the arguments."""

    reflectance: Estimate
    """What comes back, with what the upper face reflects."""
    transmittance: Estimate
    """What gets through, the unscattered light included."""
    unscattered: Estimate
    """What gets through unscattered."""
    absorptance: Estimate
    """What the layer absorbs."""
    reflected_radiance: Estimate | None
    """Radiance, 1/sr, at the cosines `radiance` above the layer, per irradiance across the light; the last axis is theirs."""
    transmitted_radiance: Estimate | None
    """The same below the layer."""
    samples: Floats
    """Number of photons."""
    seconds: float
    """Time it took, in all."""


def slab(
    tau: ArrayLike,
    albedo: ArrayLike,
    g: ArrayLike = 0.0,
    *,
    phase: str | PhaseFunction | None = None,
    incidence: str | ArrayLike = "normal",
    n: ArrayLike = 1.0,
    ground_albedo: ArrayLike = 0.0,
    radiance: ArrayLike = (),
    azimuth: float = 0.0,
    samples: int | None = None,
    error: float | None = None,
    time_limit: float | None = None,
    seed: int = 0,
    threads: int | None = None,
) -> Slab:
    """Homogeneous plane-parallel layers under light from above, as `tyndall slab` answers.

    Arguments are numbers or arrays, which broadcast; each layer has random numbers of its own. `tau` is the optical
    thickness (`inf` for a half-space), `albedo` the single-scattering albedo, `g` the mean cosine of Henyey and
    Greenstein's phase function, or `phase` another one (see `tyndall.phase`), `n` the refractive index of the layer,
    whose faces to air then reflect, `ground_albedo` that of Lambertian ground below. Light comes along the normal, as
    `incidence` says in degrees off it, or `"diffuse"` from the whole hemisphere. At the cosines `radiance` radiance is
    estimated as well, `azimuth` degrees from the way a slanted beam travels.

    Each layer takes `samples` photons, or as many as bring the relative standard errors of reflectance and transmittance
    below `error`, or as many as `time_limit` seconds allow; a million unless given.

    >>> layers = slab(tau=[0.5, 1, 2], albedo=[[0.9], [1.0]], g=0.75, samples=2000)
    >>> layers.reflectance.mean.shape
    (2, 3)
    >>> layers.unscattered.mean[0].round(4)
    array([0.6065, 0.3679, 0.1353])
    """
    if phase is not None and not (np.ndim(g) == 0 and g == 0):
        raise Error("slab: give `g` or `phase`, not both")
    effort = effort_of(samples, error, time_limit, seed, threads)
    degrees = _degrees(incidence)
    arrays = _arrays.broadcast(tau=tau, albedo=albedo, g=g, n=n, ground_albedo=ground_albedo, incidence=degrees)
    views = _arrays.floats("radiance", radiance).ravel()
    function = PhaseFunction(phase) if isinstance(phase, str) else phase
    start = time.perf_counter()
    found = []
    for stream, (one_tau, one_albedo, one_g, one_n, one_ground, one_degrees) in enumerate(
        zip(*(array.ravel().tolist() for array in arrays))
    ):
        layer = {
            "tau": one_tau,
            "albedo": one_albedo,
            "phase": one_g if function is None else function,
            # Of all angles diffuse light has none.
            "incidence": None if math.isnan(one_degrees) else one_degrees,
            "n": one_n,
            "ground_albedo": one_ground,
            "radiance": views.tolist(),
            "azimuth": float(azimuth),
        }
        found.append(_tyndall.slab(layer, effort, stream))
    return _gathered(found, arrays[0].shape, len(views), time.perf_counter() - start)


def effort_of(
    samples: int | None, error: float | None, time_limit: float | None, seed: int, threads: int | None
) -> dict[str, object]:
    """How much work, as the compiled part takes it."""
    for name, value in (("error", error), ("time_limit", time_limit)):
        if value is not None and not (isinstance(value, (int, float)) and value > 0):
            raise Error(f"{name}: a number above 0 is needed, not {value!r}")
    return {
        "samples": None if samples is None else _arrays.whole("samples", samples, 1, 1 << 31),
        "error": error,
        "seconds": time_limit,
        "seed": _arrays.whole("seed", seed, 0, _GREATEST_SEED),
        "threads": None if threads is None else _arrays.whole("threads", threads, 1, 65535),
    }


def _degrees(incidence: str | ArrayLike) -> ArrayLike:
    """Angles of incidence; NaN stands for diffuse light."""
    if isinstance(incidence, str):
        named = {"normal": 0.0, "diffuse": math.nan}
        if incidence not in named:
            raise Error(
                f'incidence: write "normal", "diffuse", or degrees off the normal from 0 to 89.9, not "{incidence}"'
            )
        return named[incidence]
    degrees = _arrays.floats("incidence", incidence)
    if np.isnan(degrees).any():
        raise Error("incidence: write degrees off the normal from 0 to 89.9, not nan")
    return degrees


def _gathered(found: list[_tyndall.SlabFluxes], shape: tuple[int, ...], views: int, seconds: float) -> Slab:
    totals = np.array([fluxes[0] for fluxes in found]).reshape(*shape, 4, 2)
    estimates = [Estimate(totals[..., number, 0][()], totals[..., number, 1][()]) for number in range(4)]
    above = below = None
    if views:
        # A layer without a bottom has no radiance there.
        padded = [fluxes[1] + [(math.nan, math.nan)] * (2 * views - len(fluxes[1])) for fluxes in found]
        radiance = np.array(padded).reshape(*shape, 2, views, 2)
        above = Estimate(radiance[..., 0, :, 0], radiance[..., 0, :, 1])
        below = Estimate(radiance[..., 1, :, 0], radiance[..., 1, :, 1])
    photons = np.array([fluxes[2] for fluxes in found]).reshape(shape)[()]
    return Slab(*estimates, above, below, photons, seconds)
