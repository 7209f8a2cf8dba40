"""Phase functions: how light is spread over directions when it is scattered.

A phase function is one line of text, as for the command `tyndall phase`: `"hg(g=0.85)"`, `"rayleigh"`, `"fog(d=10um)"`,
`"mie(material=water,wavelength=550nm,distribution=gamma(r_eff=10um,v_eff=0.1))"`, and so on. Angles are between the
directions in which light travels before and after: the cosine 1 is forward. Values are in 1/sr and integrate to 1 over
the sphere.

>>> import numpy as np
>>> import tyndall
>>> tyndall.phase.evaluate("rayleigh", [-1, 0, 1]).round(6)
array([0.119366, 0.059683, 0.119366])
>>> tyndall.phase.mean_cosine("hg:0.85")
0.85
>>> float(tyndall.phase.mie(x=10, m=1.33 + 1e-5j).q_ext.round(6))
2.206593
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tyndall import _arrays, _tyndall
from tyndall._arrays import Floats
from tyndall._errors import Error
from tyndall._progress import say
from tyndall._tyndall import PhaseFunction

__all__ = [
    "Mie",
    "PhaseFunction",
    "evaluate",
    "evaluate_directions",
    "mean_cosine",
    "mie",
    "refractive_index",
    "sample",
    "sample_directions",
]

# Random numbers and results are in memory at once.
_MOST_SAMPLES = 1 << 28
_GREATEST_SEED = 2**64 - 1


def evaluate(spec: str | PhaseFunction, cos_theta: ArrayLike) -> Floats:
    """Values, 1/sr, at cosines of the scattering angle; also the density, per solid angle, of `sample`.

    Of oriented particles (`sggx`) it is the mean over the azimuth, for light along their axis; `PhaseFunction(spec,
    incidence=(x, y, z))` is that for light along another direction.

    >>> float(evaluate("isotropic", 0.3) * 4 * np.pi)
    1.0
    """
    cosines = _arrays.cosines("cos_theta", cos_theta)
    return _shaped(phase_function_of(spec).values(cosines.ravel()), cosines.shape)


def mean_cosine(spec: str | PhaseFunction) -> float:
    """The mean cosine g of the scattering angle.

    >>> round(mean_cosine("draine(g=0.3,alpha=10)"), 6)
    0.447568
    """
    return phase_function_of(spec).mean_cosine


def sample(spec: str | PhaseFunction, n: int | None = None, *, u: ArrayLike | None = None, seed: int = 0) -> Floats:
    """Cosines of the scattering angle, distributed as the phase function: `n` of them, or one for each `u` in [0, 1).

    Lorenz-Mie scattering is sampled from the table that scenes are rendered with. For `sggx` with an `incidence` the last
    axis of `u` has two numbers.

    >>> sample("isotropic", u=[0.25, 0.5])
    array([-0.5,  0. ])
    >>> bool(abs(sample("hg:0.85", 10_000, seed=1).mean() - 0.85) < 0.02)
    True
    """
    phase = phase_function_of(spec)
    if (n is None) == (u is None):
        raise Error("sample: give the number n of samples, or random numbers u, and not both")
    if u is None:
        count = _arrays.whole("n", n, 0, _MOST_SAMPLES)
        return phase.cosines_of_seed(count, _arrays.whole("seed", seed, 0, _GREATEST_SEED))
    numbers = _unit_interval("u", u)
    if phase.has_incidence:
        if numbers.ndim == 0 or numbers.shape[-1] != 2:
            raise Error(f"u: with an incidence the last axis must have 2 numbers; the shape is {numbers.shape}")
    else:
        numbers = np.stack([numbers, np.zeros_like(numbers)], axis=-1)
    return _shaped(phase.cosines(_arrays.rows(numbers)), numbers.shape[:-1])


def evaluate_directions(spec: str | PhaseFunction, before: ArrayLike, after: ArrayLike) -> Floats:
    """Values, 1/sr, for light that travels along `before` and then along `after`, arrays (..., 3) that broadcast.

    >>> evaluate_directions("rayleigh", [0, 0, 1], [[0, 0, 1], [1, 0, 0]]).round(6)
    array([0.119366, 0.059683])
    """
    first, second = _arrays.broadcast_rows(
        before=_arrays.directions("before", before), after=_arrays.directions("after", after)
    )
    return _shaped(phase_function_of(spec).values_between(_arrays.rows(first), _arrays.rows(second)), first.shape[:-1])


def sample_directions(spec: str | PhaseFunction, before: ArrayLike, u: ArrayLike) -> Floats:
    """Unit vectors (..., 3) after scattering of light along `before` (..., 3), for random numbers `u` (..., 2) in [0, 1).

    >>> sample_directions("isotropic", [0, 0, 1], [0.0, 0.0]).round(6) + 0.0
    array([ 0.,  0., -1.])
    """
    numbers = _unit_interval("u", u)
    if numbers.ndim == 0 or numbers.shape[-1] != 2:
        raise Error(f"u: the last axis must have 2 numbers; the shape is {numbers.shape}")
    first, second = _arrays.broadcast_rows(before=_arrays.directions("before", before), u=numbers)
    return phase_function_of(spec).directions(_arrays.rows(first), _arrays.rows(second)).reshape(first.shape)


class Mie(NamedTuple):
    """What spheres do to light, by Lorenz-Mie theory; arrays in the common shape of the arguments."""

    q_ext: Floats
    """Extinction efficiency: cross section over πr²."""
    q_sca: Floats
    """Scattering efficiency."""
    q_abs: Floats
    """Absorption efficiency."""
    q_back: Floats
    """Radar backscattering efficiency; NaN of a distribution of sizes."""
    g: Floats
    """Mean cosine of the scattering angle."""
    values: Floats | None
    """The phase function, 1/sr, at `cos_theta`, whose axes come last; None without."""

    @property
    def albedo(self) -> Floats:
        """Single-scattering albedo."""
        return self.q_sca / self.q_ext


def mie(
    *,
    x: ArrayLike | None = None,
    m: complex | NDArray[np.complex128] | ArrayLike | None = None,
    material: str | None = None,
    wavelength_nm: ArrayLike | None = None,
    radius_um: ArrayLike | None = None,
    distribution: str | None = None,
    cos_theta: ArrayLike | None = None,
) -> Mie:
    """Spheres by Lorenz-Mie theory, over arrays.

    How large they are is said by a size parameter `x` (circumference over wavelength), by `radius_um` and `wavelength_nm`,
    or by a `distribution` such as `"gamma(r_eff=10um,v_eff=0.1)"` and `wavelength_nm`; what they are made of by a complex
    refractive index `m` (a positive imaginary part absorbs) or by a `material` such as `"water"`.

    >>> ice = mie(material="ice", wavelength_nm=[450, 550, 650], radius_um=5)
    >>> ice.q_ext.shape, ice.values
    ((3,), None)
    >>> cloud = mie(material="water", wavelength_nm=550, distribution="gamma(r_eff=1um,v_eff=0.1)", cos_theta=[1, -1])
    >>> cloud.values.shape
    (2,)
    """
    if (m is None) == (material is None):
        raise Error("mie: say what the spheres are made of by one of `m` and `material`")
    sizes = [
        name for name, size in (("x", x), ("radius_um", radius_um), ("distribution", distribution)) if size is not None
    ]
    if len(sizes) != 1:
        raise Error("mie: say how large the spheres are by one of `x`, `radius_um` and `distribution`")
    if wavelength_nm is None and (x is None or material is not None):
        raise Error("mie: `wavelength_nm` is needed")
    if x is not None and m is not None and wavelength_nm is not None:
        raise Error("mie: with `x` and `m` the wavelength does not matter; leave `wavelength_nm` away")
    at = None if cos_theta is None else _arrays.cosines("cos_theta", cos_theta)
    if distribution is not None:
        return _distributed(m, material, wavelength_nm, distribution, at)
    if radius_um is not None:
        assert wavelength_nm is not None
        radius, wavelength = _arrays.broadcast(radius_um=radius_um, wavelength_nm=wavelength_nm)
        with np.errstate(divide="ignore", invalid="ignore"):
            x = 2 * np.pi * radius * 1e3 / wavelength
    index = _index(m, material, wavelength_nm)
    assert x is not None
    size, n, k = _arrays.broadcast(x=x, m=index.real, m_imag=index.imag)
    angles = np.empty(0) if at is None else at.ravel()
    figures, values = _tyndall.mie_spheres(size.ravel(), n.ravel(), k.ravel(), angles)
    q_ext, q_sca, q_abs, q_back, g = (_shaped(figure, size.shape) for figure in figures)
    return Mie(q_ext, q_sca, q_abs, q_back, g, None if at is None else _shaped(values, size.shape + at.shape))


def refractive_index(material: str, wavelength_nm: ArrayLike) -> NDArray[np.complex128]:
    """Refractive indices n + ik of a built-in material at wavelengths in nm.

    >>> complex(refractive_index("water", 550).round(3))
    (1.336+0j)
    """
    wavelength = _arrays.floats("wavelength_nm", wavelength_nm)
    n, k = _tyndall.refractive_index(material, wavelength.ravel())
    return (n + 1j * k).reshape(wavelength.shape)[()]


def _distributed(
    m: complex | ArrayLike | None,
    material: str | None,
    wavelength_nm: ArrayLike | None,
    distribution: str,
    at: Floats | None,
) -> Mie:
    index = np.zeros(()) if m is None else _complex("m", m)
    assert wavelength_nm is not None
    n, k, wavelength = _arrays.broadcast(m=index.real, m_imag=index.imag, wavelength_nm=wavelength_nm)
    figures: list[list[float]] = []
    values = []
    for one_n, one_k, nm in zip(n.ravel(), k.ravel(), wavelength.ravel()):
        made_of = f"material={material}" if material is not None else f"m={float(one_n)!r}+{float(one_k)!r}i"
        phase = PhaseFunction(f"mie({made_of},wavelength_nm={float(nm)!r},distribution={distribution})")
        back = np.nan if phase.q_back is None else phase.q_back
        figures.append([phase.q_ext or 0.0, phase.q_sca or 0.0, phase.q_abs or 0.0, back, phase.mean_cosine])
        if at is not None:
            values.append(phase.values(at.ravel()))
    q_ext, q_sca, q_abs, q_back, g = (_shaped(row, wavelength.shape) for row in np.array(figures).reshape(-1, 5).T)
    table = None if at is None else _shaped(np.array(values), wavelength.shape + at.shape)
    return Mie(q_ext, q_sca, q_abs, q_back, g, table)


def _index(
    m: complex | ArrayLike | None, material: str | None, wavelength_nm: ArrayLike | None
) -> NDArray[np.complex128]:
    if material is None:
        return _complex("m", m)
    assert wavelength_nm is not None
    return np.asarray(refractive_index(material, wavelength_nm))


def _complex(name: str, value: complex | ArrayLike | None) -> NDArray[np.complex128]:
    try:
        return np.asarray(value).astype(np.complex128)
    except (TypeError, ValueError):
        raise Error(f"{name}: complex numbers such as 1.33+1e-5j are needed, not {value!r}") from None


def phase_function_of(spec: str | PhaseFunction) -> PhaseFunction:
    if isinstance(spec, PhaseFunction):
        return spec
    if isinstance(spec, str):
        phase = PhaseFunction(spec)
        if phase.note is not None:
            say(f"note: {phase.note}")
        return phase
    raise Error(f'a phase function is one line such as "hg(g=0.85)", not {spec!r}')


def _unit_interval(name: str, value: ArrayLike) -> Floats:
    array = _arrays.floats(name, value)
    if not np.all((array >= 0) & (array < 1)):
        raise Error(f"{name}: random numbers are from 0 to 1, without 1")
    return array


def _shaped(values: Floats, shape: tuple[int, ...]) -> Floats:
    # A number where a number was asked for, as NumPy's own functions do it.
    return values.reshape(shape)[()]
