"""Names of types, for annotations only."""

import os
from typing import Any, Callable, Iterable, Sequence, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike as ArrayLike
from numpy.typing import NDArray

from ._core import FolderStore, MemoryStore

File = Union[str, os.PathLike[str]]
Vector = Tuple[float, float, float]
Value = Union[float, Vector]
#: What a value may be given as.
Given = Union[float, Sequence[float], NDArray[Any]]
Floats = NDArray[np.float64]
Integers = NDArray[np.int32]
FrameRange = Tuple[int, int]
Store = Union[MemoryStore, FolderStore]
Progress = Callable[[int, int], object]
