"""Phase functions: normalised, sampled as they are valued, and with the command's figures."""

from __future__ import annotations

import json
import pickle
from collections.abc import Callable

import numpy as np
import pytest
import tyndall
from tyndall import phase

SPECS = [
    "isotropic",
    "rayleigh",
    "hg(g=0.85)",
    "hg:-0.4",
    "double-hg(g1=0.9,g2=-0.3,weight=0.8)",
    "schlick(k=0.8)",
    "cornette-shanks(g=0.6)",
    "draine(g=0.6,alpha=0.5)",
    "fog(d=10um)",
    "sggx(kind=fibre,roughness=0.5)",
    "mie(m=1.33+1e-5i,x=3)",
    "mie(material=water,wavelength=550nm,distribution=gamma(r_eff=1um,v_eff=0.1))",
]


def quadrature() -> tuple[np.ndarray, np.ndarray]:
    """Cosines and weights of ∫ dω, fine near forward, where there are peaks."""
    nodes, weights = np.polynomial.legendre.leggauss(16)
    angles = np.concatenate([[0], np.geomspace(0.01, 10, 80), np.linspace(10, 180, 171)[1:]])
    edges = np.cos(np.radians(angles))[::-1]
    middle, half = (edges[1:] + edges[:-1]) / 2, (edges[1:] - edges[:-1]) / 2
    return (middle[:, None] + half[:, None] * nodes).ravel(), (2 * np.pi * half[:, None] * weights).ravel()


@pytest.mark.parametrize("spec", SPECS)
def test_a_phase_function_integrates_to_one_and_has_its_mean_cosine(spec: str) -> None:
    cosines, weights = quadrature()
    values = phase.evaluate(spec, cosines)
    # Tables have kinks between these nodes; a sphere's values are exact beside the table of its mean cosine.
    assert np.sum(values * weights) == pytest.approx(1, abs=2e-5)
    assert np.sum(values * weights * cosines) == pytest.approx(phase.mean_cosine(spec), abs=2e-4)


@pytest.mark.parametrize("spec", SPECS)
def test_samples_follow_the_values(spec: str) -> None:
    n = 40_000
    drawn = phase.sample(spec, n, seed=3)
    cosines, weights = quadrature()
    density = phase.evaluate(spec, cosines) * weights
    for moment in (1, 2):
        mean, square = np.sum(density * cosines**moment), np.sum(density * cosines ** (2 * moment))
        error = np.sqrt((square - mean**2) / n)
        assert abs(np.mean(drawn**moment) - mean) < 4.5 * error + 2e-4, moment


def test_seeds_give_the_same_samples_and_others_give_others() -> None:
    first, again, other = (phase.sample("rayleigh", 100, seed=seed) for seed in (7, 7, 8))
    assert np.array_equal(first, again) and not np.array_equal(first, other)


def test_directions_are_sampled_with_their_values() -> None:
    u = np.random.default_rng(1).random((20_000, 2))
    before = [1.0, 1.0, 0.0]
    for spec in ("hg(g=0.3)", "sggx(kind=surface,roughness=0.4,axis=[0,0,1])"):
        after = phase.sample_directions(spec, before, u)
        assert after.shape == (20_000, 3) and np.allclose(np.linalg.norm(after, axis=1), 1)
        # ∫ dω = 4π, by samples of the density that the values claim.
        inverse = 1 / phase.evaluate_directions(spec, before, after)
        assert abs(inverse.mean() - 4 * np.pi) < 4.5 * inverse.std() / np.sqrt(len(u))


def test_shapes_broadcast_and_numbers_stay_numbers() -> None:
    assert phase.evaluate("isotropic", np.zeros((2, 3, 4))).shape == (2, 3, 4)
    assert isinstance(phase.evaluate("isotropic", 1), float)
    assert phase.evaluate_directions("rayleigh", np.ones((5, 1, 3)), np.ones((4, 3))).shape == (5, 4)
    spheres = phase.mie(x=[[1], [2]], m=[1.33, 1.5 + 0.1j, 2], cos_theta=np.linspace(-1, 1, 7))
    assert spheres.q_ext.shape == (2, 3) and spheres.values is not None and spheres.values.shape == (2, 3, 7)
    for row, x in enumerate([1, 2]):
        one = phase.mie(x=x, m=1.5 + 0.1j)
        assert spheres.q_ext[row, 1] == one.q_ext and one.albedo < 1


def test_mie_by_material_is_mie_by_index_and_size() -> None:
    nm, um = np.array([450.0, 650.0]), np.array([[0.3], [2.0]])
    by_material = phase.mie(material="water", wavelength_nm=nm, radius_um=um)
    by_size = phase.mie(x=2 * np.pi * um * 1e3 / nm, m=phase.refractive_index("water", nm))
    for one, other in zip(by_material[:5], by_size[:5]):
        assert np.array_equal(one, other)
    alike = phase.mie(material="water", wavelength_nm=550, distribution="single(r=2um)")
    sphere = phase.mie(material="water", wavelength_nm=550, radius_um=2)
    assert alike.q_ext == pytest.approx(sphere.q_ext, rel=1e-12)


def test_a_small_sphere_scatters_as_rayleigh_says() -> None:
    x, m = 1e-2, 1.5 + 0j
    expected = 8 / 3 * x**4 * abs((m**2 - 1) / (m**2 + 2)) ** 2
    assert phase.mie(x=x, m=m).q_sca == pytest.approx(expected, rel=1e-3)


def test_oriented_particles_are_seen_from_the_incidence() -> None:
    across = phase.PhaseFunction("sggx(kind=fibre,roughness=0.5)", incidence=(1, 0, 0))
    along = phase.PhaseFunction("sggx(kind=fibre,roughness=0.5)")
    assert across.projected_area == pytest.approx(1) and along.projected_area == pytest.approx(0.5)
    cosines, weights = quadrature()
    assert np.sum(phase.evaluate(across, cosines) * weights) == pytest.approx(1, abs=1e-3)
    drawn = phase.sample(across, 40_000, seed=1)
    assert abs(drawn.mean() - across.mean_cosine) < 4.5 * drawn.std() / 200


def test_phase_functions_are_pickled_by_their_text() -> None:
    one = phase.PhaseFunction("sggx(kind=fibre,roughness=0.5)", incidence=(1, 0, 0))
    other = pickle.loads(pickle.dumps(one))
    assert other.spec == one.spec and phase.evaluate(other, 0.3) == phase.evaluate(one, 0.3)


@pytest.mark.parametrize("spec", [*SPECS[:10], "mie(m=1.33+1e-5i,x=10)"])
def test_figures_are_those_of_the_command(spec: str, answer: Callable[..., str]) -> None:
    told = json.loads(answer("phase", spec, "--json"))
    angles = np.radians(told["angles_deg"])
    assert phase.mean_cosine(spec) == told["g"]
    assert np.allclose(phase.evaluate(spec, np.cos(angles)), told["values"], rtol=1e-12)
    if "q_ext" in told:
        sphere = phase.mie(x=10, m=1.33 + 1e-5j)
        assert [sphere.q_ext, sphere.q_sca, sphere.q_back] == [told[key] for key in ("q_ext", "q_sca", "q_back")]


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: phase.evaluate("hg(g=2)", 0), "hg(g=2)"),
        (lambda: phase.evaluate("hgg:0.3", 0), "hgg"),
        (lambda: phase.evaluate(3, 0), "one line such as"),  # type: ignore[arg-type]
        (lambda: phase.evaluate("isotropic", 30), "cos_theta: cosines are from -1 to 1"),
        (lambda: phase.evaluate("isotropic", float("nan")), "cos_theta"),
        (lambda: phase.evaluate("isotropic", "x"), "cos_theta: numbers are needed"),
        (lambda: phase.sample("isotropic"), "number n of samples"),
        (lambda: phase.sample("isotropic", -1), "n: a whole number"),
        (lambda: phase.sample("isotropic", u=1.0), "u: random numbers"),
        (lambda: phase.sample_directions("isotropic", [0, 0, 0], [0, 0]), "before: a direction has no length"),
        (lambda: phase.sample_directions("isotropic", [0, 1], [0, 0]), "before: the last axis must have 3"),
        (lambda: phase.evaluate_directions("isotropic", np.ones((2, 3)), np.ones((4, 3))), "do not broadcast"),
        (lambda: phase.mie(x=1), "one of `m` and `material`"),
        (lambda: phase.mie(m=1.3), "one of `x`, `radius_um` and `distribution`"),
        (lambda: phase.mie(m=1.3, radius_um=1), "`wavelength_nm` is needed"),
        (lambda: phase.mie(m="1.3+", x=1), "m: complex numbers"),
        (lambda: phase.mie(m=1.3, x=1e9), "size"),
        (lambda: phase.mie(m=1.3, x=np.nan), "size"),
        (lambda: phase.mie(m=[1, 2], x=[1, 2, 3]), "do not broadcast"),
        (lambda: phase.refractive_index("milk", 550), "there is no `milk`; there is `water`"),
        (lambda: phase.PhaseFunction("rayleigh", incidence=(0, 0, 1)), "incidence: `rayleigh` does not depend on it"),
    ],
)
def test_mistakes_are_told_in_one_line(call: Callable[[], object], message: str) -> None:
    with pytest.raises(tyndall.Error) as caught:
        call()
    assert message in str(caught.value) and "\n" not in str(caught.value)
