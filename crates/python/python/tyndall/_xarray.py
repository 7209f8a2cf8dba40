"""Volumes from xarray, and pictures to it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from tyndall._errors import Error
from tyndall._tyndall import Render

if TYPE_CHECKING:
    import xarray

AXES = ("x", "y", "z")
METRES = {
    "m": 1.0,
    "metre": 1.0,
    "metres": 1.0,
    "meter": 1.0,
    "meters": 1.0,
    "km": 1e3,
    "cm": 1e-2,
    "mm": 1e-3,
    "um": 1e-6,
    "µm": 1e-6,
    "nm": 1e-9,
}
"""Names of units that coordinates have in their attribute `units`."""


def volume_arguments(
    data: xarray.DataArray, with_place: bool
) -> tuple[np.ndarray[Any, Any], tuple[list[float], list[float], bool] | None]:
    """An array whose axes are x, y, z; and, if asked for, spacing, origin, and whether they are in metres.

    Nothing is copied: the axes of a view are put in order.
    """
    dims = [str(dim) for dim in data.dims]
    if not set(AXES) <= set(dims) or len(dims) > 4:
        raise Error(f"a volume has the dimensions x, y and z, not {', '.join(dims)}; rename them with .rename")
    rest = [dim for dim in dims if dim not in AXES]
    ordered = data.transpose(*AXES, *rest)
    if not with_place:
        return ordered.values, None
    spacing, origin, units = [], [], set()
    flips = []
    for axis in AXES:
        step, first, flip = _steps(ordered, axis)
        spacing.append(step)
        origin.append(first)
        flips.append(slice(None, None, -1) if flip else slice(None))
        units.add(str(ordered.coords[axis].attrs.get("units", "")))
    if len(units) > 1:
        raise Error(f"the coordinates are in different units ({', '.join(sorted(units))}); give all in one")
    (unit,) = units
    if unit and unit not in METRES:
        raise Error(f"the coordinates are in `{unit}`, which is no length; give spacing and origin as well")
    metres = METRES.get(unit, 1.0)
    values = ordered.values[tuple(flips)]
    return values, ([metres * step for step in spacing], [metres * first for first in origin], bool(unit))


def _steps(data: xarray.DataArray, axis: str) -> tuple[float, float, bool]:
    """Distance between neighbours along an axis, the least coordinate, and whether they fall."""
    mend = "interpolate to even steps, or give spacing and origin as well"
    if axis not in data.coords:
        raise Error(f"there are no coordinates along {axis}; give spacing and origin as well")
    if data.coords[axis].dims != (axis,):
        raise Error(f"the coordinates along {axis} depend on {', '.join(map(str, data.coords[axis].dims))}; {mend}")
    places = np.asarray(data.coords[axis].values)
    if places.dtype.kind not in "iuf":
        raise Error(f"the coordinates along {axis} are no numbers; {mend}")
    places = places.astype(float)
    if len(places) < 2:
        raise Error(
            f"there is a single coordinate along {axis}, which says no spacing; give spacing and origin as well"
        )
    step = (places[-1] - places[0]) / (len(places) - 1)
    even = places[0] + step * np.arange(len(places))
    # Coordinates are often rounded to 32 bits.
    if not np.isfinite(step) or step == 0 or not (np.abs(places - even) <= 0.01 * abs(step)).all():
        raise Error(f"the coordinates along {axis} are not evenly spaced; {mend}")
    return abs(step), float(min(places[0], places[-1])), step < 0


def dataset(render: Render) -> xarray.Dataset:
    """A picture as a Dataset: `image` and `standard_error` over y, x and channel, the other layers, and how they were made.

    y counts rows downwards.
    """
    import xarray

    pixel = ("y", "x")
    colour = (*pixel, "channel")
    variables: dict[str, Any] = {
        "image": (colour, render.image),
        "standard_error": (colour, render.standard_error),
    }
    coordinates: dict[str, Any] = {"channel": render.channels}
    for name, values in render.layers.items():
        dims: tuple[str, ...] = colour[: values.ndim]
        if name == "Normal":
            dims, coordinates["axis"] = (*pixel, "axis"), list(AXES)
        elif name == "Albedo" and render.channels == ["X", "Y", "Z"]:
            # Of light in XYZ the albedo is in RGB all the same.
            dims, coordinates["rgb"] = (*pixel, "rgb"), ["R", "G", "B"]
        variables[name] = (dims, values)
    return xarray.Dataset(variables, coords=coordinates, attrs=dict(render.metadata))
