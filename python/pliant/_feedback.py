"""What a scene will do, before it is simulated; and numbers for a motion that is wanted."""

from __future__ import annotations

from typing import List, NamedTuple, Optional, Tuple

from . import _core
from ._scene import Scene
from ._values import integer, number, unless_none

Box = Tuple[int, int, int, int]


class CutCounts(NamedTuple):
    """The part that forces select of a surface of triangles, counted."""

    inside_nodes: int
    held_nodes: int
    cells: int


class Swing(NamedTuple):
    """A vibration as an observer sees it."""

    frequency: float  #: [Hz]; 0: it returns to rest without swinging
    damping_ratio: float  #: [1]; below 1 it swings; infinite without inertia


class Settling(NamedTuple):
    """When a load's motion has come to rest."""

    time: float  #: from then on it stays near [s]
    frames: int  #: the first frame from which on it stays near; 0 is the load's
    is_counted: bool  #: False: it takes too long to count, and these are the envelope's


class RegionPreview(NamedTuple):
    """The response of one region alone to a load that is applied and then constant."""

    region: Optional[Box]  #: nodes (i0, i1, j0, j1), all included; None: of a surface of triangles
    counts: Optional[CutCounts]  #: of a surface of triangles
    is_solvable: bool  #: whether any of its nodes can move
    static_peak: float  #: as in `Preview` [length]
    first_frequency: float  #: of its slowest vibration, undamped [Hz]; 0 without density
    damping_ratio: float  #: of that vibration [1]
    animated: Swing  #: the vibration that the load excites most, as the animation shows it
    settling: Settling  #: to 5 % at the node of the static peak, as the animation shows it
    is_held: bool  #: False: only frequencies and ratios are known
    has_vibration: bool  #: False: too many nodes, or none that moves; values of vibrations are 0
    solver_memory: int  #: of the solver that found the vibrations [bytes]


class ForceShare(NamedTuple):
    """The share of one of several forces in their peak."""

    force: str
    share: float  #: [1]; the sum is 1 if only forces move the surface


class PlayedPeak(NamedTuple):
    """The largest displacement of an animation."""

    peak: float  #: world space [length]
    frame: int  #: the first that has it


class Gap(NamedTuple):
    """How far a force or group that selects nothing is away, where it is nearest."""

    frame: int
    to_vertex: float  #: to the nearest vertex at rest, world space [length]
    to_centre: float  #: to the middle of the surface's bounding box, world space [length]
    deformation_radius: float  #: must be larger than `to_vertex` to select a node [length]


class Preview(NamedTuple):
    """The effect of some forces on one surface at rest.

    Of one `force` alone, of the forces of a `group`, or of all; the other names are None.
    """

    surface: str
    of: str  #: force, group or all
    force: Optional[str]
    group: Optional[str]
    largest_magnitude: float  #: of a force, by its absolute value, while it is enabled
    largest_magnitude_frame: int  #: the first frame that has it
    frame: Optional[int]  #: of greatest effect; None: no node is selected at any frame
    is_every_frame: bool  #: False: the range is too long, and not all frames were examined
    magnitude: float  #: of a force, at that frame [length b/uv^4]
    selected: Optional[Box]  #: nodes (i0, i1, j0, j1), around all regions; None: none, or triangles
    counts: Optional[CutCounts]  #: of a surface of triangles
    is_apart: bool  #: of all: boxes that do not meet form one region
    is_solvable: bool  #: whether any node can move
    is_held: bool  #: False: nothing holds a closed surface, which has no static state
    is_solved: bool  #: False: too many nodes, or nothing holds it; then what follows is 0
    static_peak: float  #: largest displacement under the load of that frame, world space [length]
    regions: Tuple[RegionPreview, ...]
    shares: Tuple[ForceShare, ...]  #: of a group and of all, in the order of the scene
    played: Optional[PlayedPeak]  #: in the whole animation; None: it was not played
    gap: Optional[Gap]  #: of a force or group that selects nothing


class Goal(NamedTuple):
    """A goal beside what the changed scene does."""

    wanted: float
    found: Optional[float]  #: infinite: it never settles; None: it is not known
    obstacle: Optional[str]  #: why it is missed: a word such as leavesReach
    reason: Optional[str]  #: the obstacle in one line, with what would help


class SuggestedValue(NamedTuple):
    """A channel that a goal changes."""

    path: str
    before: float  #: the constant, or of the keys' values the one farthest from 0
    after: float  #: the same in the changed scene
    keys: int  #: how many; 0: a constant


class Suggestion(NamedTuple):
    """A scene whose motion is nearer to some goals."""

    scene: Scene  #: a new one, with other magnitudes, density and damping
    values: Tuple[SuggestedValue, ...]  #: that the goals may change, also those that are kept
    peak: Optional[Goal]  #: [length]; None: no goal
    settling: Optional[Goal]  #: [s]
    frequency: Optional[Goal]  #: [Hz]
    meets_goals: bool  #: whether none is missed by more than 2 %
    notes: Tuple[str, ...]  #: what the changes do beyond the goals


_core.register(
    CutCounts=CutCounts, Swing=Swing, Settling=Settling, RegionPreview=RegionPreview,
    ForceShare=ForceShare, PlayedPeak=PlayedPeak, Gap=Gap, Preview=Preview, Goal=Goal,
    SuggestedValue=SuggestedValue, Suggestion=Suggestion,
)  # fmt: skip


def preview(
    scene: Scene, *, threads: int = 1, solver: str = "auto", max_memory: Optional[int] = None
) -> List[Preview]:
    """What each force, each group and all together will do to every surface, in this order.

    A few seconds at most for each surface. Raises what a `Simulation` raises.
    """
    return _core.preview(scene, integer("threads", threads), solver, max_memory)


def suggest(
    scene: Scene, *, peak: Optional[float] = None, settling: Optional[float] = None,
    frequency: Optional[float] = None, surface: str = "", force: str = "",
) -> Suggestion:  # fmt: skip
    """Finds magnitudes, density and damping with which a surface moves as wanted.

    `peak` is the largest displacement of the animation [length], `settling` when it has come to rest
    [s], `frequency` how fast it swings [Hz]; a goal that is None leaves its numbers alone. `force`
    names one, or a group, that acts alone; `surface` may be left out if only one is moved. What
    cannot be reached is no error: the nearest is found, and the reason told. The scene stays as it
    is. Raises InvalidInput for goals and names that break a rule, and what a `Simulation` raises.
    """
    return _core.suggest(
        scene, unless_none(number, "peak", peak), unless_none(number, "settling", settling),
        unless_none(number, "frequency", frequency), surface, force,
    )  # fmt: skip
