"""Curves in files of other programs."""

from __future__ import annotations

from typing import TYPE_CHECKING, List, Mapping, NamedTuple, Optional, Tuple

from . import _core
from ._core import Curve
from ._parts import _file_name

if TYPE_CHECKING:
    from ._types import File


class CurveLoss(NamedTuple):
    """Something of a curve that was changed, since one side has no such thing."""

    curve: str  #: its name, or the channel
    message: str  #: one line: the thing, what became of it, how much the value changed
    is_exact: bool  #: the values of the curve are the same


class FileCurve(NamedTuple):
    """A curve of a file, in frames."""

    name: str  #: unique in the file, such as "Cube.location.z"
    group: str  #: without the component: "Cube.location"
    component: Optional[int]  #: 0 to 2, x to z; None: not a part of a vector
    unit: str  #: of the values: number, length or degrees
    curve: Curve  #: of numbers


class CurveFile(NamedTuple):
    """What a file of curves contains."""

    curves: Tuple[FileCurve, ...]  #: in the order of the file
    losses: Tuple[CurveLoss, ...]  #: what a `Curve` cannot hold
    fps: Optional[float]  #: of the file, if its curves are in frames [frames/s]


_core.register(CurveLoss=CurveLoss, FileCurve=FileCurve, CurveFile=CurveFile)


def read_curves(
    file: File, *, fps: float = 24, frame_at_zero: float = 1, rotate_order: str = "xyz",
    tolerance: float = 1e-4,
) -> CurveFile:  # fmt: skip
    """Reads curves of Blender (.json), Maya (.anim) or a glTF (.gltf, .glb).

    Seconds become frames by `fps`, and second 0 of a glTF is `frame_at_zero`. Quaternions become
    angles of `rotate_order`. Where curves are converted they change by `tolerance` of their range at
    most. Raises InvalidInput, with the line, and Unreadable; ValueError for a wrong argument.
    """
    return _core.read_curves(_file_name(file), fps, frame_at_zero, rotate_order, tolerance)


def write_curves(
    curves: Mapping[str, Curve], file: File, *, fps: float = 24, first: Optional[float] = None,
    last: Optional[float] = None, tolerance: float = 1e-4,
) -> List[CurveLoss]:  # fmt: skip
    """Writes curves, channel -> `Curve`, for Blender (.json), Maya (.anim) or as glTF (.gltf, .glb).

    The bytes are those of `pliant export curves`; angles of "NAME.rotate" are of the order xyz.
    Curves without end reach from the frame `first` to `last`, by default those of the keys. Returns
    what the format cannot hold. The file appears whole or not at all. Raises InvalidInput, naming
    the channel, and Unwritable; TypeError and ValueError for wrong arguments.
    """
    return _core.write_curves(dict(curves), _file_name(file), fps, first, last, tolerance)
