"""Multi-force elastic animation: scenes in, surfaces that bulge, ring and settle out.

See docs/python.md of the project.
"""

import atexit as _atexit

from . import _core
from ._core import (
    Curve,
    FolderStore,
    Frame,
    LiveSimulation,
    MemoryStore,
    Mesh,
    Path,
    RestShape,
    Simulation,
    SurfaceFrame,
)
from ._errors import (
    Error,
    Interrupted,
    InvalidInput,
    NotFinite,
    OutOfMemory,
    Problem,
    SolverFailed,
    Unreadable,
    Unwritable,
)

_core.register(
    Problem=Problem, Error=Error, InvalidInput=InvalidInput, Unreadable=Unreadable,
    Unwritable=Unwritable, OutOfMemory=OutOfMemory, SolverFailed=SolverFailed, NotFinite=NotFinite,
    Interrupted=Interrupted,
)  # fmt: skip

from ._curve_files import (  # noqa: E402
    CurveFile,
    CurveLoss,
    FileCurve,
    read_curves,
    write_curves,
)
from ._curves import Handle, Key, Loop  # noqa: E402
from ._parts import (  # noqa: E402
    Box,
    Capsule,
    Collider,
    Custom,
    Force,
    ForceTime,
    Grid,
    Group,
    Hold,
    Inertia,
    Line,
    Map,
    MeshFile,
    Noise,
    Nurbs,
    Plane,
    Point,
    Pressure,
    Radial,
    Sphere,
    Subdivision,
    Surface,
    Uniform,
    Vortex,
)
from ._documents import Change, SceneDocument, TextEdit  # noqa: E402
from ._feedback import (  # noqa: E402
    CutCounts,
    ForceShare,
    Gap,
    Goal,
    PlayedPeak,
    Preview,
    RegionPreview,
    Settling,
    SuggestedValue,
    Suggestion,
    Swing,
    preview,
    suggest,
)
from ._runs import (  # noqa: E402
    BakeSummary,
    ReplayDifference,
    ReplayVerdict,
    bake,
    compare_replays,
    record_replay,
    verify_replay,
    view,
)
from ._scene import (  # noqa: E402
    GridFacts,
    Scene,
    SceneWarning,
    format_scene,
    load,
    parse,
    read_mesh,
    schema,
    validate,
)
from ._sweeps import Sweep, SweepFolder, SweepStatus  # noqa: E402
from . import edit  # noqa: E402

_atexit.register(_core.end)
__version__ = _core.version
__all__ = [
    "BakeSummary", "Box", "Capsule", "Change", "Collider", "Curve", "CurveFile", "CurveLoss",
    "Custom", "CutCounts", "Error", "FileCurve", "FolderStore", "Force", "ForceShare",
    "ForceTime", "Frame", "Gap", "Goal", "Grid", "GridFacts", "Group", "Handle", "Hold", "Inertia",
    "Interrupted", "InvalidInput", "Key", "Line", "LiveSimulation", "Loop", "Map",
    "MemoryStore", "Mesh", "MeshFile", "Noise", "NotFinite", "Nurbs", "OutOfMemory", "Path",
    "Plane", "PlayedPeak", "Point", "Pressure", "Preview", "Problem", "Radial", "RegionPreview",
    "ReplayDifference", "ReplayVerdict", "RestShape", "Scene", "SceneDocument", "SceneWarning",
    "Settling", "Simulation", "SolverFailed", "Sphere", "Subdivision", "SuggestedValue",
    "Suggestion", "Surface", "SurfaceFrame", "Sweep", "SweepFolder", "SweepStatus", "Swing",
    "TextEdit", "Uniform", "Unreadable", "Unwritable", "Vortex", "bake", "compare_replays",
    "edit", "format_scene", "load", "parse", "preview", "read_curves", "read_mesh",
    "record_replay", "schema", "suggest", "validate", "verify_replay", "view", "write_curves",
]  # fmt: skip
