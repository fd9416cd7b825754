"""The parts of scenes: plain objects, whose attributes are the rows of the format's description."""

from __future__ import annotations

import copy
import inspect
import keyword
import os
from typing import Any, Dict, Iterator, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from . import _core, _values
from ._core import Curve, Mesh, Path


class Row(NamedTuple):
    """What an attribute is, as the format describes it."""

    name: str
    attribute: str  #: its name in a scene file
    kind: str
    is_optional: bool
    words: Tuple[str, ...]
    standard: Any  #: the default
    unit: str
    range: str
    meaning: str
    absent: str  #: what None means
    is_required: bool

    def fresh(self) -> Any:
        """The default, as an object of its own if it can be changed."""
        if self.kind == "parts":
            return list(self.standard)
        return copy.copy(self.standard) if isinstance(self.standard, Part) else self.standard

    def told(self) -> str:
        """A line of a docstring."""
        facts = [self.kind if not self.words else " or ".join(self.words)]
        facts += [f"[{self.unit}]"] * bool(self.unit) + [self.range] * bool(self.range)
        if not self.is_required:
            standard = self.absent if self.standard in (None, "", ()) and self.absent else repr(self.standard)
            facts.append(f"default {standard}")
        return f"    {self.name}: {self.meaning} ({', '.join(facts)})"


_core.register(Row=Row)
_table: Dict[str, Tuple[str, Dict[str, Row]]] = _core.table()


def _path_text(path: Any) -> str:
    text = os.fsdecode(os.fspath(path))
    if "\0" in text:
        raise ValueError(f"a path must not have a NUL: {text!r}")
    return text


def _file_name(path: Any) -> bytes:
    """The bytes of a file's name, for the core: not all names are texts."""
    return os.fsencode(_path_text(path))


_core.register(file_name=_file_name)


class _Accept:
    """What each kind of attribute takes: the value as it is read back, or TypeError or ValueError."""

    number = staticmethod(_values.number)
    integer = staticmethod(_values.integer)

    @staticmethod
    def unsigned_integer(where: str, value: Any) -> int:
        return _values.whole(where, value, 0, 2**64 - 1)

    @staticmethod
    def boolean(where: str, value: Any) -> bool:
        if not isinstance(value, (bool, np.bool_)):
            raise TypeError(f"{where} must be True or False, not {value!r}")
        return bool(value)

    @staticmethod
    def text(where: str, value: Any) -> str:
        if not isinstance(value, str):
            raise TypeError(f"{where} must be a text, not {value!r}")
        return value

    @staticmethod
    def path(where: str, value: Any) -> str:
        if not isinstance(value, (str, os.PathLike)):
            raise TypeError(f"{where} must be a path, not {value!r}")
        return _path_text(value)

    @staticmethod
    def names(where: str, value: Any) -> Tuple[str, ...]:
        names = (value,) if isinstance(value, str) else value
        try:
            names = tuple(names)
        except TypeError:
            raise TypeError(f"{where} must be names, not {value!r}") from None
        return tuple(_Accept.text(where, name) for name in names)

    @staticmethod
    def integers(where: str, value: Any) -> Tuple[int, ...]:
        try:
            numbers = tuple(value)
        except TypeError:
            raise TypeError(f"{where} must be whole numbers, not {value!r}") from None
        return tuple(_Accept.integer(where, number) for number in numbers)

    @staticmethod
    def vector(where: str, value: Any) -> Tuple[float, ...]:
        return _values.vector(where, value, 3)

    @staticmethod
    def pair(where: str, value: Any) -> Tuple[float, ...]:
        if not _values.is_several(value):
            return (_values.number(where, value),) * 2
        return _values.vector(where, value, 2)

    @staticmethod
    def _curve(where: str, value: Curve, dimension: int) -> Curve:
        if value.dimension != dimension:
            raise ValueError(f"{where} needs a curve of {dimension} component(s), not {value.dimension}")
        return value

    @staticmethod
    def channel(where: str, value: Any) -> Any:
        return _Accept._curve(where, value, 1) if isinstance(value, Curve) else _Accept.number(where, value)

    @staticmethod
    def vector_channel(where: str, value: Any) -> Any:
        return _Accept._curve(where, value, 3) if isinstance(value, Curve) else _Accept.vector(where, value)

    @staticmethod
    def switch(where: str, value: Any) -> Any:
        if not isinstance(value, Curve):
            return _Accept.boolean(where, value)
        try:
            stepped = value._stepped()
        except ValueError as error:
            raise ValueError(f"{where}: {error}") from None
        return value if value == stepped else stepped

    @staticmethod
    def position(where: str, value: Any) -> Any:
        return value if isinstance(value, Path) else _Accept.vector_channel(where, value)

    @staticmethod
    def tangent(where: str, value: Any) -> Any:
        if isinstance(value, Curve):
            return value
        return _Accept.vector(where, value) if _values.is_several(value) else _values.number(where, value)

    @staticmethod
    def cache(where: str, value: Any) -> Any:
        if isinstance(value, (str, os.PathLike)):
            return _Accept.path(where, value)
        samples = _values.array(where, value)
        if samples.ndim != 3 or samples.shape[2] != 3 or len(samples) == 0:
            raise ValueError(f"{where} must have the shape (samples, V, 3), not {samples.shape}")
        return samples

    @staticmethod
    def values(where: str, value: Any) -> Any:
        values = _values.array(where, value)
        if values.ndim not in (1, 2):
            raise ValueError(f"{where} must have the shape (rows, columns) or (V,), not {values.shape}")
        return values

    @staticmethod
    def knots(where: str, value: Any) -> Any:
        knots = _values.array(where, value)
        if knots.ndim != 1:
            raise ValueError(f"{where} must have the shape (n,), not {knots.shape}")
        return knots


def _word(where: str, row: Row, value: Any) -> str:
    if not isinstance(value, str):
        raise TypeError(f"{where} must be a word, not {value!r}")
    if value not in row.words:
        raise ValueError(f"{where}={value!r}: allowed: {', '.join(row.words)}")
    return value


def _accepted(where: str, row: Row, value: Any) -> Any:
    if value is None and row.is_optional:
        return None
    if row.kind == "word":
        return _word(where, row, value)
    if row.kind == "falloff":
        return _Accept.channel(where, value) if isinstance(value, Curve) else _word(where, row, value)
    if row.kind == "edges":
        words = (value,) * 4 if isinstance(value, str) else value
        if not hasattr(words, "__len__"):
            raise TypeError(f"{where} must be one word or four, not {value!r}")
        if len(words) != 4:
            raise ValueError(f"{where} must have one word or four, not {len(words)}")
        return tuple(_word(where, row, word) for word in words)
    return getattr(_Accept, row.kind.replace(" ", "_"))(where, value)


def _is_equal(a: Any, b: Any) -> bool:
    if isinstance(a, np.ndarray) or isinstance(b, np.ndarray):
        return (
            isinstance(a, np.ndarray) and isinstance(b, np.ndarray)
            and a.shape == b.shape and bool(np.array_equal(a, b))
        )  # fmt: skip
    return bool(a == b)


def _is_same_file(a: Any, b: Any) -> bool:
    return isinstance(a, str) and isinstance(b, str) and bool(a and b) and os.path.abspath(a) == os.path.abspath(b)


def _is_equal_row(row: Row, a: Any, b: Any) -> bool:
    return _is_equal(a, b) or ((row.kind == "path" or row.name == "cache") and _is_same_file(a, b))


class _Signature:
    """The arguments of a class, made when somebody asks."""

    def __get__(self, part: Any, cls: Any) -> inspect.Signature:
        kind = inspect.Parameter
        arguments = [
            kind(row.name, kind.POSITIONAL_OR_KEYWORD if row.name in cls._positional else kind.KEYWORD_ONLY,
                 default=kind.empty if row.is_required else row.standard)
            for row in sorted(cls._rows.values(), key=lambda row: row.name not in cls._positional)
        ]  # fmt: skip
        return inspect.Signature(arguments)


class Part:
    """A part of a scene: its attributes are those of the format, and may be changed at any time.

    A wrong type is a TypeError at once, a wrong word or number of components a ValueError, an unknown
    attribute an AttributeError; ranges and references are checked when the scene is.
    """

    _rows: Dict[str, Row] = {}
    _positional: Tuple[str, ...] = ()
    _lists: Dict[str, type] = {}  # of what its lists are
    _is_common = True
    __signature__ = _Signature()
    __hash__ = None  # type: ignore[assignment]

    def __init_subclass__(cls, rows: str = "", more: Sequence[Row] = (), without: Sequence[str] = (), **extra: Any):
        super().__init_subclass__(**extra)
        meaning = ""
        if rows:
            cls._is_common = False
            meaning, table = _table[rows]
            table = {name: row for name, row in table.items() if name not in without}
            cls._rows = {**table, **{row.name: row for row in more}}
        lines = [row.told() for row in cls._rows.values()]
        cls.__doc__ = "\n".join([cls.__doc__ or meaning, *["", "Attributes:", *lines] * bool(lines)])

    def __init__(self, *positional: Any, **values: Any):
        cls = type(self)
        if cls._is_common:
            raise TypeError(f"{cls.__name__} is what several classes have in common; make one of those")
        if len(positional) > len(cls._positional):
            raise TypeError(f"{cls.__name__} takes {len(cls._positional)} positional arguments, not {len(positional)}")
        given = dict(zip(cls._positional, positional))
        for name in values:
            if name in given:
                raise TypeError(f"{cls.__name__}: {name} is given twice")
            if name not in cls._rows:
                raise TypeError(f"{cls.__name__} has no attribute {name!r}{_nearest(name, cls._rows)}")
        given.update(values)
        for name, row in cls._rows.items():
            if row.is_required and name not in given:
                raise TypeError(f"{cls.__name__} needs {name}")
        for name, row in cls._rows.items():
            if name in given:
                setattr(self, name, given[name])
            else:
                self.__dict__[name] = row.fresh()

    def _where(self, name: str) -> str:
        return f"{type(self).__name__}.{name}"

    def __setattr__(self, name: str, value: Any) -> None:
        row = self._rows.get(name)
        if row is None:
            raise AttributeError(f"{type(self).__name__} has no attribute {name!r}{_nearest(name, self._rows)}")
        self.__dict__[name] = self._accept(row, value)

    def __delattr__(self, name: str) -> None:
        raise AttributeError(f"{self._where(name)} cannot be deleted")

    def _accept(self, row: Row, value: Any) -> Any:
        if row.kind == "parts":
            if isinstance(value, (str, Part)) or not hasattr(value, "__iter__"):
                raise TypeError(f"{self._where(row.name)} must be a list of parts, not {value!r}")
            return self._checked(row.name, list(value))
        return _accepted(self._where(row.name), row, value)

    def _checked(self, name: str, parts: List[Any]) -> List[Any]:
        for part in parts:
            if not isinstance(part, self._lists[name]):
                raise TypeError(f"{self._where(name)} must contain {self._lists[name].__name__} only, not {part!r}")
        return parts

    def _list(self, name: str) -> List[Any]:
        """The parts that a list has now."""
        return self._checked(name, list(self.__dict__[name]))

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        return all(
            _is_equal_row(row, self.__dict__[name], other.__dict__[name]) for name, row in self._rows.items()
        )

    def __setstate__(self, state: Dict[str, Any]) -> None:
        for value in state.values():
            if isinstance(value, np.ndarray):
                value.flags.writeable = False
        self.__dict__.update(state)

    def __repr__(self) -> str:
        cls = type(self)
        shown = [_short(self.__dict__[name]) for name in cls._positional if name in self.__dict__]
        shown += [
            f"{name}={_short(self.__dict__[name])}"
            for name, row in cls._rows.items()
            if name not in cls._positional and not _is_equal(self.__dict__[name], row.standard)
            and not (row.kind == "parts" and not self.__dict__[name])
        ][:6]  # fmt: skip
        return f"{cls.__name__}({', '.join(shown)})"


def _short(value: Any) -> str:
    if isinstance(value, np.ndarray):
        return f"<array {value.shape}>"
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "…"


def _nearest(name: str, names: Any) -> str:
    import difflib

    near = difflib.get_close_matches(name, list(names), 1)
    return f"; did you mean {near[0]!r}?" if near else ""


def _own(name: str, kind: str, standard: Any, meaning: str, is_optional: bool = False) -> Row:
    """A row that the description of the format does not have."""
    return Row(name, name, kind, is_optional, (), standard, "", "", meaning, "", False)


class Grid(Part, rows="Grid"):
    _positional = ("columns", "rows")


class MeshFile(Part, rows="MeshFile"):
    _positional = ("file",)


class Subdivision(Part, rows="Subdivision"):
    pass


_wrap_words = _table["Surface"][1]["wrap"].words


class Nurbs(
    Part,
    rows="Nurbs",
    without=("columns", "rows"),
    more=(
        _own("points", "net", None, "control points, (rows, columns, 3) [length]")._replace(is_required=True),
        _own("weights", "net weights", None, "one > 0 for each control point, (rows, columns)", True),
        _own("knots_u", "knots", None, "knots along u", True),
        _own("knots_v", "knots", None, "knots along v", True),
        _own("wrap", "word", "none", "the closed directions")._replace(words=_wrap_words),
    ),
):
    """A NURBS surface of control points `points`, (rows, columns, 3)."""

    _positional = ("points",)

    def _accept(self, row: Row, value: Any) -> Any:
        where = self._where(row.name)
        if row.kind == "net":
            points = _values.array(where, value)
            if points.ndim != 3 or points.shape[2] != 3:
                raise ValueError(f"{where} must have the shape (rows, columns, 3), not {points.shape}")
            return points
        if row.kind == "net weights" and value is not None:
            weights = _values.array(where, value)
            shape = self.__dict__["points"].shape[:2] if "points" in self.__dict__ else None
            if shape and weights.size != shape[0] * shape[1]:
                raise ValueError(f"{where} must have the shape {shape}, not {weights.shape}")
            return _values.array(where, weights.reshape(shape)) if shape else weights
        return None if value is None and row.kind == "net weights" else super()._accept(row, value)


_map_values = _own(
    "values",
    "values",
    None,
    "m at each node of a grid or each point of a net (rows, columns), or at each vertex of a mesh (V,)",
    True,
)


class Map(Part, rows="Map", more=(_map_values,)):
    _positional = ("channel",)


class Hold(Part, rows="Hold", more=(_map_values,)):
    pass


class _Shaped(Part):
    """What has a shape."""

    _shapes: Tuple[type, ...] = ()

    def _accept(self, row: Row, value: Any) -> Any:
        if row.kind == "shape":
            if not isinstance(value, self._shapes):
                names = ", ".join(shape.__name__ for shape in self._shapes)
                raise TypeError(f"{self._where('shape')} must be one of {names}, not {value!r}")
            return value
        if row.kind == "subdivision":
            if value is not None and not isinstance(value, Subdivision):
                raise TypeError(f"{self._where('subdivision')} must be a Subdivision or None, not {value!r}")
            return value
        if row.name == "cache":
            return _Accept.cache(self._where("cache"), value)
        return super()._accept(row, value)


class Surface(
    _Shaped,
    rows="Surface",
    more=(
        _own("shape", "shape", Grid(3, 3), "Grid, MeshFile, Mesh or Nurbs"),
        _own("maps", "parts", (), "`Map`s of the material"),
        _own("holds", "parts", (), "`Hold`s"),
        _own("subdivision", "subdivision", None, "a `Subdivision`: the mesh is a cage", True),
    ),
):
    _positional = ("name",)
    _lists = {"maps": Map, "holds": Hold}
    _shapes = (Grid, MeshFile, Mesh, Nurbs)


class Sphere(Part, rows="Sphere"):
    pass


class Capsule(Part, rows="Capsule"):
    pass


class Box(Part, rows="Box"):
    pass


class Plane(Part, rows="Plane"):
    pass


class Collider(
    _Shaped, rows="Collider",
    more=(_own("shape", "shape", Sphere(), "Sphere, Capsule, Box, Plane, MeshFile or Mesh"),),
):  # fmt: skip
    _positional = ("name",)
    _shapes = (Sphere, Capsule, Box, Plane, MeshFile, Mesh)


class Force(Part):
    """What all kinds of forces have in common."""

    _positional = ("name",)

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        own, others = self.__dict__, other.__dict__
        if own["group"] and others["group"]:  # which selects the region, so that no radius of a force counts
            others = {**others, "deformation_radius": own["deformation_radius"]}
        return all(_is_equal_row(row, own[name], others[name]) for name, row in self._rows.items())

    __hash__ = None  # type: ignore[assignment]


_group = _own("group", "text", "", "the name of its group; the group selects the region then")


class Point(Force, rows="Point", more=(_group,)):
    pass


class Radial(Force, rows="Radial", more=(_group,)):
    pass


class Line(Force, rows="Line", more=(_group,)):
    pass


class Uniform(Force, rows="Uniform", more=(_group,)):
    pass


class Vortex(Force, rows="Vortex", more=(_group,)):
    pass


class Noise(Force, rows="Noise", more=(_group,)):
    pass


class Inertia(Force, rows="Inertia", more=(_group,)):
    pass


class Pressure(Force, rows="Pressure", more=(_group,)):
    pass


class Custom(
    Force,
    rows="Custom",
    more=(
        _group,
        _own("force", "function", None, "force(points, time) -> (n, 3), per unit of magnitude")._replace(is_required=True),
        _own("distance", "function", None, "distance(points, time) -> (n,) [length]; None: 0", True),
        _own("key", "text", "", "identifies the functions for stores; empty: not stored"),
    ),
):
    """A force that Python computes.

    `force(points, time)` gets a read-only float64 (n, 3) array in world space and a `ForceTime`, and
    returns (n, 3): of each point by itself, and the same every time. How many points come in one call
    is not told.
    """

    _positional = ("name", "force")

    def _accept(self, row: Row, value: Any) -> Any:
        if row.kind != "function":
            return super()._accept(row, value)
        if not callable(value) and not (value is None and row.is_optional):
            raise TypeError(f"{self._where(row.name)} must be callable, not {value!r}")
        return value


class Group(Part, rows="Group"):
    _positional = ("name",)


class SceneParts(
    Part,
    rows="Scene",
    more=(
        *(_table["Scene"][1][name]._replace(is_required=False) for name in ("start", "end")),
        _own("surfaces", "parts", (), "`Surface`s"),
        _own("forces", "parts", (), "forces, those in groups too"),
        _own("groups", "parts", (), "`Group`s"),
        _own("colliders", "parts", (), "`Collider`s"),
    ),
):
    _lists = {"surfaces": Surface, "forces": Force, "groups": Group, "colliders": Collider}


class ForceTime(NamedTuple):
    """When a force acts."""

    frame: int
    seconds: float  #: frame / fps [s]


kinds: List[type] = [
    Surface, Grid, MeshFile, Nurbs, Subdivision, Map, Hold, Force, Point, Radial, Line, Uniform,
    Vortex, Noise, Inertia, Pressure, Custom, Group, Collider, Sphere, Capsule, Box, Plane,
]  # fmt: skip
_core.register(ForceTime=ForceTime, **{kind.__name__: kind for kind in kinds})
