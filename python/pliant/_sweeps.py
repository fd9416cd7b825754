"""Scenes run many times, each take with other values."""

from __future__ import annotations

import numbers
import os
from typing import TYPE_CHECKING, Any, Callable, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple, Union

import numpy as np

from . import _core
from ._core import Curve, Frame
from ._parts import _file_name, _path_text
from ._scene import Scene
from ._values import number

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ._types import File, FrameRange, Progress

Watch = Callable[[int, Frame], object]
Vary = Mapping[str, Any]


class SweepStatus(NamedTuple):
    """How many takes of a folder were run."""

    done: int
    failed: int
    missing: int
    conflicts: Tuple[Tuple[int, str, str], ...]  #: (take, host, host) with two hashes of one take


_core.register(SweepStatus=SweepStatus)


def _text(where: str, value: Any) -> str:
    """The text of a value of one take."""
    if isinstance(value, str):
        return value
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, (numbers.Real, np.number)):
        if isinstance(value, (numbers.Integral, np.integer)):
            return str(int(value))
        return _core.numbers_text([number(where, value)])
    if isinstance(value, os.PathLike):
        return _path_text(value)
    if isinstance(value, (bytes, Curve)) or not hasattr(value, "__iter__"):
        raise TypeError(f"{where}: a value must be a number, numbers, True, False or a text, not {value!r}")
    return " ".join(_text(where, part) for part in value)


def _items(where: str, values: Any) -> List[Tuple[str, Any]]:
    if not isinstance(values, Mapping) or not all(isinstance(path, str) for path in values):
        raise TypeError(f"{where} must be a dict of paths and values, not {values!r}")
    return list(values.items())


def _axis(path: str, values: Any) -> str:
    """An axis as `--vary` takes it."""
    if isinstance(values, str):
        return f"{path}={values}"
    if not hasattr(values, "__iter__"):
        raise TypeError(f"vary {path!r} must be a sequence or a text, not {values!r}")
    texts = [_text(f"vary {path!r}", value) for value in values]
    for text in texts:
        # What the text of an axis would take apart.
        if "," in text or (len(texts) == 1 and (":" in text or ".." in text)) or text.strip() != text:
            raise ValueError(f"vary {path!r}: {text!r} can only be given in a table")
    return f"{path}={','.join(texts)}"


def _axes(vary: Any) -> List[str]:
    return [_axis(path, values) for path, values in _items("vary", vary)]


def _changes(changes: Any) -> List[str]:
    return [f"{path}={_text(f'set {path!r}', value)}" for path, value in _items("set", changes)]


def _csv(table: Any) -> Optional[str]:
    """A table as `--takes` reads it, of a dict of columns or a structured array."""
    if table is None:
        return None
    if isinstance(table, np.ndarray):
        if table.dtype.names is None or table.ndim != 1:
            raise TypeError("table must be a dict of columns or a structured array (n,)")
        columns = {name: table[name] for name in table.dtype.names}
    elif isinstance(table, Mapping):
        columns = dict(table)
    else:
        raise TypeError("table must be a dict of columns or a structured array (n,)")
    listed: Dict[str, List[Any]] = {}
    for name, column in columns.items():
        if isinstance(column, (str, bytes)) or not hasattr(column, "__iter__"):
            raise TypeError(f"table[{name!r}] must be a sequence, not {column!r}")
        listed[name] = list(column)
    lengths = {name: len(column) for name, column in listed.items()}
    if len(set(lengths.values())) > 1:
        raise ValueError(f"the columns of table have different lengths: {lengths}")
    field = _core.csv_field
    lines = [",".join(field(name) for name in listed)]
    for row in zip(*listed.values()):
        texts = [_text(f"table[{name!r}]", value) for name, value in zip(listed, row)]
        lines.append(",".join(field(text) for text in texts))
    return "\n".join(lines) + "\n"


def _column(texts: List[str]) -> NDArray[Any]:
    """Numbers if all are, else texts."""
    try:
        return np.array([float(text) for text in texts])
    except ValueError:
        return np.array(texts, dtype=np.str_)


def _table(columns: Dict[str, Any], paths: Sequence[str], scenes: Optional[Sequence[str]]) -> NDArray[Any]:
    """A structured array of what the core tells of takes."""
    named: List[Tuple[str, NDArray[Any]]] = [
        ("take", columns["take"]),
        ("status", np.array(columns["status"], dtype="U7")),
    ]
    if scenes is not None:
        names = [scenes[index] for index in columns["scene"]]
        named.append(("scene", np.array(names, dtype=np.str_) if names else np.empty(0, "U1")))
    named += [(path, _column(texts)) for path, texts in zip(paths, columns["paths"])]
    named += [
        (name, columns[name])
        for name in ("peak", "peak_frame", "final", "rms", "speed", "energy", "settle")
    ]
    named.append(("hash", np.array(columns["hash"], dtype="U32")))
    named.append(("error", np.array(columns["error"] or [""], dtype=np.str_)[: len(columns["error"])]))
    table = np.empty(len(columns["take"]), dtype=[(name, column.dtype) for name, column in named])
    for name, column in named:
        table[name] = column
    return table


class Sweep:
    """A scene, or several, run many times, each take with other values.

    `vary` has an axis for each path as `--set` takes it, such as "sheet.damping", "poke.magnitude*"
    (times) or "poke.center.x+" (plus): a sequence of values, or a text as `--vary` takes it,
    "0.5:2:4". All axes are combined, the last one fastest. `sample` is the number of points for all
    intervals "A:B" together. A `table`, a dict of columns or a structured array with the paths as
    names, gives the takes row by row instead. `set` has values of all takes. `frames`, `(first,
    last)`, are those measured. The scenes are copied. Raises InvalidInput for a path or a value that
    a scene does not take. `len(sweep)` is the number of takes. It cannot be pickled.
    """

    __slots__ = ("_own", "_scenes")

    def __init__(
        self, scene_or_scenes: Union[Scene, Sequence[Scene]], *, vary: Vary = {}, set: Vary = {},
        sample: Optional[int] = None, table: Any = None,
        frames: Optional[FrameRange] = None, solver: str = "auto",
    ):  # fmt: skip
        scenes = list(scene_or_scenes) if isinstance(scene_or_scenes, (list, tuple)) else [scene_or_scenes]
        if not scenes:
            raise ValueError("a sweep needs a scene")
        self._own = _core.SweepCore(scenes, _axes(vary), _changes(set), sample, _csv(table), frames, solver)
        titles = [str(scene.file or index) for index, scene in enumerate(scenes)]
        self._scenes = titles if len(scenes) > 1 else None

    def __len__(self) -> int:
        return len(self._own)

    @property
    def paths(self) -> Tuple[str, ...]:
        """What varies, as typed: the names of the columns."""
        return self._own.paths

    def scene(self, take: int) -> Scene:
        """A new `Scene` of a take. Raises IndexError; InvalidInput for values that do not fit together."""
        return self._own.scene(take)

    def run(
        self, takes: Optional[Sequence[int]] = None, *, threads: int = 1,
        max_memory: Optional[int] = None, watch: Optional[Watch] = None, progress: Optional[Progress] = None,
    ) -> NDArray[Any]:  # fmt: skip
        """Runs takes, by default all, and measures them: the numbers of `pliant sweep`.

        A structured array, a row for each take: `take`, `status` (done or failed), with several
        scenes `scene`, a column for each of `paths` (float64 if all are numbers, else texts), `peak`,
        `peak_frame`, `final`, `rms` [length], `speed` [length/s], `energy` [length^2/s^2], `settle`
        (a frame), `hash` (of all positions) and `error`. A take that fails stops nothing: its numbers
        are NaN, its frames 0.

        `threads` takes run at once, in `max_memory` bytes together. `watch(take, frame)` is called
        with each `Frame` that is measured, from any thread; False ends the take there. `progress(done,
        total)` is called after each take. What they raise ends the run. Raises IndexError for a take
        that there is not.
        """
        columns = self._own.run(takes, threads, max_memory, watch, progress)
        return _table(columns, self.paths, self._scenes)

    def __repr__(self) -> str:
        return f"<pliant.Sweep of {len(self)} takes of {', '.join(self.paths)}>"

    def __reduce__(self) -> Any:
        raise TypeError("a Sweep cannot be pickled")


class SweepFolder:
    """A sweep in a folder, as `pliant sweep run` makes it: run in parts, by any number of processes.

    Makes it in `folder`, which is empty or not there, or opens the one that is there if it is the
    same. `files` are a scene file or several; `write` is the ending of the animations of the takes,
    such as ".npy"; all else is as of a `Sweep`. Raises InvalidInput, Unreadable and Unwritable.
    """

    __slots__ = ("_own",)

    def __init__(
        self, folder: File, files: Union[File, Sequence[File]], *, vary: Vary = {}, set: Vary = {},
        sample: Optional[int] = None, table: Any = None,
        frames: Optional[FrameRange] = None, solver: str = "auto", write: str = "",
    ):  # fmt: skip
        names = [files] if isinstance(files, (str, os.PathLike)) else list(files)
        if not names:
            raise ValueError("a sweep needs a scene")
        self._own = _core.SweepFolderCore(
            _file_name(folder), [_file_name(name) for name in names], _axes(vary), _changes(set), sample,
            _csv(table), frames, solver, write,
        )  # fmt: skip

    @classmethod
    def open(cls, folder: File) -> "SweepFolder":
        """The sweep that is in a folder. Raises InvalidInput and Unreadable."""
        made = cls.__new__(cls)
        made._own = _core.SweepFolderCore.open(_file_name(folder))
        return made

    def __len__(self) -> int:
        return len(self._own)

    @property
    def folder(self) -> str:
        """Where it is."""
        return self._own.folder

    @property
    def files(self) -> Tuple[str, ...]:
        """Of its scenes."""
        return self._own.files

    @property
    def paths(self) -> Tuple[str, ...]:
        """What varies, as typed: the names of the columns."""
        return self._own.paths

    def run(
        self, part: Tuple[int, int] = (0, 1), retry: bool = False, *, threads: int = 1,
        max_memory: Optional[int] = None, progress: Optional[Progress] = None,
    ) -> SweepStatus:  # fmt: skip
        """Runs the takes t with t mod p = k of a part (k, p) that are missing; with `retry` failed ones.

        Each take that ends is kept at once. Without parts it writes `takes.csv` at the end.
        `progress(done, total)` is called after each take; what it raises ends the run. Raises
        Unreadable and Unwritable.
        """
        k, p = part
        self._own.run(k, p, retry, threads, max_memory, progress)
        return self.status()

    def status(self) -> SweepStatus:
        """How many takes were run, by any process. Raises Unreadable."""
        return self._own.status()

    def table(self) -> NDArray[Any]:
        """All takes as a structured array, as of `Sweep.run`, also missing ones. Raises Unreadable."""
        files = self.files
        return _table(self._own.table(), self.paths, files if len(files) > 1 else None)

    def __repr__(self) -> str:
        return f"<pliant.SweepFolder {self.folder} of {len(self)} takes>"

    def __reduce__(self) -> Any:
        raise TypeError("a SweepFolder cannot be pickled; open it by its folder")
