"""Scenes, from files and to files."""

from __future__ import annotations

import copy
import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Callable, Dict, Iterator, List, NamedTuple, Optional, Tuple, Union

import numpy as np

from . import _core
from ._core import Curve, Mesh, Path
from ._errors import Problem
from ._parts import Part, SceneParts, _file_name, _is_equal, _nearest
from ._values import integer, number

if TYPE_CHECKING:
    from ._types import ArrayLike, File, Vector


def _root(root: Optional[File]) -> bytes:
    return b"" if root is None else _file_name(root)


class Scene(SceneParts):
    """A scene: surfaces, the forces on them, and the frames of the animation.

    Its lists are ordinary lists, and its parts ordinary objects, which may stand in several scenes.
    `==` compares values, not where they were read.
    """

    _source: Optional[_core.Source] = None  # what it was read from

    def __getitem__(self, name: str) -> Any:
        for part in self._all():
            if part.name == name:
                return part
        raise KeyError(f"nothing is named {name!r}{_nearest(str(name), [part.name for part in self._all()])}")

    def __contains__(self, name: object) -> bool:
        return any(part.name == name for part in self._all())

    __iter__ = None  # it has several lists

    def _all(self) -> List[Any]:
        return [part for name in self._lists for part in self._list(name)]

    @property
    def file(self) -> Optional[str]:
        """The file that it was read from, or None."""
        return self._source.file if self._source else None

    @property
    def notes(self) -> Tuple[Problem, ...]:
        """Remarks on what was read."""
        return self._source.notes if self._source else ()

    def line_of(self, name: str, attribute: str = "") -> int:
        """The line of a part, or of its attribute, in the file; 0: unknown."""
        in_file = re.sub("_(.?)", lambda found: found[1].upper(), attribute)
        return self._source.line_of(name, in_file) if self._source else 0

    def channels(self) -> Dict[str, Union[float, Vector, bool, Curve, Path]]:
        """All channels: path -> a number, three numbers, a bool, or a Curve."""
        return _core.channels(self)

    def set(self, path: str, value: Any) -> None:
        """Sets any attribute by its path, such as "poke.center.x". KeyError names the nearest one."""
        _set(self, path, value)

    def change(self, *changes: str) -> None:
        """Makes changes as `pliant bake --set` takes them: "poke.magnitude*=2"."""
        self._take(_core.changed(self, list(changes)))

    def _take(self, other: "Scene") -> None:
        # Parts, and what is the same of them, stay the objects that they are.
        for name, row in self._rows.items():
            if row.kind != "parts":
                self.__dict__[name] = other.__dict__[name]
                continue
            for before, after in zip(self.__dict__[name], other.__dict__[name]):
                for key, value in after.__dict__.items():
                    before.__dict__[key] = _kept(before.__dict__[key], value)

    def sample(self, path: str, frames: ArrayLike) -> Any:
        """The values of a channel: a number or (3,), or (n,) or (n, 3) at an array of frames."""
        return _core.sample(self, path, frames)

    def check(self) -> None:
        """Raises all that is wrong, in one error."""
        _core.check(self)

    def to_xml(self, *, folder: File = ".") -> str:
        """The text of a scene file in `folder`. Raises InvalidInput for what only memory has."""
        return _core.to_xml(self, _file_name(folder))

    def save(self, path: File) -> None:
        """Writes a scene file, and beside it what only memory has: whole or not at all."""
        _core.save(self, _file_name(path))

    def __repr__(self) -> str:
        return (
            f"<pliant.Scene of {len(self.surfaces)} surfaces, {len(self.forces)} forces, "
            f"frames {self.start} to {self.end}>"
        )

    def __getstate__(self) -> Dict[str, Any]:
        return {**self.__dict__, "_source": None}

    def _copy(self, parts: Callable[[Any], Any]) -> "Scene":
        made = type(self).__new__(type(self))
        made.__dict__.update(self.__dict__)
        for name, row in self._rows.items():
            if row.kind == "parts":
                made.__dict__[name] = parts(self.__dict__[name])
        return made

    def __copy__(self) -> "Scene":
        return self._copy(list)

    def __deepcopy__(self, memo: Any) -> "Scene":
        return self._copy(lambda parts: copy.deepcopy(parts, memo))


def _kept(before: Any, after: Any) -> Any:
    """What a change made of a value: the same object if it left it."""
    if isinstance(before, np.ndarray) and isinstance(after, np.ndarray):
        before_numbers, after_numbers = before.ravel(), after.ravel()  # the core knows no rows
        return before if _is_equal(before_numbers, after_numbers) else after
    if isinstance(before, list) and isinstance(after, list):
        kept = [_kept(*pair) for pair in zip(before, after)] + after[len(before) :]
        return before if len(kept) == len(before) and all(a is b for a, b in zip(before, kept)) else kept
    if isinstance(before, Part) and type(before) is type(after):
        values = {name: _kept(before.__dict__[name], value) for name, value in after.__dict__.items()}
        if all(value is before.__dict__[name] for name, value in values.items()):
            return before
        after.__dict__.update(values)
        return after
    return before if type(before) is type(after) and _is_equal(before, after) else after


def _copy_part(value: Any) -> Any:
    """A copy that nothing changes with the original: all but parts is immutable, or is called."""
    if isinstance(value, list):
        return [_copy_part(each) for each in value]
    if not isinstance(value, Part):
        return value
    made = type(value).__new__(type(value))
    made.__dict__.update({name: _copy_part(each) for name, each in list(value.__dict__.items())})
    return made


def _copy_scene(scene: Any) -> Scene:
    if not isinstance(scene, Scene):
        raise TypeError(f"a scene must be a pliant.Scene, not {scene!r}")
    copied: Scene = _copy_part(scene)
    return copied


def _set(scene: Scene, path: str, value: Any) -> None:
    if not isinstance(path, str):
        raise TypeError(f"path must be a text, not {path!r}")
    name, _, rest = path.partition(".")
    part = scene if name == "scene" else scene[name]
    attribute, _, component = rest.partition(".")
    names: List[str] = []
    for holder in (part, getattr(part, "shape", None), getattr(part, "subdivision", None)):
        if not isinstance(holder, Part):
            continue
        for row in holder._rows.values():
            names.append(f"{name}.{row.attribute}")
            if attribute not in (row.attribute, row.name):
                continue
            if not component:
                setattr(holder, row.name, value)
            elif component == "progress":
                path_there = getattr(holder, row.name)
                if not isinstance(path_there, Path):
                    raise KeyError(f"{path}: {name}.{attribute} follows no path")
                setattr(holder, row.name, Path(path_there.waypoints, closed=path_there.closed, progress=value))
            elif row.kind not in ("vector", "vector channel", "position", "tangent"):
                raise KeyError(f"{path}: {name}.{attribute} has no components")
            elif component in ("x", "y", "z"):
                scene.change(f"{name}.{row.attribute}.{component}={number(path, value)!r}")
            else:
                raise KeyError(f"{path}: there is no component {component!r}; there are x, y and z")
            return
    raise KeyError(f"there is no {path!r}{_nearest(path, names)}")


class GridFacts(NamedTuple):
    """The grid of a surface's nodes."""

    columns: int
    rows: int
    hu: float  #: spacing along u [uv]
    hv: float  #: spacing along v [uv]
    wrap: str  #: the closed directions: none, u, v or uv


class SceneWarning(NamedTuple):
    """What an author should know of a run."""

    kind: str
    surface: str  #: empty: all
    force: str  #: also of a group or collider; empty: it is about the surface
    frames: Tuple[Tuple[int, int], ...]  #: ranges, both ends included
    message: str


def _make_mesh(*members: Any) -> Mesh:
    return _core.mesh_of_members(*members)


def _frames(simulation: _core.Simulation) -> Iterator[_core.Frame]:
    """Every Frame."""
    return (simulation.at(frame) for frame in simulation.frames)


setattr(_core.Simulation, "__iter__", _frames)
for _name in ("keys", "values", "items", "get", "__contains__"):
    setattr(_core.Frame, _name, getattr(Mapping, _name))
Mapping.register(_core.Frame)
_core.register(make_mesh=_make_mesh, Scene=Scene, GridFacts=GridFacts, SceneWarning=SceneWarning, copy_scene=_copy_scene)


def load(path: File, *, root: Optional[File] = None) -> Scene:
    """Reads a scene file. All that it names must be in the folder `root`, if given."""
    return _core.load(_file_name(path), _root(root))


def parse(text: str, *, name: str = "<text>", folder: File = ".", root: Optional[File] = None) -> Scene:
    """Reads a scene from its text; files in it are relative to `folder`."""
    return _core.parse(text, name, _file_name(folder), _root(root))


def validate(path: File, *, root: Optional[File] = None) -> List[Problem]:
    """All problems, warnings and notes of a scene file; a bad scene raises nothing."""
    return _core.validate(_file_name(path), _root(root))


def format_scene(text: str) -> str:
    """The text as `pliant format` writes it."""
    return _core.format_scene(text)


def schema() -> str:
    """The XML schema of scene files."""
    return _core.schema()


def read_mesh(file: File, *, object: str = "", uv_set: int = 0) -> Mesh:  # noqa: A002
    """Reads a mesh from any file that a scene can name."""
    return _core.read_mesh(_file_name(file), object, integer("uv_set", uv_set))
