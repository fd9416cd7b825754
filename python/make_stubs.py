"""Writes the stubs of what is made of the library's tables: usage make_stubs.py PACKAGE

Those are the parts of scenes, whose attributes are the format's (_parts.pyi), and the operations of
documents (edit.pyi). PACKAGE is the folder of the package, with the built module; the stubs go there.
"""

import importlib
import pathlib
import sys

PARTS = '''"""The parts of scenes. Made by python/make_stubs.py from the description of the format."""

from typing import Any, Callable, Dict, Generic, Iterable, List, NamedTuple, Optional, Sequence, Tuple, TypeVar, Union

from ._core import Curve, Mesh, Path
from ._types import ArrayLike, File, Floats, Given, Vector

_Read = TypeVar("_Read", covariant=True)
_Taken = TypeVar("_Taken", contravariant=True)

class _Attribute(Generic[_Read, _Taken]):
    """An attribute that takes more types than it has when it is read back."""
    def __get__(self, part: Any, cls: Any) -> _Read: ...
    def __set__(self, part: Any, value: _Taken) -> None: ...

kinds: List[type]

def _path_text(path: File) -> str: ...
def _file_name(path: File) -> bytes: ...
def _nearest(name: str, names: Iterable[str]) -> str: ...

def _is_equal(a: Any, b: Any) -> bool: ...

class Part:
    _rows: Dict[str, Row]
    _positional: Tuple[str, ...]
    _lists: Dict[str, type]
    def _list(self, name: str) -> List[Any]: ...
    def __init__(self, *positional: Any, **values: Any) -> None: ...
'''

EDIT = '''"""The operations of a `SceneDocument`. Made by python/make_stubs.py from the library's table."""

from typing import Any, Dict, Mapping, NamedTuple, Sequence, Tuple, Union

from ._core import Curve as _Curve
from ._curves import _Frozen
from ._types import Given

_Constant = Union[str, bool, Given, Sequence[str]]
_Names = Union[str, Sequence[str]]

class Operation(_Frozen):
    _name: str
    _members: Tuple[_Member, ...]

def _json_text(operations: Tuple[Operation, ...]) -> str: ...
'''

# What is read back, and what is taken, of each kind of attribute.
KINDS = {
    "number": ("float", "float"),
    "integer": ("int", "int"),
    "unsigned integer": ("int", "int"),
    "boolean": ("bool", "bool"),
    "word": ("str", "str"),
    "text": ("str", "str"),
    "path": ("str", "File"),
    "names": ("Tuple[str, ...]", "Union[str, Iterable[str]]"),
    "integers": ("Tuple[int, ...]", "Iterable[int]"),
    "vector": ("Vector", "Given"),
    "pair": ("Tuple[float, float]", "Given"),
    "channel": ("Union[float, Curve]",) * 2,
    "vector channel": ("Union[Vector, Curve]", "Union[Given, Curve]"),
    "switch": ("Union[bool, Curve]",) * 2,
    "position": ("Union[Vector, Curve, Path]", "Union[Given, Curve, Path]"),
    "tangent": ("Union[float, Vector, Curve]", "Union[Given, Curve]"),
    "edges": ("Tuple[str, str, str, str]", "Union[str, Sequence[str]]"),
    "falloff": ("Union[str, Curve]",) * 2,
    "cache": ("Union[str, Floats]", "Union[File, ArrayLike]"),
    "values": ("Floats", "ArrayLike"),
    "knots": ("Floats", "ArrayLike"),
    "net": ("Floats", "ArrayLike"),
    "net weights": ("Floats", "ArrayLike"),
    "function": ("Callable[[Floats, ForceTime], Any]",) * 2,
    "subdivision": ("Subdivision", "Subdivision"),
}
# Whose lists hold what.
LISTS = {"maps": "Map", "holds": "Hold", "surfaces": "Surface", "forces": "Force", "groups": "Group",
         "colliders": "Collider"}  # fmt: skip
# Of members of operations.
MEMBERS = {
    "text": "str",
    "number": "float",
    "integer": "int",
    "boolean": "bool",
    "word": "str",
    "texts": "_Names",
    "numbers": "Given",
    "curve": "_Curve",
}


def tuple_stub(cls):
    """Of a `NamedTuple`, whose annotations are texts, with its methods and properties."""
    lines = [f"class {cls.__name__}(NamedTuple):"]
    lines += [f"    {name}: {cls.__annotations__[name].__forward_arg__}" for name in cls._fields]
    for name, member in vars(cls).items():
        if name.startswith("_") or name in cls._fields:
            continue
        function = getattr(member, "fget", member)
        lines += ["    @property"] * isinstance(member, property)
        lines.append(f"    def {name}(self) -> {function.__annotations__['return']}: ...")
    return [*lines, ""]


def types_of(cls, row):
    if row.kind == "parts":
        return f"List[{LISTS[row.name]}]", f"Iterable[{LISTS[row.name]}]"
    if row.kind == "shape":
        return (f"Union[{', '.join(shape.__name__ for shape in cls._shapes)}]",) * 2
    read, taken = KINDS["cache" if row.name == "cache" else row.kind]
    if row.is_optional:
        read, taken = f"Optional[{read}]", f"Optional[{taken}]"
    return read, taken


def part_lines(cls):
    base = next(base for base in cls.__mro__[1:] if base.__name__ in ("Force", "Part"))
    lines, positional, named = [f"class {cls.__name__}({base.__name__}):"], ["self"], []
    for name, row in sorted(cls._rows.items(), key=lambda item: item[0] not in cls._positional):
        read, taken = types_of(cls, row)
        lines.append(f"    {name}: " + (read if read == taken else f"_Attribute[{read}, {taken}]"))
        argument = f"{name}: {taken}" + ("" if row.is_required else " = ...")
        if name in cls._positional:
            positional.append(argument)
        else:
            named.append(argument)
    arguments = ", ".join(positional + ["*"] * bool(named) + named)
    return [*lines, f"    def __init__({arguments}) -> None: ..."]


def part_stubs(pliant):
    parts = importlib.import_module(f"{pliant.__name__}._parts")
    yield from tuple_stub(parts.Row)
    yield from tuple_stub(parts.ForceTime)
    for cls in [*parts.kinds, parts.SceneParts]:
        if cls is parts.Force:  # what all its kinds have
            kinds = [kind for kind in parts.kinds if issubclass(kind, cls) and kind is not cls]
            common = [name for name in kinds[0]._rows if all(name in kind._rows for kind in kinds)]
            yield f"class {cls.__name__}(Part):"
            for name in common:
                read, taken = types_of(kinds[0], kinds[0]._rows[name])
                yield f"    {name}: " + (read if read == taken else f"_Attribute[{read}, {taken}]")
        else:
            yield from part_lines(cls)
        yield ""


def member_type(edit, member):
    if member.type == "objects":
        first, second = (member_type(edit, each) for each in member.members)
        return f"Union[Mapping[{first}, {second}], Sequence[Tuple[{first}, {second}]]]"
    return "_Constant" if member.type == "text" and member.name in edit._values else MEMBERS[member.type]


def edit_stubs(pliant):
    edit = pliant.edit
    yield from tuple_stub(edit._Member)
    for name in edit.__all__[1:]:
        cls = getattr(edit, name)
        yield f"class {name}(Operation):"
        for member in cls._members:
            yield f"    {member.snake}: Any"
        arguments = [f"{m.snake}: {member_type(edit, m)}" if m.is_required else
                     f"{m.snake}: Union[None, {member_type(edit, m)}] = ..." for m in cls._members]  # fmt: skip
        yield f"    def __init__({', '.join(['self', *arguments])}) -> None: ..."
        yield ""
    yield f"__all__ = {list(edit.__all__)!r}"


def main():
    package = pathlib.Path(sys.argv[1])
    sys.dont_write_bytecode = True
    sys.path.insert(0, str(package.parent))
    pliant = importlib.import_module(package.name)
    for name, head, lines in (("_parts", PARTS, part_stubs(pliant)), ("edit", EDIT, edit_stubs(pliant))):
        (package / f"{name}.pyi").write_text("\n".join([head, *lines]) + "\n", encoding="utf-8")


main()
