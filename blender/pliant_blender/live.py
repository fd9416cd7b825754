"""What is solved, and how Blender comes to show it.

A surface has a Mesh Cache modifier that plays a PC2 file in a folder of the session. A change of frame writes
that file only. What an edit did is found by comparing fingerprints (translate.look_all), in handlers that run
after Blender's evaluation; a surface that changed is tagged there, which Blender answers with a second pass.
"""

from __future__ import annotations

import contextlib
import os
import threading
import time
from typing import Any, Dict, Iterator, List, Optional, Sequence, Set

import bpy
import numpy as np
from bpy.app.handlers import persistent

from . import meshes, properties, translate
from .preferences import preferences
from .session import Session
from .translate import MODIFIER, Problem, Translation

_sessions: Dict[str, Session] = {}
_is_rendering = False
_turn = threading.RLock()
_begun = 0.0  # when a handler of ours began, of which patience is counted
_working: List[Any] = []  # what a handler of ours does now
_stale: Set[str] = set()  # names of meshes that an update named
_touched = False  # a property of ours was set
_owned: Set[str] = set()  # names of surfaces that we have tagged, whose next update tells nothing


# Modifiers.


def _ours(owner: Any) -> Optional[Any]:
    place = translate.ours(owner)
    return owner.modifiers[place] if place >= 0 else None


@contextlib.contextmanager
def overriding(owner: Any) -> Iterator[None]:
    """Another active object for operators of Blender. No thread of ours runs beside them: 3.4 reads what is
    overridden without the lock of Python."""
    for each in _sessions.values():
        each.stop()
    with bpy.context.temp_override(object=owner, active_object=owner):
        yield


def _move(owner: Any, place: int) -> bool:
    at = translate.ours(owner)
    if at == place:
        return True
    if hasattr(owner.modifiers, "move"):
        owner.modifiers.move(at, place)
        return True
    try:
        with overriding(owner):
            bpy.ops.object.modifier_move_to_index(modifier=owner.modifiers[at].name, index=place)
    except RuntimeError:
        return False
    return translate.ours(owner) == place


def _place(session: Session, owner: Any, is_new: bool = False) -> None:
    """Moves our modifier to where it belongs."""
    rest, before = owner.pliant.rest, session.rests.get(owner.name)
    session.rests[owner.name] = rest
    if is_new or (before is not None and before != rest and translate.ours(owner) == 0):
        _move(owner, translate.place_of(owner))
        if owner.pliant.place >= 0:
            owner.pliant["place"] = -1  # from now on the stack says it
    elif rest == "BASE":
        _move(owner, 0)


def _attach(session: Session, owner: Any) -> bool:
    """Gives a surface its modifier, at its place. Returns whether anything was changed."""
    cache = session.caches[owner.name]
    modifier = _ours(owner)
    is_new = modifier is None
    if is_new:
        modifier = owner.modifiers.new(MODIFIER, "MESH_CACHE")
        modifier.cache_format = "PC2"
        modifier.deform_mode = "OVERWRITE"
        modifier.interpolation = "LINEAR"
        modifier.show_in_editmode = False
        modifier.show_expanded = False
    _place(session, owner, is_new)
    changed = is_new
    if modifier.filepath != cache.path:
        modifier.filepath = cache.path
        changed = True
    if modifier.frame_start != cache.first:
        modifier.frame_start = cache.first
        changed = True
    return changed


def _problem_of_place(owner: Any) -> List[Problem]:
    place = translate.ours(owner)
    ahead = [each for each in list(owner.modifiers)[: max(place, 0)] if each.show_viewport]
    if owner.pliant.rest == "BASE" and ahead:  # it could not be moved
        text = f"the modifier {ahead[0].name!r} is ahead of pliant's, which overwrites what it does"
        if owner.override_library:
            text += "; a library override cannot move it behind: add it to the override, or move it in the library"
        return [Problem("ERROR", owner.name, text)]
    return []


def _detach(owner: Any) -> bool:
    """Takes our modifier off, and keeps its place if the artist can choose it. Returns whether there was one."""
    modifier = _ours(owner)
    if modifier is None:
        return False
    owner.pliant["place"] = translate.ours(owner) if owner.pliant.rest == "MODIFIERS" else -1
    owner.modifiers.remove(modifier)
    return True


def _tag(owner: Any) -> None:
    _owned.add(owner.name)
    owner.update_tag(refresh={"DATA"})


# The one thing that all handlers do.


def _session(scene: Any) -> Optional[Session]:
    """The session of a scene that has a surface or a force, or had one."""
    found = _sessions.get(scene.name)
    if found is None and any(properties.role(each) != "NONE" for each in scene.objects):
        found = _open(scene)
    return found


def _open(scene: Any) -> Session:
    found = _sessions[scene.name] = properties.shown_of[scene.name] = Session(scene.name)
    return found


def _sync(scene: Any, is_foreign: bool = True) -> None:
    """Makes what is shown what the scene says, whatever was edited."""
    global _touched
    session = _session(scene)
    if session is None:
        return
    settings = scene.pliant
    if not settings.is_property_set("frame_start") and not settings.is_property_set("frame_end"):
        if any(properties.role(each) == "SURFACE" for each in scene.objects):  # the first, made by a script
            settings.frame_start, settings.frame_end = scene.frame_start, scene.frame_end
    _touched = False
    stale = {each.data.name_full for each in scene.objects if each.type == "MESH" and each.data.name_full in _stale}
    _stale.difference_update(stale)
    if not settings.live:
        _leave(scene, session)
        session.look, session.refused = None, []
        return
    for owner in scene.objects:  # what is ahead of ours is sampled
        if owner.name in session.caches and properties.role(owner) == "SURFACE" and _ours(owner):
            _place(session, owner)
    look = translate.look_all(scene)
    samples = session.translation.samples if session.translation else None
    changed = False
    if look != session.look or stale or session.translation is None or (samples and is_foreign):
        session.look = look
        session.trusted = False
        # Samples are made anew: what they depend on can be anything.
        changed = session.take(translate.translate(scene, stale=stale, is_checked=False))
    _show(scene, session, changed)


def _show(scene: Any, session: Session, changed: bool) -> None:
    translation = session.translation
    if session.simulation is None or translation is None:
        _leave(scene, session)
        return
    written = _ensure(session, scene)
    used: Set[str] = set()
    session.told.pop("place", None)
    session.told.pop("scenes", None)
    for owner in scene.objects:
        if owner.name not in session.caches or properties.role(owner) != "SURFACE":
            if properties.has(owner) and owner.type == "MESH" and _detach_unless_elsewhere(owner):
                _tag(owner)
            continue
        modifier = _ours(owner)
        other = _elsewhere(session, owner, modifier)
        if other:
            text = f"it is live in the scene {other.name!r} already; a surface is live in one scene"
            session.told.setdefault("scenes", []).append(Problem("ERROR", owner.name, text))
            continue
        if session.caches[owner.name].path in used:
            continue
        used.add(session.caches[owner.name].path)
        if owner.library and not owner.override_library:
            continue
        if _attach(session, owner) or changed or written:
            _tag(owner)
        session.told.setdefault("place", []).extend(_problem_of_place(owner))
    _show_rest_ahead(session, scene)
    _ensure(session, scene)  # what was stopped goes on


def _elsewhere(session: Session, owner: Any, modifier: Any) -> Optional[Session]:
    """The session of another scene in which a surface is live already."""
    for each in _sessions.values():
        scene, cache = bpy.data.scenes.get(each.name), each.caches.get(owner.name)
        if each is not session and modifier and cache and cache.path == modifier.filepath:
            if scene and owner.name in scene.objects:
                return each
    return None


def _detach_unless_elsewhere(owner: Any) -> bool:
    if any(owner.name in each.caches for each in _sessions.values()):
        return False
    return _detach(owner)


def _leave(scene: Any, session: Session) -> None:
    """Nothing of a scene moves any more."""
    session.stop()
    for name in list(session.caches):
        owner, cache = bpy.data.objects.get(name), session.caches.pop(name)
        modifier = _ours(owner) if owner else None
        is_elsewhere = any(name in each.caches for each in _sessions.values())
        if modifier and (modifier.filepath == cache.path or not is_elsewhere):
            _detach(owner)
            _tag(owner)
        cache.close()
    session.told.pop("place", None)
    session.told.pop("scenes", None)
    session.simulation = session.translation = None
    session.ready, session.failure, session.warned = set(), (None, []), []


def _ensure(session: Session, scene: Any) -> bool:
    """The frame of the scene, in the files: within the user's patience where there is a window."""
    patience = None
    if not bpy.app.background and not _is_rendering:
        patience = max(0.01, preferences().patience - (time.monotonic() - _begun))
    written = session.ensure(scene, patience)
    if session.worker and not bpy.app.timers.is_registered(_show_news):
        bpy.app.timers.register(_show_news, first_interval=0.05, persistent=True)
    return written


def _publish(scene: Any) -> None:
    """Messages where scripts and the panel read them; written only if they differ."""
    session = _sessions.get(scene.name)
    if session is None or _is_elsewhere():
        return
    session.warn()
    wanted = session.messages()
    if not properties.has(scene) and not wanted:
        return
    found = scene.pliant.messages
    if [(each.level, each.object, each.text) for each in found] == [tuple(each) for each in wanted]:
        return
    found.clear()
    for each in wanted:
        item = found.add()
        item.level, item.object, item.text = each


def _guarded(work: Any, may_write: bool = True) -> None:
    """Runs what a handler does, but for handlers that it causes, and without an exception."""
    global _begun
    with _turn:  # a render has a thread of its own
        if _working or translate.stages:
            return
        _begun = time.monotonic()
        _working.append(work)
        try:
            for session in _sessions.values():
                session.told.pop("pliant", None)
            work()
        except Exception as error:  # a handler that raises says so at every frame
            _report(error, may_write)
        finally:
            _working.pop()


def _is_elsewhere() -> bool:
    """Whether a render runs beside the window: no data may be written then."""
    return _is_rendering and not bpy.app.background


def _report(error: Exception, may_write: bool) -> None:
    scene = bpy.context.scene
    session = _sessions.get(scene.name)
    if session:
        session.told["pliant"] = [Problem("ERROR", "", f"{type(error).__name__}: {error}")]
        if may_write:
            _publish(scene)
    if os.environ.get("PLIANT_TEST"):
        import traceback

        traceback.print_exc()


# Handlers.


@persistent
def _before_frame(scene: Any, _graph: Any = None) -> None:
    def work() -> None:
        session = _sessions.get(scene.name)
        if session is None or session.simulation is None:
            return
        # An edit that no update announced is left to the handler after the evaluation, which may write data.
        if not _is_rendering and bpy.context.scene == scene:
            session.is_touched = _hear(bpy.context.view_layer.depsgraph.updates) or session.is_touched
        _ensure(session, scene)

    _guarded(work, may_write=False)


@persistent
def _after_frame(scene: Any, graph: Any = None) -> None:
    def work() -> None:
        session = None if _is_elsewhere() else _session(scene)
        if session is None:
            return
        is_edited = session.is_touched or session.look != translate.look_all(scene)
        if is_edited or _touched or _differs(session, scene, graph):
            session.is_touched = False
            _sync(scene)
            session.trusted = _differs(session, scene, graph)  # what no view layer evaluates, say
        elif session.simulation is not None:
            _show_rest_ahead(session, scene)
        _owned.clear()  # a second pass follows, and no update tells of it
        _publish(scene)

    _guarded(work)


def _differs(session: Session, scene: Any, graph: Any) -> bool:
    """Whether what was sampled is not what Blender evaluates now."""
    samples = session.translation.samples if session.translation else None
    index = scene.frame_current - int(samples.frames[0]) if samples else -1
    if not samples or graph is None or session.trusted or scene.frame_subframe or not 0 <= index < len(samples.frames):
        return False
    origin = scene.pliant.origin
    to_origin = translate.inverse_of(origin)
    if to_origin is None:
        return False
    for name, found in samples.matrices.items():
        owner = bpy.data.objects.get(name)
        if owner and abs(to_origin @ np.array(owner.evaluated_get(graph).matrix_world) - found[index]).max() > 1e-5 * (
            1 + abs(found[index]).max()
        ):
            return True
    for (name, attribute), found in samples.values.items():
        owner = bpy.data.objects.get(name)
        if owner and not np.allclose(getattr(owner.evaluated_get(graph).pliant, attribute), found[index], 1e-5, 1e-6):
            return True
    return False


def _show_rest_ahead(session: Session, scene: Any) -> None:
    """Ahead of the start the rest shape that modifiers move is that of the frame."""
    samples = session.translation.samples
    first = session.simulation.frames[0]
    frame = scene.frame_current
    there = first - 1 if session.ahead is None else session.ahead
    if not samples or not samples.shapes or frame >= first or frame == there:
        return
    shapes = translate.sample(scene, None, frame, frame, set(), {}, set(samples.shapes)).shapes
    for name, shape in shapes.items():
        owner = bpy.data.objects.get(name)
        if owner and not isinstance(shape, str) and name in session.caches:
            session.caches[name].write(first - 1, np.ascontiguousarray(shape[0]))
            _tag(owner)
    session.ahead = frame


def _hear(updates: Any) -> bool:
    """Notes which meshes were updated. Returns whether anything was but what we have tagged."""
    is_foreign = False
    for update in updates:
        block = update.id
        if isinstance(block, bpy.types.Mesh):
            _stale.add(block.name_full)
        elif isinstance(block, bpy.types.Object) and block.name in _owned and not update.is_updated_transform:
            continue
        elif isinstance(block, bpy.types.Object) and update.is_updated_geometry and block.type == "MESH":
            _stale.add(block.original.data.name_full)
        is_foreign = True
    return is_foreign


@persistent
def _after_update(scene: Any, graph: Any) -> None:
    def work() -> None:
        is_foreign = _hear(graph.updates)
        _owned.clear()
        if _is_elsewhere():
            return
        if _session(scene) is not None:
            _sync(scene, is_foreign)
            _publish(scene)
        _drop_orphans()

    _guarded(work)


def _drop_orphans() -> None:
    for name in [name for name in _sessions if name not in bpy.data.scenes]:
        _sessions.pop(name).close()
        properties.shown_of.pop(name, None)


@persistent
def _before_save(*_: Any) -> None:
    for owner in bpy.data.objects:
        if properties.has(owner):
            _detach(owner)
    for scene in bpy.data.scenes:
        if properties.has(scene):
            scene.pliant.messages.clear()
            scene.pliant["version"] = properties.VERSION


@persistent
def _after_save(*_: Any) -> None:
    def work() -> None:
        for scene in bpy.data.scenes:
            session = _sessions.get(scene.name)
            if session:
                _show(scene, session, True)
                _publish(scene)

    _guarded(work)


@persistent
def _before_load(*_: Any) -> None:
    forget_all()


@persistent
def _after_load(*_: Any) -> None:
    forget_all()
    if bpy.app.background:
        _begin()
    else:
        # Blender 3.4 reads the override of the operator that opened the file without Python's lock: no thread of
        # ours may run before that operator has ended.
        bpy.app.timers.register(_begin, first_interval=0)


def _begin() -> None:
    _guarded(lambda: [(_sync(scene), _check_version(scene), _publish(scene)) for scene in bpy.data.scenes])


def _check_version(scene: Any) -> None:
    session = _sessions.get(scene.name)
    if session and scene.pliant.version > properties.VERSION:
        text = (f"the file was saved by a pliant whose properties are version {scene.pliant.version}; this one knows "
                f"version {properties.VERSION}: what is new in it does not act")  # fmt: skip
        session.told["version"] = [Problem("WARNING", "", text)]


@persistent
def _after_undo(*_: Any) -> None:
    def work() -> None:
        meshes.forget()
        _drop_orphans()
        for session in _sessions.values():
            session.look = None
        for scene in bpy.data.scenes:  # also those that have their name, or a role in them, again
            _sync(scene)
            _publish(scene)

    _guarded(work)


@persistent
def _begin_render(*_: Any) -> None:
    global _is_rendering
    if bpy.app.background:
        _guarded(lambda: [_sync(scene) for scene in bpy.data.scenes if _session(scene)])
    _is_rendering = True


@persistent
def _end_render(*_: Any) -> None:
    global _is_rendering
    _is_rendering = False
    if not bpy.app.background:  # what was edited meanwhile

        def catch_up() -> None:
            _guarded(lambda: [(_sync(scene), _publish(scene)) for scene in bpy.data.scenes if scene.name in _sessions])

        bpy.app.timers.register(catch_up, first_interval=0)


def _show_news() -> Optional[float]:
    """Runs at times while a thread solves: what is ready is shown."""
    busy = False

    def work() -> None:
        nonlocal busy
        for name, session in _sessions.items():
            worker, scene = session.worker, bpy.data.scenes.get(name)
            if worker is None or scene is None or _is_rendering:
                continue
            busy = busy or worker.is_busy
            if worker.is_news:
                worker.is_news = False
                _redraw()
                if worker.shown_late(scene):
                    for owner in scene.objects:
                        if owner.name in session.caches:
                            _tag(owner)
            if not worker.is_busy:
                _publish(scene)

    _guarded(work)
    return 0.05 if busy else None


def _redraw() -> None:
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()


def _heard(_block: Any) -> None:
    global _touched
    _touched = True


# For the other rooms.


def refresh(scene: Any) -> None:
    """Shows what an operator has changed; scripts need no update for it."""
    _guarded(lambda: (_sync(scene), _publish(scene)))


def translation(scene: Any) -> Translation:
    """The scene as it is now."""
    return translate.translate(scene)


def frame(scene: Any, number: int) -> Optional[Any]:
    """A solved frame of what is shown, or None."""
    session = _sessions.get(scene.name)
    if session is None or session.simulation is None:
        return None
    session.stop()
    return session.simulation.at(min(max(number, session.simulation.frames[0]), session.simulation.frames[-1]))


def session_of(scene: Any) -> Optional[Session]:
    return _sessions.get(scene.name)


def tell(scene: Any, cause: str, problems: Sequence[Problem]) -> None:
    """Messages that stay until their cause comes again."""
    session = _session(scene)
    if session is None:
        session = _open(scene)
    session.told[cause] = list(problems)
    _publish(scene)


def forget(scene: Any) -> None:
    """Forgets what was solved, the store too."""
    session = _sessions.pop(scene.name, None)
    properties.shown_of.pop(scene.name, None)
    if session:
        session.close()
    meshes.forget()


def forget_all() -> None:
    for session in _sessions.values():
        session.close()
    _sessions.clear()
    properties.shown_of.clear()
    meshes.forget()


def leave_all() -> None:
    """Takes off all live modifiers."""
    for owner in bpy.data.objects:
        if properties.has(owner):
            _detach(owner)


_handlers = {
    "frame_change_pre": _before_frame,
    "frame_change_post": _after_frame,
    "depsgraph_update_post": _after_update,
    "save_pre": _before_save,
    "save_post": _after_save,
    "load_pre": _before_load,
    "load_post": _after_load,
    "undo_post": _after_undo,
    "redo_post": _after_undo,
    "render_init": _begin_render,
    "render_complete": _end_render,
    "render_cancel": _end_render,
}


def register() -> None:
    properties.listeners.append(_heard)
    for name, handler in _handlers.items():
        getattr(bpy.app.handlers, name).append(handler)
    bpy.app.timers.register(_begin, first_interval=0)  # bpy.data is not there while Blender starts


def unregister() -> None:
    for name, handler in _handlers.items():
        handlers = getattr(bpy.app.handlers, name)
        if handler in handlers:
            handlers.remove(handler)
    for timer in (_begin, _show_news):
        if bpy.app.timers.is_registered(timer):
            bpy.app.timers.unregister(timer)
    properties.listeners.remove(_heard)
    forget_all()
    if hasattr(bpy.data, "objects"):
        leave_all()
