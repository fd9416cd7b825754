"""A whole run in one call: bakes, pages and replays."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, Optional, Tuple, Union

from . import _core
from ._core import Simulation
from ._errors import Unwritable
from ._parts import _file_name
from ._scene import Scene, SceneWarning
from ._values import integer, unless_none

if TYPE_CHECKING:
    from ._types import File, FrameRange, Progress, Store


class BakeSummary(NamedTuple):
    """What a bake has written."""

    files: Tuple[str, ...]  #: their paths, in the order of the surfaces and frames
    frames: int  #: how many
    vertices: int  #: of the surfaces that were written
    seconds: float  #: of the whole bake [s]
    peak_displacement: float  #: the largest distance from rest of its frames, world space [length]
    warnings: Tuple[SceneWarning, ...]


class ReplayDifference(NamedTuple):
    """A field of a surface at a frame that differs from the recorded one."""

    frame: int
    surface: str
    field: str  #: positions, velocities or region
    node: Optional[Tuple[int, int]]  #: (i, j) that differs most; of triangles (node, -1); None: unknown
    size: float  #: of the difference there [unit of the field]
    peaks: Optional[Tuple[float, float]]  #: of positions: the largest displacement, recorded and now [length]
    message: str  #: one line

    def __str__(self) -> str:
        return self.message


class ReplayVerdict(NamedTuple):
    """What a comparison of runs found. It is true if they agree."""

    holds: bool  #: nothing differs
    frame_count: int  #: of frames that were compared
    differences: Tuple[ReplayDifference, ...]  #: by frame, surface and field; the first, or all
    mismatches: Tuple[str, ...]  #: why frames cannot be compared
    causes: Tuple[str, ...]  #: what may be why: another version, an edited scene, a changed file

    def __bool__(self) -> bool:
        return self.holds


_core.register(BakeSummary=BakeSummary, ReplayDifference=ReplayDifference, ReplayVerdict=ReplayVerdict)


def bake(
    scene: Scene, out: File, *, frames: Optional[FrameRange] = None,
    surface: Optional[str] = None, space: str = "world", threads: int = 1, solver: str = "auto",
    max_memory: Optional[int] = None, store: Optional[Store] = None, resume: bool = False,
    progress: Optional[Progress] = None,
) -> BakeSummary:  # fmt: skip
    """Simulates a scene and writes the animation: the files of `pliant bake`, byte for byte.

    The ending of `out` selects the format; a run of # in it is the frame. `frames` are `(first,
    last)`, `surface` the name of the only one to write, `space` world or object, `max_memory` in
    bytes. `resume` keeps the files of a sequence that are right already. `progress(done, total)` is
    called after each frame; what it raises ends the bake, which then leaves nothing of a format of
    one file. Raises InvalidInput, Unwritable and what a `Simulation` raises; KeyError for `surface`.
    """
    return _core.bake(
        scene, _file_name(out), frames, surface, space, threads, solver, max_memory, store, resume,
        progress,
    )  # fmt: skip


def view(
    scene_or_simulation: Union[Scene, Simulation], out: File, *, frames: Optional[FrameRange] = None
) -> None:
    """Writes the page of `pliant view`, byte for byte: one .html that needs no network.

    `frames` are `(first, last)`. Raises InvalidInput, Unwritable and what a `Simulation` raises.
    """
    _core.view(scene_or_simulation, _file_name(out), frames)


def _run(run: Union[File, Simulation]) -> Union[bytes, Simulation]:
    return run if isinstance(run, Simulation) else _file_name(run)


def record_replay(
    scene_file_or_simulation: Union[File, Simulation], log: File, *, last_frame: Optional[int] = None,
    states_every: int = 0, threads: int = 1,
) -> None:  # fmt: skip
    """Simulates a scene and writes its log, hashes of every frame, as `pliant replay record`.

    With `states_every` it also has whole states every so many frames. Raises InvalidInput,
    Unreadable, Unwritable and what a `Simulation` raises.
    """
    run = _run(scene_file_or_simulation)
    last = unless_none(integer, "last_frame", last_frame)
    every, count = integer("states_every", states_every), integer("threads", threads)
    _core.record_replay(run, _file_name(log), last, every, count)


def verify_replay(
    log: File, scene_file_or_simulation: Union[None, File, Simulation] = None, *,
    keep_going: bool = False, threads: int = 1,
) -> ReplayVerdict:  # fmt: skip
    """Simulates the run of a log again, and compares every frame, bit for bit.

    Of the recorded scene file, or its text in the log, unless another file or a simulation is
    given. With `keep_going` all differences are found, not only the first; a difference is a
    verdict, not an exception. Raises InvalidInput, also for a damaged log, and Unreadable.
    """
    run = None if scene_file_or_simulation is None else _run(scene_file_or_simulation)
    return _core.verify_replay(_file_name(log), run, bool(keep_going), integer("threads", threads))


def compare_replays(a: File, b: File, *, keep_going: bool = False) -> ReplayVerdict:
    """Compares two logs, as `pliant replay diff`. Raises InvalidInput and Unreadable."""
    return _core.compare_replays(_file_name(a), _file_name(b), bool(keep_going))


def _repr_html_(self: Simulation) -> Optional[str]:
    """The page of `pliant view` in a frame of its own; None in a build without the page."""
    try:
        page = _core.page(self)
    except Unwritable:
        return None
    text = page.replace("&", "&amp;").replace('"', "&quot;")
    return (
        '<iframe sandbox="allow-scripts allow-downloads" allow="fullscreen" '
        f'style="width: 100%; height: 36em; border: 0" srcdoc="{text}"></iframe>'
    )


setattr(Simulation, "_repr_html_", _repr_html_)
