"""Bad values of arguments: every argument of every public function is given what nobody means. It is refused by an exception
that names it, or the function does its work, and no number of the answer is NaN.
"""

from __future__ import annotations

import inspect
import math
import traceback
import warnings
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest
import tyndall
import tyndall.estimators
import tyndall.measure
import tyndall.phase

NAN, INFINITE = math.nan, math.inf

VALUES: list[Any] = [
    NAN, INFINITE, 0, -1, 1.5, 1e300, 1e-310, 2**70, True, "", "nan", "-1%", object(),
    [], [NAN] * 3, [0, 0, 0], (5, 2), (-1, 1), {}, np.array(["x"]),
]  # fmt: skip

BALL: dict[str, Any] = {
    "camera": {"position": [0, 0, 4], "target": [0, 0, 0], "vertical_fov": 35},
    "film": {"resolution": [5, 4]},
    "volume": [{"sphere": {"center": [0, 0, 0], "radius": 1}, "mu_t": 2, "albedo": 0.8}],
    "light": [{"type": "constant", "radiance": 1}],
}

FIELD: dict[str, Any] = {"density": np.ones((3, 4, 5)), "resolution": (5, 4)}
RAYS: dict[str, Any] = {"medium": BALL, "origins": [0, 0, 4], "directions": [0, 0, -1]}

CALLS: list[tuple[Callable[..., Any], dict[str, Any]]] = [
    (tyndall.render, {"scene": BALL, "spp": 1, "progress": False}),
    (tyndall.render_volume, {**FIELD, "spp": 1, "progress": False}),
    (tyndall.volume_scene, FIELD),
    (tyndall.TransferFunction, {"values": [0, 1], "extinction": [0, 1]}),
    (tyndall.phase.evaluate, {"spec": "hg(g=0.5)", "cos_theta": 0.5}),
    (tyndall.phase.mean_cosine, {"spec": "rayleigh"}),
    (tyndall.phase.sample, {"spec": "hg(g=0.5)", "n": 3}),
    (tyndall.phase.sample, {"spec": "hg(g=0.5)", "u": 0.5}),
    (tyndall.phase.evaluate_directions, {"spec": "rayleigh", "before": [0, 0, 1], "after": [1, 0, 0]}),
    (tyndall.phase.sample_directions, {"spec": "rayleigh", "before": [0, 0, 1], "u": [0.5, 0.5]}),
    (tyndall.phase.mie, {"x": 2.0, "m": 1.33 + 0j, "cos_theta": 0.5}),
    (tyndall.phase.mie, {"material": "water", "wavelength_nm": 550, "radius_um": 1}),
    (tyndall.phase.refractive_index, {"material": "water", "wavelength_nm": 550}),
    (tyndall.estimators.names, {}),
    (tyndall.estimators.properties, {}),
    (tyndall.estimators.transmittance, {**RAYS, "samples": 4}),
    (tyndall.estimators.sample_distance, {**RAYS, "samples": 4}),
    (tyndall.estimators.optical_thickness, RAYS),
    (tyndall.measure.slab, {"tau": 1, "albedo": 0.5, "samples": 50}),
    (tyndall.measure.flux, {
        "scene": {"camera": BALL["camera"], "volume": {"slab": {"bottom": 0, "top": 1}, "mu_t": 2, "albedo": 0.5}},
        "bottom": 0, "top": 1, "samples": 50,
    }),
    (tyndall.measure.meters, {
        "scene": {**BALL, "meter": [{"type": "radiance", "position": [0, 0, 4], "direction": [0, 0, -1]}]}, "samples": 50,
    }),
]  # fmt: skip


def numbers(answer: Any) -> Iterator[float]:
    """All numbers of an answer."""
    if isinstance(answer, tyndall.Render):
        yield from numbers([answer.image, answer.layers, answer.samples])
    elif isinstance(answer, dict):
        for value in answer.values():
            yield from numbers(value)
    elif isinstance(answer, (list, tuple)):
        for value in answer:
            yield from numbers(value)
    elif isinstance(answer, np.ndarray):
        yield from answer.ravel().view(float if answer.dtype == complex else answer.dtype).tolist()
    elif isinstance(answer, float):
        yield answer


@pytest.mark.parametrize(("function", "usual"), CALLS, ids=lambda value: getattr(value, "__name__", None))
def test_bad_values_are_refused_by_name_or_do_no_harm(function: Callable[..., Any], usual: dict[str, Any]) -> None:
    wrong = []
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        function(**usual)
        parameters = inspect.signature(function).parameters.values()
        for name in [one.name for one in parameters if one.kind is not one.VAR_KEYWORD]:
            for value in VALUES:
                wrong += judged(function, usual, name, value)
    assert not wrong, "\n".join(wrong)


def judged(function: Callable[..., Any], usual: dict[str, Any], name: str, value: Any) -> list[str]:
    """What is wrong about the way a value is treated."""
    call = f"{function.__name__}({name}={value!r})"
    try:
        answer = function(**{**usual, name: value})
    except (tyndall.Error, TypeError, OverflowError) as refusal:
        # With its notes, where the compiled part names arguments.
        said = "".join(traceback.format_exception_only(refusal))
        return [] if is_named(name, value, said) else [f"{call} does not name it: {said}"]
    except Exception as error:  # noqa: BLE001
        return [f"{call}: {type(error).__name__}: {error}"]
    if any(math.isnan(number) for number in numbers(answer) if isinstance(number, float)):
        return [f"{call}: NaN in the answer"]
    return []


OTHER_NAMES = {
    "x": ["size parameter"],
    "radius_um": ["size parameter"],
    "wavelength_nm": [" nm"],
    "spacing": ["position", "mu_t"],
    "origin": ["position"],
    "optical_thickness": ["mu_t", "dense"],
    "sampler": ["estimator"],
}
"""What messages call arguments that they do not name, or what follows from them."""


def is_named(name: str, value: Any, message: str) -> bool:
    """Whether a message says which argument it is about, or shows what is wrong."""
    # These are many things in one: the message names the part.
    if name in {"scene", "medium", "spec", "density", "material"}:
        return True
    names = [name, *OTHER_NAMES.get(name, [])]
    if isinstance(value, str) and value:
        names.append(value)
    return any(one in message for one in names)
