"""Types of the compiled part."""

import os
import pathlib
from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeAlias, final

import numpy as np
import numpy.typing as npt
import xarray

__version__: str

_Path: TypeAlias = str | os.PathLike[str]
_Length: TypeAlias = float | str | Any  # or a quantity of pint
_Image: TypeAlias = npt.NDArray[np.float32]
_Floats: TypeAlias = npt.NDArray[np.float64]

@final
class Volume:
    """A grid of numbers in space, to be rendered or to stand where a scene names a file."""

    def __new__(
        cls,
        array: npt.ArrayLike | xarray.DataArray,
        *,
        spacing: _Length | Sequence[_Length] | None = None,
        origin: _Length | Sequence[_Length] | None = None,
        index_to_world: npt.ArrayLike | None = None,
        name: str = "density",
    ) -> Volume: ...
    @staticmethod
    def load(path: _Path, grid: str | None = None) -> Volume:
        """Reads a grid of a volume file: the one of this name, or the one that is most likely a density."""
    @staticmethod
    def from_bytes(bytes: bytes) -> Volume:
        """The volume of `to_bytes`."""
    def to_bytes(self) -> bytes:
        """All of it, for `from_bytes`."""
    def save(self, path: _Path) -> pathlib.Path:
        """Writes it to a file whose extension says the format (.vdb .nvdb .vol .npy .nii .nii.gz .raw); returns the name written."""
    @property
    def array(self) -> npt.NDArray[np.float32]:
        """The voxels, as a new array of shape (X, Y, Z) or (X, Y, Z, 3)."""
    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of `array`."""
    @property
    def index_to_world(self) -> npt.NDArray[np.float64]:
        """The 4×4 matrix from indices of `array` to the world; voxel centres stand at whole numbers."""
    @property
    def name(self) -> str:
        """What the grid is called."""
    @property
    def hash(self) -> str:
        """Hash of the content."""
    def __reduce__(self) -> tuple[Any, ...]: ...

@final
class Scene:
    """What is rendered: camera, media, surfaces, lights."""

    def __new__(cls, scene: Mapping[str, Any] | Scene) -> Scene: ...
    @staticmethod
    def load(
        path: _Path | None = None, frame: int | None = None, define: Mapping[str, str] = ..., strict: bool = False
    ) -> Scene:
        """What `tyndall.load` calls."""
    @staticmethod
    def from_toml(text: str, folder: _Path | None = None, volumes: Mapping[str, Volume] | None = None) -> Scene:
        """The scene that is the text of a scene file; file names are relative to `folder`, or name `volumes`."""
    @staticmethod
    def of_volume(volume: Volume) -> Scene:
        """The scene of a bare volume: camera, light and density are chosen from its values."""
    def at_frame(self, frame: int) -> Scene:
        """The scene of another frame of the animation that was loaded with a `frame`."""
    def to_dict(self) -> dict[str, Any]:
        """All of it as dictionaries, lists and numbers."""
    def to_toml(self) -> str:
        """All of it as the text of a scene file.

        Volumes in memory have names such as `<volume 0>` in it: for a file, save them first and name the files.
        """
    def to_parts(self) -> tuple[str, dict[str, pathlib.Path], dict[str, Volume]]:
        """The scene as text and files, from which it can be made anew elsewhere.

        The text names each file by a hash of its content and its name, such as `HASH/cloud.vdb`; then where these are now; then
        the volumes in memory by the names that the text has for them.
        """
    def copy(self) -> Scene:
        """A scene of its own that can be changed without changing this one."""
    def __getitem__(self, path: str) -> Any:
        """The value at a path of keys, such as `camera.vertical_fov` or `volume.0.mu_t`."""
    def __setitem__(self, path: str, value: Any) -> None:
        """Changes a value; what does not fit the scene is refused and changes nothing."""
    def __contains__(self, path: str) -> bool: ...
    @property
    def hash(self) -> str:
        """Hash of all that decides the expected picture, files and volumes included."""
    @property
    def files(self) -> dict[str, pathlib.Path]:
        """The files that the scene names: as it names them, and where they are."""
    @property
    def volumes(self) -> dict[str, Volume]:
        """The volumes that stand for files, by their names."""
    @property
    def notes(self) -> list[str]:
        """What was guessed, and what is not as in the renderer that the scene is for; one line each."""
    def __copy__(self) -> Scene: ...
    def __deepcopy__(self, memo: Any, /) -> Scene: ...
    def __reduce__(self) -> tuple[Any, ...]: ...

@final
class Accumulation:
    """The exact sums of a picture's samples, to be added to those of other samples: in any split and order, the same bits."""

    @staticmethod
    def read(path: _Path) -> Accumulation:
        """Reads an `.acc` file."""
    @staticmethod
    def from_bytes(bytes: bytes) -> Accumulation:
        """The accumulation of `to_bytes`."""
    def to_bytes(self) -> bytes:
        """The content of an `.acc` file."""
    def save(self, path: _Path, exposure: float = 0.0) -> None:
        """Writes the sums (`.acc`), the picture (`.exr`, `.png`), or its numbers (`.json`); `exposure` in stops is for `.png`."""
    def merge(self, other: Accumulation) -> None:
        """Adds the samples of another. Those of another scene, or that are there already, are refused, and nothing changes."""
    def __add__(self, other: Accumulation) -> Accumulation: ...
    def __eq__(self, other: object) -> bool: ...
    @property
    def samples(self) -> list[tuple[int, int]]:
        """Ranges of the samples that every pixel holds."""
    @property
    def image(self) -> _Image:
        """Mean radiance, of shape (H, W, 3)."""
    @property
    def standard_error(self) -> _Image:
        """Its standard error."""
    @property
    def median_error(self) -> float | None:
        """Median over the pixels of standard error over mean of luminance."""
    def error_against(self, asked: float) -> float | None:
        """The error to be held against one that is asked for: the median error, or the bound of what most pixels have not seen
        yet, as a share of their light, if that is more than was asked for. `None` of a black picture, and with fewer than 16
        samples in some pixel.
        """
    @property
    def nbytes(self) -> int:
        """Memory that it takes, at most."""
    @property
    def scene_hash(self) -> str:
        """Hash of the scene."""
    @property
    def seed(self) -> int:
        """Seed of the random numbers."""
    @property
    def seconds(self) -> float:
        """Time of rendering, summed over what was merged."""
    def __reduce__(self) -> tuple[Any, ...]: ...

@final
class Render:
    """A picture with its error."""

    @staticmethod
    def from_accumulation(
        accumulation: Accumulation, *, exposure: float = 0.0, notes: Sequence[str] = (), complete: bool = True
    ) -> Render:
        """The picture that the sums of an `.acc` file, or of merged renders, come to."""
    @property
    def image(self) -> _Image:
        """Mean radiance, linear: of shape (H, W, 3), or (H, W, N) of a picture of N bands."""
    @property
    def standard_error(self) -> _Image:
        """Standard error of `image`, of the same shape; infinite with fewer than two samples."""
    @property
    def layers(self) -> dict[str, _Image]:
        """The other layers by their names in an EXR file, of shape (H, W) or (H, W, channels)."""
    @property
    def channels(self) -> list[str]:
        """What the channels of `image` are: `R`, `G`, `B`, or wavelengths such as `550nm`."""
    @property
    def samples(self) -> float:
        """Samples of each pixel, the mean of all pixels."""
    @property
    def seconds(self) -> float:
        """Time of rendering."""
    @property
    def median_error(self) -> float | None:
        """Median over the pixels with medium of standard error over mean; `None` if the picture is black."""
    @property
    def unseen_light(self) -> float | None:
        """The light that most pixels have not seen yet, as a share of what they show, at most, as far as the picture knows; `None`
        if it is black.
        """
    @property
    def warnings(self) -> list[str]:
        """What has to be told along with the picture, where its stated errors do not hold; one line each."""
    @property
    def rejected(self) -> int:
        """Samples that were not finite or too large; the picture leaves them out, and may be biased by it."""
    @property
    def complete(self) -> bool:
        """Whether all that was asked for is there; not so after Ctrl-C."""
    @property
    def notes(self) -> list[str]:
        """What was guessed, and what the user should know; one line each."""
    @property
    def metadata(self) -> dict[str, Any]:
        """How the samples were made: seed, samples, scene, options, version."""
    @property
    def accumulation(self) -> Accumulation:
        """The exact sums, to be saved or merged with those of other samples."""
    def save(self, path: _Path, exposure: float | None = None) -> None:
        """Writes the picture (`.exr`, `.png`), its sums (`.acc`) or its numbers (`.json`); `exposure` in stops is for `.png`."""
    def to_xarray(self) -> xarray.Dataset:
        """The picture as an xarray Dataset over y, x and channel."""
    def _repr_png_(self) -> bytes | None: ...

@final
class Progress:
    """What is known of a render under way."""

    @property
    def samples(self) -> float:
        """Samples of each pixel so far, the mean of all pixels."""
    @property
    def spp(self) -> int | None:
        """Samples that will be made at most; `None` if only an error or a time ends the render."""
    @property
    def error(self) -> float | None:
        """Median relative standard error, once it is known."""
    @property
    def seconds(self) -> float:
        """Time since the start."""
    @property
    def image(self) -> _Image | None:
        """The picture as it was after the last pass, of shape (H, W, 3), if there is a new one."""

def render(
    scene: Scene,
    *,
    spp: int | None,
    samples: tuple[int, int] | None,
    error: float | None,
    time: float | None,
    seed: int | None,
    threads: int | None,
    report: Callable[[Progress], object] | None,
    with_image: bool,
    with_error: bool = True,
    in_one_pass: bool = False,
) -> Render:
    """What `tyndall.render` calls; `with_error=False` saves the look at every pixel that error and picture in the reports cost."""

def schema() -> str:
    """The JSON schema of scenes, as text."""

@final
class PhaseFunction:
    """A phase function in one line, such as `"hg(g=0.85)"`, for light that arrives along `incidence`.

    The direction only concerns oriented particles (`sggx`); along their axis unless given. What was chosen for the user,
    such as a wavelength, is told by `note`.
    """

    def __new__(cls, spec: str, incidence: Sequence[float] | None = None) -> PhaseFunction: ...
    def __getnewargs__(self) -> tuple[str, Sequence[float] | None]: ...
    @property
    def spec(self) -> str: ...
    @property
    def note(self) -> str | None: ...
    @property
    def has_incidence(self) -> bool: ...
    @property
    def mean_cosine(self) -> float: ...
    @property
    def projected_area(self) -> float | None:
        """The area that oriented particles turn to the light; None of others."""
    @property
    def q_ext(self) -> float | None:
        """Extinction efficiency; None of what is not made of spheres, as are the others."""
    @property
    def q_sca(self) -> float | None: ...
    @property
    def q_abs(self) -> float | None: ...
    @property
    def q_back(self) -> float | None:
        """Radar backscattering efficiency, of spheres that are all alike."""
    @property
    def albedo(self) -> float | None: ...
    def values(self, cos_theta: _Floats) -> _Floats: ...
    def values_between(self, before: _Floats, after: _Floats) -> _Floats: ...
    def cosines(self, u: _Floats) -> _Floats: ...
    def cosines_of_seed(self, n: int, seed: int) -> _Floats: ...
    def directions(self, before: _Floats, u: _Floats) -> _Floats: ...

def mie_spheres(x: _Floats, n: _Floats, k: _Floats, cos_theta: _Floats) -> tuple[list[_Floats], _Floats]: ...
def refractive_index(material: str, wavelength_nm: _Floats) -> list[_Floats]: ...

SlabFluxes: TypeAlias = tuple[list[tuple[float, float]], list[tuple[float, float]], int]

def slabs(layers: Sequence[Mapping[str, Any]], effort: Mapping[str, Any]) -> list[SlabFluxes]: ...
def meters(scene: Scene, effort: Mapping[str, Any]) -> str: ...
def albedo_of_reflectance(reflectance: _Floats, g: float) -> _Floats: ...
def declared_estimators() -> list[tuple[str, str, bool, str, list[str], str]]: ...
def optical_thickness(scene: Scene, rays: Mapping[str, Any]) -> _Floats: ...
def estimate_transmittance(scene: Scene, rays: Mapping[str, Any], sampling: Mapping[str, Any]) -> list[_Floats]: ...
def sample_distances(scene: Scene, rays: Mapping[str, Any], sampling: Mapping[str, Any]) -> list[_Floats]: ...
