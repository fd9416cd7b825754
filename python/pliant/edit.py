"""The operations of a `SceneDocument`, each of one change of a scene file.

A path is `NAME.attribute`: the name of a surface, force, group or collider, or `scene`, and any
attribute of it, such as "sheet.columns" or "poke.center.x". A channel is the path of what has keys.
A value is a number, several numbers, True or False, or the text that a scene file has for it. Keys
are given as `{channel: [frames]}`, attributes as `{attribute: value}`. Operations are immutable.
"""

from __future__ import annotations

import inspect as _inspect
import math as _math
from typing import Any, Dict, List, NamedTuple, Tuple

import numpy as _np

from . import _core
from ._core import Curve as _Curve
from ._curves import _Frozen
from ._values import integer as _integer
from ._values import is_several as _is_several
from ._values import number as _real


class _Member(NamedTuple):
    """What a member of an operation is, as the library describes it."""

    name: str
    type: str
    meaning: str
    unit: str
    range: str
    words: Tuple[str, ...]
    is_required: bool
    standard: str  #: the default as JSON, or in parentheses what its absence means
    members: Tuple["_Member", ...]

    @property
    def snake(self) -> str:
        return "".join("_" + letter.lower() if letter.isupper() else letter for letter in self.name)


_core.register(Member=_Member)

# Members that hold a value of the format, which may be given as numbers.
_values = frozenset(
    ("value", "tangent", "length", "handle", "amplitude", "period", "back", "control")
)  # fmt: skip


def _is_one(value: Any) -> bool:
    return hasattr(value, "__float__") and not _is_several(value)


def _number(where: str, value: Any) -> float:
    if isinstance(value, (bool, _np.bool_)):
        raise TypeError(f"{where} must be a number, not {value!r}")
    number = _real(where, value)
    if not _math.isfinite(number):
        raise ValueError(f"{where} must be a finite number, not {number}")
    return number


def _list(where: str, value: Any, what: str) -> Tuple[Any, ...]:
    if isinstance(value, (str, bytes, dict, set, frozenset)) or not hasattr(value, "__iter__"):
        raise TypeError(f"{where} must be {what}, not {value!r}")
    return tuple(value)


def _text(where: str, value: Any) -> str:
    if not isinstance(value, str):
        raise TypeError(f"{where} must be a text, not {value!r}")
    return value


def _value_text(where: str, value: Any) -> str:
    """The text that a scene file has for a value."""
    if isinstance(value, str):
        return value
    if isinstance(value, (bool, _np.bool_)):
        return "true" if value else "false"
    if isinstance(value, _Curve):
        raise TypeError(f"{where} must be a constant; SetCurve takes a Curve")
    if _is_one(value):
        return _core.numbers_text([_number(where, value)])
    what = "a number, numbers, True, False or a text"
    parts = _list(where, value, what)
    if parts and all(isinstance(part, str) for part in parts):
        return " ".join(parts)
    return _core.numbers_text([_number(where, part) for part in parts])


def _pairs(where: str, value: Any, what: str) -> Tuple[Tuple[Any, Any], ...]:
    items = value.items() if hasattr(value, "items") else value
    pairs = tuple(tuple(_list(where, pair, what)) for pair in _list(where, items, what))
    if any(len(pair) != 2 for pair in pairs):
        raise ValueError(f"{where} must be {what}")
    return pairs  # type: ignore[return-value]


def _accepted(where: str, member: _Member, value: Any) -> Any:
    """The value as the operation keeps it. Raises TypeError or ValueError."""
    kind = member.type
    if kind == "text":
        return _value_text(where, value) if member.name in _values else _text(where, value)
    if kind == "number":
        return _number(where, value)
    if kind == "integer":
        return _integer(where, value)
    if kind == "boolean":
        if not isinstance(value, (bool, _np.bool_)):
            raise TypeError(f"{where} must be True or False, not {value!r}")
        return bool(value)
    if kind == "word":
        if _text(where, value) not in member.words:
            raise ValueError(f"{where} {value!r}: allowed: {', '.join(member.words)}")
        return value
    if kind == "texts":
        names = (value,) if isinstance(value, str) else _list(where, value, "a list of texts")
        return tuple(_text(where, name) for name in names)
    if kind == "numbers":
        if _is_one(value):
            return (_number(where, value),)
        return tuple(_number(where, each) for each in _list(where, value, "a list of numbers"))
    if kind == "curve":
        if not isinstance(value, _Curve):
            raise TypeError(f"{where} must be a Curve, not {value!r}")
        return value
    first, second = member.members
    what = f"{{{first.name}: {second.name}}}"
    return tuple(
        (_accepted(where, first, key), _given(where, second, given))
        for key, given in _pairs(where, value, what)
    )


def _given(where: str, member: _Member, value: Any) -> Any:
    if member.type == "numbers" and not _is_one(value):
        return tuple(_number(where, each) for each in _list(where, value, "a list of frames"))
    return _accepted(where, member, value)


def _default(member: _Member) -> Any:
    if member.type in ("texts", "numbers", "objects"):
        return ()
    if member.standard.startswith("("):
        return None
    import json

    return json.loads(member.standard)


class Operation(_Frozen):
    """What `SceneDocument.apply` takes."""

    __slots__ = ()
    _name = ""
    _members: Tuple[_Member, ...] = ()

    def __init__(self, *given: Any, **named: Any):
        try:
            bound = self.__signature__.bind(*given, **named)  # type: ignore[attr-defined]
        except TypeError as error:
            raise TypeError(f"{type(self).__name__}: {error}") from None
        for member in self._members:
            value = bound.arguments.get(member.snake)
            if member.snake not in bound.arguments or (value is None and not member.is_required):
                value = _default(member)
            else:
                value = _accepted(f"{type(self).__name__}.{member.snake}", member, value)
            object.__setattr__(self, member.snake, value)

    def __repr__(self) -> str:
        shown: List[str] = []
        for member in self._members:
            value = getattr(self, member.snake)
            if member.is_required:
                shown.append(repr(value))
            elif value != _default(member):
                shown.append(f"{member.snake}={value!r}")
        return f"{type(self).__name__}({', '.join(shown)})"

    def _json(self) -> Dict[str, Any]:
        """As `parse_operations` takes it."""
        json: Dict[str, Any] = {"op": self._name}
        for member in self._members:
            value = getattr(self, member.snake)
            if member.is_required or value != _default(member):
                json[member.name] = self._json_of(member, value)
        return json

    def _json_of(self, member: _Member, value: Any) -> Any:
        if member.type == "curve":
            return _core.curve_text(value, getattr(self, "channel"))
        if member.type == "objects":
            first, second = member.members
            return [{first.name: key, second.name: given} for key, given in value]
        return value


def _made(name: str, meaning: str, members: Tuple[_Member, ...]) -> type:
    title = name[:1].upper() + name[1:]
    # Python's order of arguments: those with a default come last.
    members = tuple(sorted(members, key=lambda member: not member.is_required))
    lines = []
    parameters = []
    for member in members:
        what = {"texts": "texts", "objects": "a dict", "curve": "a Curve"}.get(member.type, member.type)
        if member.type == "text" and member.name in _values:
            what = "a value"
        facts = [" or ".join(member.words) or what]
        facts += [f"[{member.unit}]"] * bool(member.unit) + [member.range] * bool(member.range)
        if not member.is_required:
            facts.append(f"default {member.standard.strip('()') or '()'}")
        told = "the `Curve`" if member.type == "curve" else member.meaning
        lines.append(f"    {member.snake}: {told} ({', '.join(facts)})")
        default = _inspect.Parameter.empty if member.is_required else _default(member)
        kind = _inspect.Parameter.POSITIONAL_OR_KEYWORD
        parameters.append(_inspect.Parameter(member.snake, kind, default=default))
    return type(
        title,
        (Operation,),
        {
            "__slots__": tuple(member.snake for member in members),
            "__module__": __name__,
            "__doc__": "\n".join([meaning, "", *lines]) + "\n",
            "__signature__": _inspect.Signature(parameters),
            "_name": name,
            "_members": members,
        },
    )


__all__ = ["Operation"]
for _format in _core.operation_formats():
    _class = _made(*_format)
    globals()[_class.__name__] = _class
    __all__.append(_class.__name__)
del _format, _class


def _json_text(operations: Tuple[Any, ...]) -> str:
    import json

    for operation in operations:
        if not isinstance(operation, Operation):
            raise TypeError(f"an operation must be one of pliant.edit, not {operation!r}")
    return json.dumps([operation._json() for operation in operations], ensure_ascii=False)


del annotations, Any, Dict, List, NamedTuple, Tuple
