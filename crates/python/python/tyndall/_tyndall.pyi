"""Types of the compiled part."""

from collections.abc import Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray
from typing_extensions import Self

__version__: str

class PhaseFunction:
    """A phase function in one line, such as `"hg(g=0.85)"`, for light that arrives along `incidence`.

    The direction only concerns oriented particles (`sggx`); along their axis unless given. What was chosen for the user,
    such as a wavelength, is told by `note`.
    """

    def __new__(cls, spec: str, incidence: Sequence[float] | None = None) -> Self: ...
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
    def values(self, cos_theta: NDArray[np.float64]) -> NDArray[np.float64]: ...
    def values_between(self, before: NDArray[np.float64], after: NDArray[np.float64]) -> NDArray[np.float64]: ...
    def cosines(self, u: NDArray[np.float64]) -> NDArray[np.float64]: ...
    def cosines_of_seed(self, n: int, seed: int) -> NDArray[np.float64]: ...
    def directions(self, before: NDArray[np.float64], u: NDArray[np.float64]) -> NDArray[np.float64]: ...

def mie_spheres(
    x: NDArray[np.float64], n: NDArray[np.float64], k: NDArray[np.float64], cos_theta: NDArray[np.float64]
) -> tuple[list[NDArray[np.float64]], NDArray[np.float64]]: ...
def refractive_index(material: str, wavelength_nm: NDArray[np.float64]) -> list[NDArray[np.float64]]: ...

SlabFluxes: TypeAlias = tuple[list[tuple[float, float]], list[tuple[float, float]], int]

def slab(layer: Mapping[str, Any], effort: Mapping[str, Any], stream: int) -> SlabFluxes: ...
