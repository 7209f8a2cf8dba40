"""Arrays to pictures: a scene for a scalar field, with a medium by its values, a camera that frames it, and light.

>>> import numpy as np
>>> import tyndall
>>> z, y, x = np.mgrid[-1:1:24j, -1:1:24j, -1:1:24j]
>>> scene = tyndall.volume_scene(np.exp(-4 * (x**2 + y**2 + z**2)), preset="smoke", resolution=(64, 48))
>>> scene["volume.0.phase"]
{'type': 'hg', 'g': 0.5}
>>> tyndall.render(scene, spp=2, progress=False).image.shape
(48, 64, 3)
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tyndall import _arrays
from tyndall._arrays import Floats
from tyndall._errors import Error
from tyndall._render import render
from tyndall._tyndall import Progress, Render, Scene, Volume
from tyndall.transfer_function import TransferFunction

__all__ = ["PRESETS", "render_volume", "volume_scene"]

_VERTICAL_FOV = 30.0
# Part of the picture's width or height that the volume's box fills.
_FILLED = 0.97


@dataclass(frozen=True)
class Preset:
    """How a kind of data is shown."""

    medium: dict[str, Any]
    """Keys of a medium whose density the values are, where there is no `transfer_function`."""
    thickness: float
    """Optical thickness of the body at its mean value (of a transfer function: at extinction 1)."""
    transfer_function: TransferFunction | None
    """By the values, with extinctions relative to one another."""
    light: str
    """`"day"` or `"studio"`."""
    view: tuple[float, float]
    """Azimuth and elevation of the viewer, degrees."""


_BODY = [[0.80, 0.42, 0.30], [0.80, 0.42, 0.30], [0.72, 0.24, 0.18], [0.94, 0.85, 0.70], [0.97, 0.95, 0.90]]

PRESETS = {
    "smoke": Preset({"albedo": 0.9, "phase": {"type": "hg", "g": 0.5}}, 12.0, None, "day", (-30.0, -15.0)),
    # Of droplets g is 0.85; with 0.5 and a third of their thickness a cloud looks alike, and is rendered sooner.
    "cloud": Preset({"albedo": 0.999, "phase": {"type": "hg", "g": 0.5}}, 24.0, None, "day", (-30.0, -15.0)),
    # Hounsfield units: air -1000, fat -100, water 0, muscle 50, bone from 300.
    "ct": Preset(
        {},
        3.0,
        TransferFunction([-300, -100, 60, 300, 1200], extinction=[0, 0.4, 1, 30, 120], reflectance=_BODY),
        "studio",
        (-30.0, 10.0),
    ),
}
"""The presets by name."""


def volume_scene(
    density: ArrayLike | Volume,
    *,
    spacing: Any = None,
    origin: Any = None,
    preset: str = "smoke",
    transfer_function: TransferFunction | None = None,
    optical_thickness: float | None = None,
    up: str = "z",
    view: tuple[float, float] | None = None,
    resolution: tuple[int, int] = (960, 540),
    exposure: float | None = None,
) -> Scene:
    """A scene for a scalar field, to be rendered, or to be changed first (`scene["camera.vertical_fov"] = 20`).

    `density` is an array of shape (X, Y, Z), an xarray or a `Volume`; `spacing` and `origin` say where voxels stand, as for
    `Volume`. `preset` chooses medium, light and view: `"smoke"`, `"cloud"` (values are densities, and the body is given an
    `optical_thickness` of 12 or 24), `"ct"` (values are Hounsfield units; soft tissue is given an `optical_thickness` of
    3). A `transfer_function` makes the medium instead, with its extinctions as they are, per scene unit, unless an
    `optical_thickness` is given: that of the body's box at extinction 1. The data's axis `up` points up, and the viewer stands at
    the azimuth and elevation `view`, in degrees: at azimuth 0 on the negative side of the data's y (if y or x is up, on the
    positive side of z), at 90 to the right of that.
    """
    if not isinstance(preset, str) or preset not in PRESETS:
        raise Error(f'preset: there is no "{preset}"; there is {", ".join(PRESETS)}')
    chosen = PRESETS[preset]
    if optical_thickness is not None and _arrays.number("optical_thickness", optical_thickness) <= 0:
        raise Error(f"optical_thickness: a number above 0 is needed, not {optical_thickness!r}")
    if transfer_function is not None and not isinstance(transfer_function, TransferFunction):
        raise Error(f"transfer_function: a TransferFunction is needed, not {repr(transfer_function)[:60]}")
    volume = density if isinstance(density, Volume) else Volume(density, spacing=spacing, origin=origin)
    if isinstance(density, Volume) and (spacing is not None or origin is not None):
        raise Error("spacing: a Volume has its own; leave `spacing` and `origin` away")
    if len(volume.shape) != 3:
        raise Error(f"density: a scalar field of shape (X, Y, Z) is needed; the shape is {volume.shape}")
    placed = _Placed(volume, _rotation(up))
    if transfer_function is not None:
        volumes = placed.classified(transfer_function, optical_thickness)
    elif chosen.transfer_function is not None:
        volumes = placed.classified(chosen.transfer_function, optical_thickness or chosen.thickness)
    else:
        volumes = placed.of_density(chosen.medium, optical_thickness or chosen.thickness)
    azimuth, elevation = _angles(chosen.view if view is None else view)
    stage = _day(azimuth) if chosen.light == "day" else _studio(azimuth)
    width, height = (_arrays.whole("resolution", edge, 1, 1 << 16) for edge in _arrays.pair("resolution", resolution))
    film: dict[str, Any] = {"resolution": [width, height]}
    film["exposure"] = stage.exposure if exposure is None else exposure
    camera = placed.framing_camera(azimuth, elevation, width / height)
    return Scene({"camera": camera, "film": film, "volume": volumes, "light": stage.lights})


def render_volume(
    density: ArrayLike | Volume,
    spp: int | None = None,
    seed: int | None = None,
    *,
    spacing: Any = None,
    origin: Any = None,
    preset: str = "smoke",
    transfer_function: TransferFunction | None = None,
    optical_thickness: float | None = None,
    up: str = "z",
    view: tuple[float, float] | None = None,
    resolution: tuple[int, int] = (960, 540),
    exposure: float | None = None,
    samples: tuple[int, int] | None = None,
    error: float | str | None = None,
    time: float | None = None,
    threads: int | None = None,
    progress: bool | Callable[[Progress], object] = True,
) -> Render:
    """A picture of a scalar field: `render(volume_scene(density, ...), ...)`, whose arguments these are.

    >>> values = np.zeros((16, 16, 16))
    >>> values[4:12, 4:12, 4:12] = 1
    >>> render_volume(values, spp=1, resolution=(32, 18), progress=False).image.shape
    (18, 32, 3)
    """
    scene = volume_scene(
        density,
        spacing=spacing,
        origin=origin,
        preset=preset,
        transfer_function=transfer_function,
        optical_thickness=optical_thickness,
        up=up,
        view=view,
        resolution=resolution,
        exposure=exposure,
    )
    return render(scene, spp, seed, samples=samples, error=error, time=time, threads=threads, progress=progress)


class _Placed:
    """A volume, how it is turned, and how much of its box is filled."""

    def __init__(self, volume: Volume, rotation: list[float]) -> None:
        self.volume = volume
        self.rotation = rotation
        self.array: NDArray[np.float32] = volume.array
        self.bounds = [(0, count - 1) for count in self.array.shape]

    def of_density(self, medium: Mapping[str, Any], thickness: float) -> list[dict[str, Any]]:
        """The volume itself as a density."""
        filled = np.isfinite(self.array) & (self.array > 0)
        if not filled.any():
            raise Error("density: no value is above 0, so that nothing would be seen")
        self._bound(filled)
        mean = float(self.array[filled].mean(dtype=np.float64))
        body = self._edge() * np.cbrt(np.count_nonzero(filled) / self._voxels())
        mu_t = float(thickness / (mean * body))
        return [{"name": "density", "file": self.volume, "mu_t": mu_t, **medium, **self._turned()}]

    def classified(self, function: TransferFunction, thickness: float | None) -> list[dict[str, Any]]:
        """The volumes of a transfer function: one that scatters, and those whose glow has another colour."""
        density, keys, glows = function.medium(self.array)
        filled = density > 0
        for strength, _ in glows:
            filled |= strength > 0
        if not filled.any():
            low, high = np.nanmin(self.array), np.nanmax(self.array)
            raise Error(
                f"transfer_function: makes nothing of the values, which are from {low:g} to {high:g}; give one whose "
                "points are among them"
            )
        self._bound(filled)
        scale = 1.0 if thickness is None else thickness / self._edge()
        keys["mu_t"] *= scale
        glows = [(strength, [scale * part for part in radiance]) for strength, radiance in glows]
        main: dict[str, Any] = {"name": "medium", "file": self._like(density, "density"), **keys, **self._turned()}
        if "albedo_grid" in keys:
            main["albedo_grid"] = {"file": self._like(keys["albedo_grid"], "color")}
        volumes = [main] if np.any(density) else []
        if volumes and len(glows) == 1:
            strength, main["emission_per_length"] = glows.pop()
            main["emission_grid"] = {"file": self._like(strength, "flame")}
        for number, (strength, radiance) in enumerate(glows):
            glow = {"name": f"glow {number}", "file": self._like(strength, "flame"), "mu_t": 0.0, "albedo": 0.0}
            volumes.append({**glow, "emission_per_length": radiance, **self._turned()})
        return volumes

    def _bound(self, filled: NDArray[np.bool_]) -> None:
        """Takes the box of what is filled for that of the body."""
        for axis in range(3):
            found = np.flatnonzero(filled.any(axis=tuple({0, 1, 2} - {axis})))
            self.bounds[axis] = (int(found[0]), int(found[-1]))

    def _voxels(self) -> int:
        return int(np.prod([high - low + 1 for low, high in self.bounds]))

    def _edge(self) -> float:
        """The middle one of the edges of the body's box."""
        corners = self._corners()
        return float(np.sort(corners.max(axis=0) - corners.min(axis=0))[1])

    def framing_camera(self, azimuth: float, elevation: float, aspect: float) -> dict[str, Any]:
        """The nearest camera in the viewer's direction that has the whole box in the picture."""
        # Interpolation fades out over a voxel.
        corners = self._corners(rim=1.0)
        centre = (corners.min(axis=0) + corners.max(axis=0)) / 2
        viewer = _toward(azimuth, elevation)
        right = np.cross(-viewer, [0.0, 1.0, 0.0])
        if not np.any(np.abs(right) > 1e-9):
            raise Error("view: give an elevation between -90 and 90, both excluded")
        right /= np.linalg.norm(right)
        upward = np.cross(right, -viewer)
        vertical = np.tan(np.radians(_VERTICAL_FOV / 2)) * _FILLED
        offsets = corners - centre
        # In the picture if its distance across is at most the tangent times the distance along.
        nearer = offsets @ viewer
        across = np.maximum(np.abs(offsets @ right) / (vertical * aspect), np.abs(offsets @ upward) / vertical)
        position = centre + viewer * float((nearer + across).max())
        return {"position": position.tolist(), "target": centre.tolist(), "vertical_fov": _VERTICAL_FOV}

    def _corners(self, rim: float = 0.5) -> Floats:
        """The corners in the scene of a box that goes so many voxels beyond the outermost centres."""
        ends = [(low - rim, high + rim) for low, high in self.bounds]
        index = np.array(np.meshgrid(*ends)).reshape(3, -1)
        matrix = self.volume.index_to_world
        world = matrix[:3, :3] @ index + matrix[:3, 3:]
        return np.asarray((_matrix(self.rotation) @ world).T)

    def _turned(self) -> dict[str, Any]:
        return {"transform": {"rotate": self.rotation}} if any(self.rotation) else {}

    def _like(self, array: NDArray[np.float32], name: str) -> Volume:
        return Volume(array, index_to_world=self.volume.index_to_world, name=name)


@dataclass(frozen=True)
class _Stage:
    lights: list[dict[str, Any]]
    exposure: float


def _day(azimuth: float) -> _Stage:
    """A clear day with the sun at the viewer's right."""
    return _Stage([{"type": "sky", "toward_sun": _toward(azimuth + 70, 35).tolist()}], 0.4)


def _studio(azimuth: float) -> _Stage:
    """A wide key light from above at the left, a weak one from behind at the right, and a grey surround."""
    key = {"type": "sun", "direction": (-_toward(azimuth - 45, 40)).tolist(), "irradiance": 3.0, "angular_diameter": 30}
    rim = {
        "type": "sun",
        "direction": (-_toward(azimuth + 140, 25)).tolist(),
        "irradiance": 1.0,
        "angular_diameter": 20,
    }
    return _Stage([key, rim, {"type": "constant", "radiance": 0.15}], 0.0)


def _angles(view: Any) -> tuple[float, float]:
    """Azimuth and elevation in degrees."""
    try:
        azimuth, elevation = (_arrays.number("view", angle) for angle in _arrays.pair("view", view))
        if abs(elevation) <= 90:
            return azimuth, elevation
    except Error:
        pass
    raise Error("view: give azimuth and elevation in degrees, such as (30, 20)")


def _toward(azimuth: float, elevation: float) -> Floats:
    """The direction toward an azimuth, from +z over +x, and an elevation above the plane of x and z."""
    a, e = np.radians(azimuth), np.radians(elevation)
    return np.array([np.sin(a) * np.cos(e), np.sin(e), np.cos(a) * np.cos(e)])


def _rotation(up: str) -> list[float]:
    """Rotations about x, y and z, degrees, that turn an axis of the data to +y."""
    rotations = {"x": [0.0, 0.0, 90.0], "y": [0.0, 0.0, 0.0], "z": [-90.0, 0.0, 0.0]}
    if not isinstance(up, str) or up not in rotations:
        raise Error(f'up: write "x", "y" or "z", not {up!r}')
    return rotations[up]


def _matrix(rotation: list[float]) -> Floats:
    """The matrix of such a rotation, of which only one angle is not 0."""
    matrix = np.eye(3)
    for axis, degrees in enumerate(rotation):
        c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
        one, other = (axis + 1) % 3, (axis + 2) % 3
        turn = np.eye(3)
        turn[one, one], turn[one, other], turn[other, one], turn[other, other] = c, -s, s, c
        matrix = turn @ matrix
    return matrix
