"""Keys of curves, which the core compiles."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple, Optional, Sequence, Tuple, Union

from . import _core
from ._core import Curve, Path
from ._values import integer, is_several, number, vector

if TYPE_CHECKING:
    from ._types import Given, Value


class _Frozen:
    """What has slots for the arguments it is made of, and does not change."""

    __slots__: Tuple[str, ...] = ()

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError(f"{type(self).__name__} is immutable; make another one")

    __delattr__ = __setattr__  # type: ignore[assignment]

    def _values(self) -> Tuple[Any, ...]:
        return tuple(getattr(self, name) for name in self.__slots__)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, _Frozen) or type(other) is not type(self):
            return NotImplemented
        return bool(self._values() == other._values())

    def __hash__(self) -> int:
        return hash(self._values())

    def __reduce__(self) -> Tuple[Any, ...]:
        return _remade, (type(self), self._values())


def _remade(cls: Any, values: Tuple[Any, ...]) -> Any:
    made = cls.__new__(cls)
    for name, value in zip(cls.__slots__, values):
        object.__setattr__(made, name, value)
    return made


def _value(name: str, value: Any) -> Value:
    return vector(name, value, 3) if is_several(value) else number(name, value)  # type: ignore[return-value]


class Key(_Frozen):
    """One key of a curve: the value at a frame, and how the curve goes on to the next one.

    `value` is a number or three. `interpolation` is a word of the format, such as bezier, linear,
    step or quadInOut; `amplitude`, `period` [frames], `back` and `control` belong to some of them. A
    tangent is a word, such as auto, flat or spline, or the slope [unit/frame]; `tangent` stands for
    both. A length is in frames; a handle is `(frames, value)` or `(frames, x, y, z)`, relative to the
    key. `left` is the value from the left, where the curve jumps. Immutable.
    """

    __slots__ = (
        "frame", "value", "interpolation", "tangent", "in_tangent", "out_tangent", "in_length",
        "out_length", "in_handle", "out_handle", "left", "amplitude", "period", "back", "control",
    )  # fmt: skip

    frame: float
    value: Value
    interpolation: str
    tangent: Union[None, str, Value]
    in_tangent: Union[str, Value]
    out_tangent: Union[str, Value]
    in_length: Optional[float]
    out_length: Optional[float]
    in_handle: Optional[Tuple[float, ...]]
    out_handle: Optional[Tuple[float, ...]]
    left: Optional[Value]
    amplitude: Optional[float]
    period: Optional[float]
    back: Optional[float]
    control: Optional[Tuple[float, ...]]

    def __init__(
        self, frame: float, value: Given, *, interpolation: str = "bezier", tangent: Union[None, str, Given] = None,
        in_tangent: Union[str, Given] = "auto", out_tangent: Union[str, Given] = "auto",
        in_length: Optional[float] = None, out_length: Optional[float] = None, in_handle: Optional[Sequence[float]] = None,
        out_handle: Optional[Sequence[float]] = None, left: Optional[Given] = None,
        amplitude: Optional[float] = None, period: Optional[float] = None,
        back: Optional[float] = None, control: Optional[Sequence[float]] = None,
    ):  # fmt: skip
        def put(name: str, value: Any) -> None:
            object.__setattr__(self, name, value)

        put("frame", number("frame", frame))
        put("value", _value("value", value))
        if not isinstance(interpolation, str):
            raise TypeError(f"interpolation must be a word, not {interpolation!r}")
        put("interpolation", interpolation)
        for name, given in (("tangent", tangent), ("in_tangent", in_tangent), ("out_tangent", out_tangent)):
            is_plain = isinstance(given, str) or (given is None and name == "tangent")
            put(name, given if is_plain else _value(name, given))
        for name, given in (
            ("in_length", in_length), ("out_length", out_length), ("amplitude", amplitude),
            ("period", period), ("back", back),
        ):  # fmt: skip
            put(name, None if given is None else number(name, given))
        for name, given in (("in_handle", in_handle), ("out_handle", out_handle)):
            put(name, None if given is None else vector(name, given, 2, 4))
        put("left", None if left is None else _value("left", left))
        put("control", None if control is None else vector("control", control, 4))

    def __repr__(self) -> str:
        standard = {"interpolation": "bezier", "in_tangent": "auto", "out_tangent": "auto"}
        more = "".join(
            f", {name}={getattr(self, name)!r}"
            for name in self.__slots__[2:]
            if getattr(self, name) != standard.get(name)
        )
        return f"Key({self.frame:g}, {self.value!r}{more})"


class Loop(_Frozen):
    """An inner loop: the keys in [from_, to) are repeated `before` and `after` times.

    `from_` is the frame of a key. Each copy is moved by `offset`, a number or three. Immutable.
    """

    __slots__ = ("from_", "to", "before", "after", "offset")

    from_: float
    to: float
    before: int
    after: int
    offset: Value

    def __init__(self, from_: float, to: float, *, before: int = 0, after: int = 0, offset: Given = 0):
        for name, given in (("from_", from_), ("to", to)):
            object.__setattr__(self, name, number(name, given))
        for name, given in (("before", before), ("after", after)):
            object.__setattr__(self, name, integer(name, given))
        object.__setattr__(self, "offset", _value("offset", offset))

    def __repr__(self) -> str:
        more = "".join(f", {name}={getattr(self, name)!r}" for name in self.__slots__[2:] if getattr(self, name))
        return f"Loop({self.from_:g}, {self.to:g}{more})"


class Handle(NamedTuple):
    """A handle of a Bézier segment: from its key to the tip, a control point of the cubic."""

    key_frame: float
    key_value: Value
    frame: float
    value: Value


def _make_curve(
    keys: Any, before: str, after: str, overshoot: str, loop: Optional[Loop], adjusting: Any
) -> Curve:
    curve = Curve(keys, before=before, after=after, overshoot=overshoot, loop=loop)
    return curve if adjusting is None else curve._adjusted(adjusting)


def _make_path(waypoints: Any, closed: bool, progress: Any, adjusting: Any) -> Path:
    path = Path(waypoints, closed=closed, progress=progress)
    return path if adjusting is None else path._adjusted(adjusting)


_core.register(value=_value, Key=Key, Loop=Loop, Handle=Handle, make_curve=_make_curve, make_path=_make_path)
