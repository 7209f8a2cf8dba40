"""Arrays on their way to Rust: broadcast, contiguous, and refused in one line that names the argument."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tyndall._errors import Error

Floats = NDArray[np.float64]


def floats(name: str, value: ArrayLike) -> Floats:
    """The numbers of `value` as an array of any shape.

    >>> floats("x", [1, 2])
    array([1., 2.])
    >>> floats("x", "one")
    Traceback (most recent call last):
    tyndall._errors.Error: x: numbers are needed, not 'one'
    """
    try:
        array = np.asarray(value)
        if array.dtype.kind not in "biuf":
            raise TypeError
        return array.astype(np.float64, copy=False)
    except (TypeError, ValueError):
        shown = repr(value)
        raise Error(f"{name}: numbers are needed, not {shown[:60]}") from None


def broadcast(**arrays: ArrayLike) -> list[Floats]:
    """The arrays, by name, in their common shape.

    >>> [a.shape for a in broadcast(tau=[1, 2, 3], albedo=0.9)]
    [(3,), (3,)]
    """
    given = {name: floats(name, value) for name, value in arrays.items()}
    try:
        return [np.array(array, order="C") for array in np.broadcast_arrays(*given.values())]
    except ValueError:
        shapes = ", ".join(f"{name} {array.shape}" for name, array in given.items() if array.ndim)
        raise Error(f"the shapes do not broadcast: {shapes}") from None


def cosines(name: str, value: ArrayLike) -> Floats:
    """Cosines, each from -1 to 1 but for rounding."""
    array = floats(name, value)
    if not np.all(np.abs(array) <= 1 + 1e-12):
        raise Error(f"{name}: cosines are from -1 to 1; take the cosine of the angle")
    return np.clip(array, -1.0, 1.0)


def vectors(name: str, value: ArrayLike) -> Floats:
    """Finite vectors as an array whose last axis is x, y, z."""
    array = floats(name, value)
    if array.ndim == 0 or array.shape[-1] != 3:
        raise Error(f"{name}: the last axis must have 3 components, x, y, z; the shape is {array.shape}")
    if not np.all(np.isfinite(array)):
        raise Error(f"{name}: all components must be finite")
    return array


def directions(name: str, value: ArrayLike) -> Floats:
    """Vectors of unit length along those given."""
    array = vectors(name, value)
    # Of greatest component 1 first, so that no square overflows or vanishes.
    greatest = np.max(np.abs(array), axis=-1, keepdims=True)
    if not np.all(greatest > 0):
        raise Error(f"{name}: a direction has no length")
    array = array / greatest
    return np.asarray(array / np.linalg.norm(array, axis=-1, keepdims=True))


def broadcast_rows(**arrays: Floats) -> list[Floats]:
    """Arrays of rows, broadcast but for their last axes."""
    try:
        shape = np.broadcast_shapes(*(array.shape[:-1] for array in arrays.values()))
    except ValueError:
        shapes = ", ".join(f"{name} {array.shape}" for name, array in arrays.items())
        raise Error(f"the shapes do not broadcast: {shapes}") from None
    return [np.broadcast_to(array, shape + array.shape[-1:]) for array in arrays.values()]


def rows(array: Floats) -> Floats:
    """The same as a contiguous table."""
    return np.ascontiguousarray(array.reshape(-1, array.shape[-1]))


def number(name: str, value: Any) -> float:
    """A single number that is finite.

    >>> number("g", 1)
    1.0
    >>> number("g", [1, 2])
    Traceback (most recent call last):
    tyndall._errors.Error: g: a number is needed, not [1, 2]
    """
    try:
        array = floats(name, value)
    except Error:
        array = np.empty(0)
    if array.ndim == 0 and np.isfinite(array):
        return float(array)
    raise Error(f"{name}: a number is needed, not {repr(value)[:60]}")


def pair(name: str, value: Any) -> tuple[Any, Any]:
    """Two of a kind.

    >>> pair("view", [30, 10])
    (30, 10)
    """
    try:
        first, second = value
    except (TypeError, ValueError):
        raise Error(f"{name}: two numbers are needed, not {repr(value)[:60]}") from None
    return first, second


def whole(name: str, value: Any, least: int, greatest: int) -> int:
    """A whole number within its limits."""
    try:
        number = int(value)
        if number == value and least <= number <= greatest:
            return number
    except (TypeError, ValueError, OverflowError):
        pass
    raise Error(f"{name}: a whole number from {least} to {greatest} is needed, not {value!r}")
