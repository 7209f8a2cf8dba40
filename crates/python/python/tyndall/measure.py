"""Fluxes with their standard errors: of plane-parallel layers, and of what the meters of a scene see.

>>> import tyndall
>>> layer = tyndall.measure.slab(tau=2, albedo=0.9, g=0.75, samples=20_000)
>>> bool(abs(layer.reflectance.mean - 0.0974) < 5 * layer.reflectance.standard_error)
True
"""

from __future__ import annotations

import json
import math
import warnings
from collections.abc import Mapping
from os import PathLike
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from tyndall import _arrays, _tyndall
from tyndall._arrays import Floats
from tyndall._errors import Error
from tyndall._render import _share, as_scene
from tyndall._tyndall import Scene
from tyndall.phase import PhaseFunction, phase_function_of

__all__ = ["Estimate", "Slab", "flux", "meters", "slab"]

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
    error: float | str | None = None,
    time: float | None = None,
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
    below `error` (such as `0.01` or `"1%"`), or as many as `time` seconds allow; a million unless given.

    >>> layers = slab(tau=[0.5, 1, 2], albedo=[[0.9], [1.0]], g=0.75, samples=2000)
    >>> layers.reflectance.mean.shape
    (2, 3)
    >>> layers.unscattered.mean[0].round(4)
    array([0.6065, 0.3679, 0.1353])
    """
    if phase is not None and not (np.ndim(g) == 0 and g == 0):
        raise Error("slab: give `g` or `phase`, not both")
    effort = effort_of(samples, error, time, seed, threads)
    degrees = _degrees(incidence)
    arrays = _arrays.broadcast(tau=tau, albedo=albedo, g=g, n=n, ground_albedo=ground_albedo, incidence=degrees)
    views = _arrays.floats("radiance", radiance).ravel()
    function = None if phase is None else phase_function_of(phase)
    start = perf_counter()
    layers = []
    for one_tau, one_albedo, one_g, one_n, one_ground, one_degrees in zip(
        *(array.ravel().tolist() for array in arrays)
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
            "azimuth": _arrays.number("azimuth", azimuth),
        }
        layers.append(layer)
    found = _tyndall.slabs(layers, effort)
    return _gathered(found, arrays[0].shape, len(views), perf_counter() - start)


def meters(
    scene: Scene | Mapping[str, Any] | str | PathLike[str],
    *,
    samples: int | None = None,
    error: float | str | None = None,
    time: float | None = None,
    seed: int = 0,
    threads: int | None = None,
) -> dict[str, dict[str, Any]]:
    """What the `[[meter]]` tables of a scene measure, by their names, with the keys of `tyndall measure --json`.

    Values with a standard error are `Estimate`s: of numbers, or of arrays where there are several (red, green and blue;
    columns, of shape (z, x); bins of a body). Views are dictionaries of theta, phi and radiance. Each meter takes as much work as `slab` gives a layer.

    >>> fog = {
    ...     "camera": {"position": [0, 0, 5], "target": [0, 0, 0]},
    ...     "volume": [{"slab": {"bottom": 0, "top": 1}, "mu_t": 2, "albedo": 0.9}],
    ...     "meter": [{"type": "layer", "name": "fog", "bottom": 0, "top": 1, "direction": [0, -1, 0]}],
    ... }
    >>> found = meters(fog, samples=2000)["fog"]
    >>> sorted(found), float(found["unscattered"].mean.round(2))
    (['absorptance', 'reflectance', 'samples', 'seconds', 'transmittance', 'unscattered'], 0.14)
    """
    effort = effort_of(samples, error, time, seed, threads)
    answer = json.loads(_tyndall.meters(as_scene(scene), effort))["meters"]
    for name, reading in answer.items():
        for warning in reading.get("warnings", []):
            warnings.warn(f"{name}: {warning}", stacklevel=2)
    return {name: _reading(reading) for name, reading in answer.items()}


def flux(
    scene: Scene | Mapping[str, Any] | str | PathLike[str],
    *,
    bottom: float,
    top: float,
    direction: ArrayLike | None = (0.0, -1.0, 0.0),
    samples: int | None = None,
    error: float | str | None = None,
    time: float | None = None,
    seed: int = 0,
    threads: int | None = None,
    **keys: Any,
) -> dict[str, Any]:
    """The fluxes of the layer between the heights `bottom` and `top` of a scene, as a meter of type "layer" measures them.

    Light travels along `direction`, or comes from the whole hemisphere if that is None. Other keys are those of the meter:
    `periodic=[x0, z0, x1, z1]`, `columns=[nx, nz]`, `ground_albedo`, `radiance=[[theta, phi], …]`, `channel`.

    >>> camera = {"position": [0, 0, 5], "target": [0, 0, 0]}
    >>> volume = {"slab": {"bottom": 0, "top": 1}, "mu_t": 2, "albedo": 1}
    >>> fluxes = flux({"camera": camera, "volume": [volume]}, bottom=0, top=1, samples=2000)
    >>> round(float(fluxes["reflectance"].mean + fluxes["transmittance"].mean), 6)
    1.0
    """
    meter = {"type": "layer", "name": "flux", "bottom": bottom, "top": top, **keys}
    if direction is not None:
        meter["direction"] = _arrays.directions("direction", direction).tolist()
    measured = as_scene(scene).copy()
    measured["meter"] = [meter]
    return meters(measured, samples=samples, error=error, time=time, seed=seed, threads=threads)["flux"]


def _reading(answer: dict[str, Any]) -> dict[str, Any]:
    """A meter's answer with estimates for means and standard errors, and arrays for lists."""
    shape = answer.get("columns", {}).get("shape")
    # Of columns x changes fastest.
    by_column = None if shape is None else (shape[1], shape[0])
    reading: dict[str, Any] = {}
    for key, value in answer.items():
        if key == "columns":
            reading[key] = {name: _estimate(each, by_column) for name, each in value.items() if name != "shape"}
        elif key == "radiance" and isinstance(value, list):
            reading[key] = [_view(view, by_column) for view in value]
        else:
            reading[key] = _estimate(value) if isinstance(value, dict) else value
    return reading


def _view(answer: dict[str, Any], by_column: tuple[int, int] | None) -> dict[str, Any]:
    view = {"theta": answer["theta"], "phi": answer["phi"], "radiance": _estimate(answer)}
    if "columns" in answer:
        view["columns"] = _estimate(answer["columns"], by_column)
    return view


def _estimate(answer: dict[str, Any], shape: tuple[int, ...] | None = None) -> Estimate:
    mean, error = (np.array(answer[part], dtype=float) for part in ("mean", "standard_error"))
    # JSON has no infinity, which the error is as long as nothing is known of it.
    error[np.isnan(error)] = np.inf
    shape = mean.shape if shape is None else shape
    return Estimate(mean.reshape(shape)[()], error.reshape(shape)[()])


def effort_of(
    samples: int | None, error: float | str | None, time: float | None, seed: int, threads: int | None
) -> dict[str, object]:
    """How much work, as the compiled part takes it."""
    error = _share(error)
    for name, value in (("error", error), ("time", time)):
        if value is not None and not (isinstance(value, (int, float)) and value > 0):
            raise Error(f"{name}: a number above 0 is needed, not {value!r}")
    return {
        "samples": None if samples is None else _arrays.whole("samples", samples, 1, 1 << 31),
        "error": error,
        "seconds": time,
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
    each = (Estimate(totals[..., number, 0][()], totals[..., number, 1][()]) for number in range(4))
    reflectance, transmittance, unscattered, absorptance = each
    above = below = None
    if views:
        # A layer without a bottom has no radiance there.
        padded = [fluxes[1] + [(math.nan, math.nan)] * (2 * views - len(fluxes[1])) for fluxes in found]
        radiance = np.array(padded).reshape(*shape, 2, views, 2)
        above = Estimate(radiance[..., 0, :, 0], radiance[..., 0, :, 1])
        below = Estimate(radiance[..., 1, :, 0], radiance[..., 1, :, 1])
    photons = np.array([fluxes[2] for fluxes in found]).reshape(shape)[()]
    return Slab(reflectance, transmittance, unscattered, absorptance, above, below, photons, seconds)
