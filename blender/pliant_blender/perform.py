"""Performing: the scene plays, and what is dragged meanwhile becomes keys."""

from __future__ import annotations

import time
from typing import Any, Dict, Iterator, List, NamedTuple, Optional, Set, Tuple

import bpy
from bpy.props import EnumProperty

from . import edit, fcurves, live, properties

_speeds = {"FULL": 1.0, "HALF": 0.5, "QUARTER": 0.25}
_rotations = {"QUATERNION": "rotation_quaternion", "AXIS_ANGLE": "rotation_axis_angle"}
# What would change the frame, the file or the undo steps meanwhile.
_kept_keys = {"SPACE", "LEFT_ARROW", "RIGHT_ARROW", "UP_ARROW", "DOWN_ARROW"}
_kept_with_ctrl = {"Z", "Y", "S", "O", "N", "Q", "W"}


class Channel(NamedTuple):
    owner: str
    path: str
    index: int  #: -1: a single number


def _channels(scene: Any) -> Iterator[Tuple[Channel, float]]:
    """All that can be dragged, with its value."""
    for owner in scene.objects:
        if owner.library:
            continue
        name = owner.name
        for path in ("location", _rotations.get(owner.rotation_mode, "rotation_euler"), "scale"):
            for index, number in enumerate(getattr(owner, path)):
                yield Channel(name, path, index), number
        role = properties.role(owner)
        if role == "NONE":
            continue
        more = properties.TANGENTS if role == "SURFACE" else ()
        for path in (*properties.KEYABLE[role], *more):
            value = getattr(owner.pliant, path)
            if isinstance(value, float):
                yield Channel(name, f"pliant.{path}", -1), value
            elif not isinstance(value, bool):
                for index, number in enumerate(value):
                    yield Channel(name, f"pliant.{path}", index), number


def _set(channel: Channel, value: float) -> None:
    owner = bpy.data.objects.get(channel.owner)
    if owner is None:
        return
    holder, _, name = channel.path.rpartition(".")
    block = getattr(owner, holder) if holder else owner
    if channel.index < 0:
        setattr(block, name, value)
    else:
        getattr(block, name)[channel.index] = value


class Performance:
    """What is being performed, in names and numbers: Blender's objects may go meanwhile.

    A channel that is dragged gets a key at each frame, in a copy of the action, so that the surface moves as it
    will with the keys that are made in the end.
    """

    def __init__(self, scene: Any, speed: float):
        self.scene = scene.name
        self.first, self.last = scene.frame_current, scene.pliant.frame_end
        self.period = scene.render.fps_base / scene.render.fps / speed
        self.has_ended = False
        self.before = dict(_channels(scene))
        self.seen = dict(self.before)
        self.values: Dict[Channel, List[float]] = {channel: [] for channel in self.before}
        self.touched: Set[Channel] = set()
        self.actions: Dict[str, Optional[str]] = {}  # what the owners of copies had; None: no animation at all
        self.copies: List[str] = []
        self.due = time.monotonic() + self.period
        # What is dragged would make undo steps of its own.
        edits, self.was_changed = bpy.context.preferences.edit, bpy.context.preferences.is_dirty
        self.had_undo, edits.use_global_undo = edits.use_global_undo, False
        bpy.app.timers.register(self.tick, first_interval=self.period)

    def tick(self) -> Optional[float]:
        """Goes on by a frame."""
        scene = bpy.data.scenes.get(self.scene)
        if scene is None or _running is not self:
            return None
        self.take(scene)
        if scene.frame_current >= self.last:
            self.has_ended = True
            return None
        scene.frame_set(scene.frame_current + 1)
        self.seen = dict(_channels(scene))
        self.due = max(self.due + self.period, time.monotonic())
        return max(self.due - time.monotonic(), 0.001)

    def take(self, scene: Any) -> None:
        """Takes the values of the current frame, and keys for what was dragged."""
        count = scene.frame_current - self.first + 1
        if count < 1:  # somebody went to a frame ahead of the first
            return
        for channel, value in _channels(scene):
            values = self.values.get(channel)
            if values is None:
                continue
            while len(values) < count - 1:  # or over some
                values.append(values[-1] if values else self.before[channel])
            if value != self.seen.get(channel, value) and channel not in self.touched:
                self.touched.add(channel)
                self._begin(channel, [*values[: count - 1], value])
            del values[count - 1 :]
            values.append(value)
            if channel in self.touched:
                self._key(channel, scene.frame_current, value)

    def _curve(self, channel: Channel) -> Any:
        owner = bpy.data.objects[channel.owner]
        place = channel.path, max(channel.index, 0)
        curve = fcurves.ensure(owner, *place)  # of a copy of the action
        curve.mute = False
        return curve

    def _begin(self, channel: Channel, values: List[float]) -> None:
        """Lets nothing but the values so far move a channel from the first frame on."""
        owner = bpy.data.objects[channel.owner]
        if owner.name not in self.actions:
            animation = owner.animation_data
            action = animation.action if animation else None
            self.actions[owner.name] = None if animation is None else action.name if action else ""
            if action:
                animation.action = action.copy()
                self.copies.append(animation.action.name)
        curve = self._curve(channel)
        for modifier in list(curve.modifiers):
            curve.modifiers.remove(modifier)
        for point in reversed([each for each in curve.keyframe_points if each.co[0] >= self.first]):
            curve.keyframe_points.remove(point, fast=True)
        curve.extrapolation = "CONSTANT"
        for frame, value in enumerate(values, self.first):
            self._key(channel, frame, value)

    def _key(self, channel: Channel, frame: int, value: float) -> None:
        if channel.owner not in bpy.data.objects:
            return
        curve = self._curve(channel)
        curve.keyframe_points.insert(frame, value, options={"FAST"}).interpolation = "LINEAR"
        curve.update()

    def restore(self) -> None:
        """The scene as it was, but for the frame."""
        for name, kept in self.actions.items():
            owner = bpy.data.objects.get(name)
            if owner is None or owner.animation_data is None:
                continue
            made = owner.animation_data.action
            owner.animation_data.action = bpy.data.actions.get(kept) if kept else None
            if made and not made.users:
                bpy.data.actions.remove(made)
            if kept is None:
                owner.animation_data_clear()
        for channel in self.touched:
            _set(channel, self.before[channel])

    def keys(self, tolerance: float) -> List[str]:
        """Makes keys of what was dragged; returns why there are none for some."""
        refused = []
        for channel in sorted(self.touched):
            owner = bpy.data.objects.get(channel.owner)
            try:
                if owner:
                    edit.record(owner, channel.path, channel.index, self.values[channel], self.first, tolerance)
            except edit.Refused as error:
                refused.append(str(error))
        return refused


_running: Optional[Performance] = None
is_gripped = False  # the gizmo of a force is being dragged; view.py sets it


def is_running() -> bool:
    return _running is not None


def _stop() -> None:
    global _running
    if _running is None:
        return
    preferences = bpy.context.preferences
    preferences.edit.use_global_undo = _running.had_undo
    preferences.is_dirty = _running.was_changed
    if bpy.app.timers.is_registered(_running.tick):
        bpy.app.timers.unregister(_running.tick)
    _running = None


class PLIANT_OT_perform(bpy.types.Operator):
    """Plays from the current frame; what is dragged meanwhile becomes keys. Enter keeps them, Esc leaves nothing"""

    bl_idname, bl_label = "pliant.perform", "Perform"
    bl_options = {"UNDO"}

    speed: EnumProperty(
        name="Speed", default="FULL", description="How fast the scene plays meanwhile",
        items=[
            ("FULL", "1", "As fast as it is"),
            ("HALF", "1/2", "Half as fast"),
            ("QUARTER", "1/4", "A quarter as fast"),
        ],
    )  # fmt: skip
    tolerance: edit.keys_tolerance

    @classmethod
    def poll(cls, context: Any) -> bool:
        reason = ""
        if bpy.app.background or not context.window:
            reason = "it needs a window; scripts have pliant.record"
        elif is_running():
            reason = "it runs already: Enter keeps what was dragged, Esc leaves nothing"
        elif not any(properties.role(each) != "NONE" for each in context.scene.objects):
            reason = "there is no surface and no force"
        elif context.scene.frame_current >= context.scene.pliant.frame_end:
            reason = "the current frame is not ahead of the end"
        if reason:
            cls.poll_message_set(reason)
        return not reason

    def execute(self, context: Any) -> set:
        global _running
        if context.screen.is_animation_playing:
            bpy.ops.screen.animation_cancel(restore_frame=False)
        _running = Performance(context.scene, _speeds[self.speed])
        context.window_manager.modal_handler_add(self)
        context.workspace.status_text_set("Drag forces while it plays.   Enter: keep the keys   Esc: leave nothing")
        return {"RUNNING_MODAL"}

    def modal(self, context: Any, event: Any) -> set:
        if _running is None:
            return {"CANCELLED"}
        if event.value == "NOTHING":
            # Blender names no type of what a gizmo that is dragged lets through, and complains. What G lets through
            # are timers.
            is_free = _running.has_ended and not is_gripped and event.type == "MOUSEMOVE"
            return self._finish(context, True) if is_free else {"PASS_THROUGH"}
        is_press = event.value == "PRESS"
        if is_press and event.type == "ESC":
            return self._finish(context, False)
        if _running.has_ended or (is_press and event.type in ("RET", "NUMPAD_ENTER")):
            return self._finish(context, True)
        if event.type in _kept_keys or ((event.ctrl or event.oskey) and event.type in _kept_with_ctrl):
            return {"RUNNING_MODAL"}
        return {"PASS_THROUGH"}

    def _finish(self, context: Any, is_kept: bool) -> set:
        performance = _running
        scene = bpy.data.scenes.get(performance.scene)
        if scene and is_kept:
            performance.take(scene)
        _stop()
        context.workspace.status_text_set(None)
        performance.restore()
        if scene is None:
            return {"CANCELLED"}
        is_kept = is_kept and bool(performance.touched)
        if is_kept:
            for each in performance.keys(self.tolerance):
                self.report({"WARNING"}, each)
        scene.frame_set(scene.frame_current if is_kept else performance.first)
        live.refresh(scene)
        return {"FINISHED" if is_kept else "CANCELLED"}

    def cancel(self, context: Any) -> None:
        if _running:
            _running.restore()
        _stop()
        context.workspace.status_text_set(None)


CLASSES = (PLIANT_OT_perform,)


def register() -> None:
    for cls in CLASSES:
        bpy.utils.register_class(cls)


def unregister() -> None:
    _stop()
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
