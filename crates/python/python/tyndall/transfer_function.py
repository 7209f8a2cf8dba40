"""Transfer functions: what a medium does to light, by the values of a scalar field.

>>> import numpy as np
>>> from tyndall import TransferFunction
>>> tissue = TransferFunction([0, 100, 300], extinction=[0, 0.1, 5], albedo=[[0.9, 0.5, 0.4], [0.9, 0.5, 0.4], [1, 1, 0.9]])
>>> tissue.extinction([-50, 50, 200]).round(3)
array([0.  , 0.05, 2.55])
>>> tissue.albedo([50, 300])
array([[0.9, 0.5, 0.4],
       [1. , 1. , 0.9]])
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tyndall import _arrays, _tyndall
from tyndall._arrays import Floats
from tyndall._errors import Error

__all__ = ["TransferFunction"]

# Colours of a colour map.
_STEPS = 256
# Values that are classified at a time, to bound memory.
_BLOCK = 1 << 20

Colours = str | Callable[[Floats], Any] | ArrayLike
"""A number, one for each point, red, green and blue for each point, or a colour map."""


class TransferFunction:
    """Extinction, albedo and emission, linear between points; beyond the first and last point they stay as there.

    `values` are the points, increasing; `extinction` is given for each of them, per scene unit. `albedo` is the fraction of
    the light that is scattered and not absorbed, `emission` the radiance that the medium adds per scene unit; each is a
    number, a number or red, green and blue for each point, or a colour map: its name in matplotlib, anything that makes
    colours of numbers from 0 to 1, spread from the first point to the last. Instead of the albedo a `reflectance` may be
    given, that of a thick layer; it is how white or coloured the medium looks. Colours are linear, but those of colour maps
    are sRGB, as on screens. `g` is the mean cosine of the phase function (Henyey and Greenstein's); above 0 is forward.
    """

    def __init__(
        self,
        values: ArrayLike,
        *,
        extinction: ArrayLike,
        albedo: Colours | None = None,
        reflectance: Colours | None = None,
        emission: Colours = 0.0,
        emission_scale: float = 1.0,
        g: float = 0.0,
    ) -> None:
        points = _arrays.floats("values", values)
        if points.ndim != 1 or points.size == 0 or not np.all(np.isfinite(points)) or np.any(np.diff(points) <= 0):
            raise Error("values: a list of increasing numbers is needed, one for each point")
        self.values = points
        self.g = _arrays.number("g", g)
        if not -1 < self.g < 1:
            raise Error(f"g: a number between -1 and 1, both excluded, is needed, not {g!r}")
        self._extinction = _row("extinction", extinction, points)
        if not np.all((self._extinction >= 0) & np.isfinite(self._extinction)):
            raise Error("extinction: numbers of 0 or more are needed")
        if albedo is not None and reflectance is not None:
            raise Error("albedo: give `albedo` or `reflectance`, not both")
        if reflectance is not None:
            self._albedo = _coloured("reflectance", reflectance, points)
            if np.any(self._albedo[1] > 1):
                raise Error("reflectance: numbers from 0 to 1 are needed")
            colours = _tyndall.albedo_of_reflectance(self._albedo[1].ravel(), self.g)
            self._albedo = (self._albedo[0], colours.reshape(-1, 3))
        else:
            self._albedo = _coloured("albedo", 0.9 if albedo is None else albedo, points)
            if np.any(self._albedo[1] > 1):
                raise Error("albedo: numbers from 0 to 1 are needed")
        if _arrays.number("emission_scale", emission_scale) < 0:
            raise Error(f"emission_scale: a number of 0 or more is needed, not {emission_scale!r}")
        at, radiance = _coloured("emission", emission, points)
        self._emission = (at, radiance * emission_scale)

    def extinction(self, values: ArrayLike) -> Floats:
        """Extinction, per scene unit; 0 where a value is not a number."""
        return _interpolated(values, self.values, self._extinction[:, None])[..., 0]

    def albedo(self, values: ArrayLike) -> Floats:
        """Albedo of red, green and blue, the last axis."""
        return _interpolated(values, *self._albedo)

    def emission(self, values: ArrayLike) -> Floats:
        """Radiance of red, green and blue, the last axis, that is added per scene unit; 0 where a value is not a number."""
        return _interpolated(values, *self._emission)

    def medium(self, array: NDArray[Any]) -> tuple[NDArray[np.float32], dict[str, Any], list[Glow]]:
        """What stands for a classified array in a scene: densities from 0 to 1, the medium's keys, and what glows.

        Keys that are arrays, `albedo_grid`, are by voxel. Values are classified first; what lies between the centres of
        voxels is interpolated from their coefficients.
        """
        densest = float(self._extinction.max())
        density = _by_voxel(array, self.values, self._extinction[:, None] / (densest or 1.0))[..., 0]
        keys: dict[str, Any] = {"mu_t": densest, "phase": {"type": "hg", "g": self.g}}
        at, colours = self._albedo
        if np.all(colours == colours[0]):
            keys["albedo"] = colours[0].tolist()
        else:
            keys["albedo"] = 1.0
            keys["albedo_grid"] = _by_voxel(array, at, colours)
        return density, keys, self._glows(array)

    def _glows(self, array: NDArray[Any]) -> list[Glow]:
        at, radiance = self._emission
        if not np.any(radiance):
            return []
        brightest = radiance[np.argmax(radiance.sum(axis=1))]
        strength = radiance @ brightest / (brightest @ brightest)
        if np.allclose(strength[:, None] * brightest, radiance, rtol=1e-6, atol=1e-6 * brightest.max()):
            return [(_by_voxel(array, at, strength[:, None])[..., 0], brightest.tolist())]
        glows = []
        for channel in range(3):
            greatest = float(radiance[:, channel].max())
            if greatest > 0:
                strengths = _by_voxel(array, at, radiance[:, channel : channel + 1] / greatest)[..., 0]
                glows.append((strengths, [greatest * (channel == other) for other in range(3)]))
        return glows


Glow = tuple[NDArray[np.float32], list[float]]
"""Strengths by voxel, and the radiance per scene unit where the strength is 1."""


def _row(name: str, given: ArrayLike, points: Floats) -> Floats:
    row = _arrays.floats(name, given)
    if row.shape not in ((), points.shape):
        raise Error(f"{name}: a number for each of the {points.size} points is needed; the shape is {row.shape}")
    return np.array(np.broadcast_to(row, points.shape))


def _coloured(name: str, given: Colours, points: Floats) -> tuple[Floats, Floats]:
    """Points, and red, green and blue at each."""
    if isinstance(given, str) or callable(given):
        return np.linspace(points[0], points[-1], _STEPS), _colour_map(name, given)
    colours = _arrays.floats(name, given)
    if colours.ndim == 1 and colours.shape == points.shape:
        colours = colours[:, None]
    if colours.ndim != 0 and not (colours.ndim == 2 and colours.shape[0] == points.size and colours.shape[1] in (1, 3)):
        raise Error(
            f"{name}: a number, a number or three for each of the {points.size} points, or the name of a colour map is "
            f"needed; the shape is {colours.shape}"
        )
    if not np.all((colours >= 0) & np.isfinite(colours)):
        raise Error(f"{name}: numbers of 0 or more are needed")
    return points, np.array(np.broadcast_to(colours, (points.size, 3)))


def _colour_map(name: str, given: str | Callable[[Floats], Any]) -> Floats:
    """Linear colours, as many as there are steps."""
    colour_map: Any = given
    if isinstance(given, str):
        try:
            import matplotlib
        except ImportError:
            raise Error(f'{name}: "{given}" is a colour map of matplotlib, which is not installed') from None
        try:
            colour_map = matplotlib.colormaps[given]
        except KeyError:
            raise Error(f'{name}: matplotlib has no colour map "{given}"') from None
    colours = np.asarray(colour_map(np.linspace(0, 1, _STEPS)), dtype=float)
    if colours.ndim != 2 or colours.shape[0] != _STEPS or colours.shape[1] not in (3, 4):
        raise Error(f"{name}: the colour map must make (N, 3) or (N, 4) colours of N numbers")
    encoded = np.clip(colours[:, :3], 0, 1)
    # IEC 61966-2-1.
    linear: Floats = np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)
    return linear


def _interpolated(values: ArrayLike, at: Floats, rows: Floats) -> Floats:
    given = _arrays.floats("values", values)
    columns = [np.interp(given, at, rows[:, column]) for column in range(rows.shape[1])]
    return np.where(np.isnan(given)[..., None], 0.0, np.stack(columns, axis=-1))


def _by_voxel(array: NDArray[Any], at: Floats, rows: Floats) -> NDArray[np.float32]:
    flat = array.reshape(-1)
    found = np.empty((flat.size, rows.shape[1]), np.float32)
    for start in range(0, flat.size, _BLOCK):
        found[start : start + _BLOCK] = _interpolated(flat[start : start + _BLOCK], at, rows)
    return found.reshape(*array.shape, rows.shape[1])
