"""Arrays as they go to the library and come back: C-contiguous, 32-bit floats, vectors along the last axis."""

from __future__ import annotations

import ctypes
from typing import Any

import numpy as np

from . import native

UNIT_TOLERANCE = 1e-3


def vectors(name: str, values: Any, shape: tuple[int, ...] | None = None) -> np.ndarray:
    """An array of shape (..., 3). One vector stands for all when `shape`, that of the vectors' own axes, is given."""
    array = np.asarray(values, dtype=np.float32)
    if array.ndim == 0 or array.shape[-1] != 3:
        raise ValueError(f"{name}: an array of shape {array.shape} where (..., 3) is wanted")
    if shape is None:
        return np.ascontiguousarray(array)
    return spread(name, array, (*shape, 3))


def spread(name: str, values: Any, shape: tuple[int, ...]) -> np.ndarray:
    """An array of that shape, of numbers that may stand for several."""
    try:
        return np.ascontiguousarray(np.broadcast_to(np.asarray(values, dtype=np.float32), shape))
    except ValueError:
        raise ValueError(f"{name}: an array of shape {np.shape(values)} where {shape} is wanted") from None


def units(name: str, values: Any, shape: tuple[int, ...] | None = None) -> np.ndarray:
    """The same for unit vectors."""
    array = vectors(name, values, shape)
    squares = np.einsum("...i,...i", array, array)
    wrong = ~(np.abs(squares - 1) <= 2 * UNIT_TOLERANCE)
    if wrong.any():
        first = np.unravel_index(np.argmax(wrong), wrong.shape)
        where = f"[{', '.join(str(i) for i in first)}]" if first else ""
        raise ValueError(f"{name}{where} has a length of {np.sqrt(squares[first]):g}, not 1")
    return array


def pointer(array: np.ndarray, kind: type = native.Vec3) -> Any:
    """Where the array's numbers are."""
    return array.ctypes.data_as(ctypes.POINTER(kind))


def count(array: np.ndarray) -> int:
    """How many vectors there are; the library counts in 32 bits."""
    number = array.size // 3
    if number >= 2**32:
        raise ValueError(f"{number} at once are more than 2^32 - 1")
    return number
