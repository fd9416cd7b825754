"""What is taken as a number, several or an array of them, and what is said of all else."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Callable, Tuple

import numpy as np

from . import _core


def number(where: str, value: Any) -> float:
    """A real number, also a NumPy scalar, an array of no dimension or what has `__float__`."""
    if isinstance(value, (np.ndarray, np.generic)):
        is_number = value.ndim == 0 and value.dtype.kind in "fiub"
    else:
        is_number = hasattr(value, "__float__") or hasattr(value, "__index__")
    try:
        if is_number:
            return float(value)
    except OverflowError:
        raise ValueError(f"{where} is too large for a number") from None
    except (TypeError, ValueError):
        pass
    raise TypeError(f"{where} must be a number, not {value!r}")


def whole(where: str, value: Any, least: int, most: int) -> int:
    """A whole number from `least` to `most`."""
    if isinstance(value, (bool, np.bool_)) or not hasattr(value, "__index__"):
        raise TypeError(f"{where} must be a whole number, not {value!r}")
    own = int(value.__index__())
    if not least <= own <= most:
        raise ValueError(f"{where}={own}: must be {least} to {most}")
    return own


def integer(where: str, value: Any) -> int:
    """A whole number that the library has room for."""
    return whole(where, value, -(2**31), 2**31 - 1)


def unless_none(accept: Callable[[str, Any], Any], where: str, value: Any) -> Any:
    """None, or the value as `accept` makes it."""
    return None if value is None else accept(where, value)


def is_several(value: Any) -> bool:
    """Whether it has elements; else it may be a number."""
    return hasattr(value, "__len__") and not (isinstance(value, np.ndarray) and value.ndim == 0)


def vector(where: str, value: Any, *counts: int) -> Tuple[float, ...]:
    """So many numbers in their order."""
    wanted = " or ".join(map(str, counts))
    if not is_several(value) or isinstance(value, (str, bytes, Mapping)) or not hasattr(value, "__getitem__"):
        raise TypeError(f"{where} must be {wanted} numbers, not {value!r}")
    if len(value) not in counts:
        raise ValueError(f"{where} must have {wanted} numbers, not {len(value)}")
    return tuple(number(where, each) for each in value)


def array(where: str, value: Any) -> "np.ndarray[Any, Any]":
    """A read-only copy of an array of numbers."""
    wrong = TypeError(f"{where} must be an array of numbers")
    try:
        given = np.asarray(value)
    except ValueError:  # rows of different lengths
        raise wrong from None
    if given.dtype.kind == "O":
        try:
            given = np.reshape([number(where, each) for each in given.flat], given.shape)
        except TypeError:
            raise wrong from None
    if given.dtype.kind not in "fiub":
        raise wrong
    made = np.array(given, dtype=np.float64, order="C")
    made.flags.writeable = False
    return made


_core.register(number=number, vector=vector, array=array)
