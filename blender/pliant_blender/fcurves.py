"""F-curves as curves of pliant, and curves as F-curves: the one place that knows where actions keep them."""

from __future__ import annotations

import json
import os
import re
import tempfile
from functools import lru_cache
from math import degrees, radians
from typing import Any, Dict, List, NamedTuple, Optional, Sequence, Set, Tuple, Union

import bpy
import numpy as np

from . import blender_curves, pliant

Place = Tuple[str, int]  # data path and index
Value = Any  # a number, three, a bool, or a pliant.Curve

_name_of = {"step": "CONSTANT", "stepNext": "CONSTANT", "linear": "LINEAR", "bezier": "BEZIER", "cubicBezier": "BEZIER"}
_shortest = lru_cache(maxsize=1 << 14)(blender_curves.shortest)
_true = 1 - 2.0**-23  # above it a number is true, as Blender has it


class Sampled(Exception):
    """Why a channel cannot be read key by key, as one clause."""


class Request(NamedTuple):
    """The arguments of `read`."""

    fcurves: Sequence[Any]
    statics: Sequence[float]
    kind: str = "number"
    scale: float = 1.0


# What is there.


def _plays(fcurve: Any) -> bool:
    group = fcurve.group
    return not (fcurve.mute or fcurve.is_empty or not fcurve.is_valid or (group and getattr(group, "mute", False)))


def table(animation_data: Any) -> Dict[Place, Any]:
    """The F-curves of the one action that play, by data path and index."""
    if not animation_data or not animation_data.action:
        return {}
    return {(each.data_path, each.array_index): each for each in _fcurves_of(animation_data) if _plays(each)}


def _fcurves_of(animation_data: Any) -> List[Any]:
    if getattr(animation_data, "action_slot", True) is None:
        return []  # an action with slots, none of which is chosen
    return blender_curves.fcurves_of(animation_data)


def blockers(owner: Any) -> str:
    """Why no F-curve of this data-block counts key by key; empty: nothing."""
    animation = owner.animation_data
    if not animation:
        return ""
    if animation.use_tweak_mode:
        return "an action of the NLA that is being edited"
    if animation.use_nla:
        tracks = list(animation.nla_tracks)
        solo = [each for each in tracks if each.is_solo]
        if any(len(each.strips) for each in (solo or tracks) if solo or not each.mute):
            return "strips of the NLA"
    if animation.action and animation.action_blend_type != "REPLACE":
        return f"an action that is blended by {animation.action_blend_type}"
    if animation.action and animation.action_influence != 1:
        return f"an action with an influence of {animation.action_influence:g}"
    return ""


def drivers(owner: Any) -> Set[Place]:
    """What unmuted drivers set."""
    animation = owner.animation_data
    return {(each.data_path, each.array_index) for each in animation.drivers if not each.mute} if animation else set()


def unscalable(fcurve: Any) -> str:
    """Why its values are not proportional to those of its keys; empty: they are."""
    for each in fcurve.modifiers:
        if not each.mute and each.type != "CYCLES":
            return f"the F-modifier {each.type} moves it too"
    return "" if len(fcurve.keyframe_points) else "an F-curve of samples moves it"


@lru_cache(maxsize=64)
def _buffers(count: int) -> Tuple[Any, ...]:
    """Memory for keys: numbers, words, and the parts of those that all keys use, and that easings do, by name."""
    numbers, words, parts, start = np.empty(9 * count, np.float32), np.empty(2 * count, np.int32), [], 0
    names = (("co", 2), ("handle_left", 2), ("handle_right", 2), ("back", 1), ("amplitude", 1), ("period", 1))
    for name, size in names:
        parts.append((name, numbers[start : start + size * count]))
        start += size * count
    return numbers, words, parts[:3] + [("interpolation", words[:count])], parts[3:] + [("easing", words[count:])]


def state(fcurve: Any) -> Tuple[Any, ...]:
    """A fingerprint of all that an F-curve is: equal if its values are. Not of what a driver depends on."""
    points = fcurve.keyframe_points
    count = len(points)
    numbers, words, parts, more = _buffers(count) if count < 1000 else _buffers.__wrapped__(count)
    for name, part in parts:
        points.foreach_get(name, part)
    has_easing = words[:count].tobytes().strip(b"\0\1\2")  # beyond CONSTANT, LINEAR and BEZIER
    if has_easing:
        for name, part in more:
            points.foreach_get(name, part)
    else:
        numbers, words = numbers[: 6 * count], words[:count]
    modifiers = tuple(_frozen(each) for each in fcurve.modifiers) if fcurve.modifiers else ()
    if not count and len(fcurve.sampled_points):
        samples = np.empty(2 * len(fcurve.sampled_points), np.float32)
        fcurve.sampled_points.foreach_get("co", samples)
        modifiers += (samples.tobytes(),)
    return fcurve.extrapolation, numbers.tobytes(), words.tobytes(), modifiers


@lru_cache(maxsize=None)
def _properties(kind: str) -> Tuple[Tuple[str, str], ...]:
    """Those of a class of Blender, with their kinds."""
    rows = [
        (each.identifier, "ARRAY" if getattr(each, "is_array", False) else each.type)
        for each in getattr(bpy.types, kind).bl_rna.properties
    ]
    return tuple(row for row in rows if row[1] != "POINTER" and row[0] not in ("active", "show_expanded", "name"))


def _frozen(part: Any) -> Tuple[Any, ...]:
    """The values of all properties, which can be compared and hashed."""
    values: List[Any] = []
    for name, kind in _properties(type(part).__name__):
        value = getattr(part, name)
        if kind == "COLLECTION":
            values += [_frozen(each) for each in value]
        else:
            values.append(tuple(value) if kind == "ARRAY" else value)
    return tuple(values)


# Reading.


class _Known:
    """Results by what they were made of; the oldest go first."""

    def __init__(self, most_bytes: int):
        self.most_bytes, self.bytes = most_bytes, 0
        self.results: Dict[Any, Any] = {}

    def put(self, key: Any, result: Any) -> None:
        self.results[key] = result
        self.bytes += self._size(key)
        while self.bytes > self.most_bytes:
            oldest = next(iter(self.results))
            del self.results[oldest]
            self.bytes -= self._size(oldest)

    @staticmethod
    def _size(key: Any) -> int:
        return 500 + sum(len(each[1]) for each in key[3] if each)


_known = _Known(8 << 20)


def constant(statics: Sequence[float], kind: str = "number", scale: float = 1.0, is_single: bool = True) -> Value:
    """The value of a property without F-curves. Single precision gets the fewest digits, as in keys."""
    if kind == "switch":
        return bool(statics[0] > _true)
    numbers = [(_shortest(each + 0.0) if is_single else float(each)) * scale for each in statics]
    if kind == "rotation":
        numbers = [degrees(each) for each in numbers]
    return tuple(numbers) if len(numbers) > 1 else numbers[0]


def read(fcurves: Sequence[Any], statics: Sequence[float], *, kind: str = "number", scale: float = 1.0) -> Value:
    """The value of a channel; `statics` where there is no F-curve. Raises Sampled.

    `kind`: number, vector, switch, or rotation: radians, which become degrees. `scale` multiplies values.
    """
    result = read_many([Request(fcurves, statics, kind, scale)])[0]
    if isinstance(result, Sampled):
        raise result
    return result


def read_many(requests: Sequence[Request]) -> List[Union[Value, Sampled]]:
    """As `read` of each, in one go; a Sampled instead of a value where `read` raises it."""
    results: List[Any] = [None] * len(requests)
    missing: List[Tuple[int, Request, Any]] = []
    for number, (fcurves, statics, kind, scale) in enumerate(requests):
        if not any(fcurves):
            results[number] = constant(statics, kind, scale)
            continue
        key = kind, scale, tuple(statics), tuple(state(each) if each else None for each in fcurves)
        if key in _known.results:
            results[number] = _known.results[key]
        else:
            missing.append((number, Request(fcurves, statics, kind, scale), key))
    for (number, _, key), result in zip(missing, _read_all([request for _, request, _ in missing])):
        results[number] = result
        _known.put(key, result)
    return [Sampled(each) if isinstance(each, str) else each for each in results]


def _read_all(requests: Sequence[Request]) -> List[Union[Value, str]]:
    """Values, or why there is none."""
    results: List[Any] = [None] * len(requests)
    shapes: Dict[Tuple[int, int], Dict[str, Any]] = {}
    for number, request in enumerate(requests):
        try:
            own = [_shape_of(each, request) if each else None for each in request.fcurves]
        except Sampled as error:
            results[number] = str(error)
            continue
        shapes.update({(number, index): each for index, each in enumerate(own) if each})
    curves = _curves_of(shapes)
    for number, request in enumerate(requests):
        if results[number] is None:
            own = [curves.get((number, index)) for index in range(len(request.fcurves))]
            wrong = [each for each in own if isinstance(each, str)]
            results[number] = wrong[0] if wrong else _joined(own, request)
    return results


def _shape_of(fcurve: Any, request: Request) -> Dict[str, Any]:
    """An F-curve for the module's reader. Raises Sampled for what that does not see."""
    _check_modifiers(fcurve)
    points = fcurve.keyframe_points
    if not len(points):
        raise Sampled("an F-curve of samples")
    shape = blender_curves.shape_of(fcurve)
    keys = shape["keys"]
    if any(key["interpolation"] == "CONSTANT" for key in keys):
        # Blender takes a frame so close to a key for the key's: a step must not come a frame later.
        for key in keys:
            frame = key["co"][0]
            key["co"][0] = float(round(frame)) if abs(frame - round(frame)) < 1e-4 else frame
    if shape["extrapolation"] == "LINEAR":
        # A long line follows a short handle: its slope is exact, not to the fewest digits.
        for key, point, name in ((keys[0], points[0], "left"), (keys[-1], points[-1], "right")):
            tip = getattr(point, f"handle_{name}")
            key[name] = [own + (to - at) for own, at, to in zip(key["co"], point.co, tip)]
    if request.kind == "switch":
        return _switch_of(fcurve, shape)
    for key, following in zip(keys, keys[1:]):
        change = following["co"][1] - key["co"][1]
        if key["interpolation"] == "ELASTIC" and change <= 0 and key["amplitude"] > -change:
            raise Sampled("an ELASTIC that falls by less than its amplitude")
    if request.scale != 1:
        for key in keys:
            for name in ("co", "left", "right"):
                key[name][1] *= request.scale
            if "amplitude" in key:
                key["amplitude"] *= abs(request.scale)
    if request.kind == "rotation":
        shape["unit"] = "ROTATION"
    return shape


def _check_modifiers(fcurve: Any) -> None:
    modifiers = [each for each in fcurve.modifiers if not each.mute]
    if len(modifiers) > 1:
        raise Sampled("several F-modifiers")
    if not modifiers:
        return
    modifier = modifiers[0]
    if modifier.type != "CYCLES":
        raise Sampled(f"the F-modifier {modifier.type}")
    if modifier.use_restricted_range:
        raise Sampled("the F-modifier CYCLES with a restricted range")
    if modifier.use_influence and modifier.influence != 1:
        raise Sampled("the F-modifier CYCLES with an influence of its own")


def _switch_of(fcurve: Any, shape: Dict[str, Any]) -> Dict[str, Any]:
    keys = shape["keys"]
    counted = keys if shape["extrapolation"] == "LINEAR" else keys[:-1]
    if any(key["interpolation"] != "CONSTANT" for key in counted):
        raise Sampled("keys of a switch that are not CONSTANT")
    for key, point in zip(keys, fcurve.keyframe_points):
        value = point.co[1]
        if value not in (0, 1):
            value = fcurve.evaluate(point.co[0])  # Blender rounds some curves of switches
        key["co"][1] = key["left"][1] = key["right"][1] = float(value > _true)
        key["interpolation"] = "CONSTANT"
    cycles = shape.get("cycles", {})
    if "REPEAT_OFFSET" in (cycles.get("before"), cycles.get("after")) and fcurve.keyframe_points[0].co[1] != (
        fcurve.keyframe_points[-1].co[1]
    ):
        raise Sampled("copies of a switch with an offset")
    return {**shape, "discrete": True}


def _curves_of(shapes: Dict[Any, Dict[str, Any]]) -> Dict[Any, Any]:
    """Curves by the keys of `shapes`; a text where there is none: why."""
    if not shapes:
        return {}
    names = {f"c{number}": key for number, key in enumerate(shapes)}
    document = {
        "format": "blender-curves",
        "version": 1,
        "fps": 24,
        "curves": [{"data_path": name, **shapes[key]} for name, key in names.items()],
    }
    path = _temporary()
    try:
        with open(path, "w", encoding="utf-8") as file:
            file.write(json.dumps(document))
        found = pliant.read_curves(path, fps=24)
    except pliant.Error as error:
        if len(shapes) == 1:
            return {key: error.message for key in shapes}
        return {key: curve for one in shapes for key, curve in _curves_of({one: shapes[one]}).items()}
    finally:
        os.unlink(path)
    curves: Dict[Any, Any] = {names[each.name]: each.curve for each in found.curves}
    for loss in found.losses:
        curves[names[loss.curve]] = _reason_of(loss.message)
    return curves


def _temporary() -> str:
    handle, path = tempfile.mkstemp(suffix=".json", prefix="pliant", dir=bpy.app.tempdir)
    os.close(handle)
    return path


def _reason_of(message: str) -> str:
    if "copies" in message:
        return "counted CYCLES that end elsewhere"
    return "several keys on one frame" if "several keys" in message else message


def _joined(curves: Sequence[Any], request: Request) -> Union[Value, str]:
    """The curve of one, or of three as a vector's; a text: why there is none."""
    if request.kind == "switch":  # whose keys have no handles in a scene file
        keys = [pliant.Key(each.frame, each.value, interpolation=each.interpolation) for each in curves[0].keys]
        return pliant.Curve(keys, before=curves[0].before, after=curves[0].after)
    if len(curves) == 1:
        return curves[0]
    rest = constant(request.statics, request.kind, request.scale)
    keys = [each.keys if each else None for each in curves]
    lists = [each for each in keys if each]
    sides = [_side(curves, keys, is_before) for is_before in (True, False)]
    if len({len(each) for each in lists}) > 1 or not all(sides):
        return "keys of its components differ"
    joined, enters = [], False
    for number, row in enumerate(zip(*lists)):
        model = row[0]
        leaves = number + 1 < len(lists[0]) and model.interpolation == "bezier"
        looks = [_look(each[number], each[number + 1 : number + 2], enters, leaves) for each in lists]
        numbers = [look[1] for look in looks if look[1]]
        if any(look[0] != looks[0][0] for look in looks) or any(each != numbers[0] for each in numbers):
            return "keys of its components differ"
        parts = [each[number] if each else None for each in keys]
        tips = [[getattr(each, name)[1] if each else 0.0 for each in parts] for name in ("in_handle", "out_handle")]
        joined.append(
            pliant.Key(
                model.frame,
                tuple(each.value if each else rest[index] for index, each in enumerate(parts)),
                interpolation=model.interpolation,
                in_handle=(model.in_handle[0], *tips[0]),
                out_handle=(model.out_handle[0], *tips[1]),
                **dict(zip(("amplitude", "period", "back"), numbers[0] if numbers else _numbers(model))),
            )
        )
        enters = leaves
    return pliant.Curve(joined, before=sides[0], after=sides[1], overshoot="contain")


def _look(key: Any, following: Sequence[Any], enters: bool, leaves: bool) -> Tuple[Any, ...]:
    """What must be the same in all components, and the numbers of an easing, which mean nothing without a change."""
    handles = key.in_handle[0] if enters else 0, key.out_handle[0] if leaves else 0
    has_change = following and following[0].value != key.value
    return (key.frame, key.interpolation, handles), _numbers(key) if has_change else None


def _numbers(key: Any) -> Tuple[Any, ...]:
    return key.amplitude, key.period, key.back


def _side(curves: Sequence[Any], keys: Sequence[Any], is_before: bool) -> str:
    """What a vector does before or after its keys; empty: its components differ in what a vector cannot."""
    words = {each.before if is_before else each.after for each in curves if each}
    ends = {each[0].in_handle[0] if is_before else each[-1].out_handle[0] for each in keys if each}
    word = next(iter(words))
    if len(words) == 1 and not word.startswith("slope") and (word != "linearOuter" or len(ends) == 1):
        return word
    if not {each.split()[0] for each in words} <= {"hold", "slope", "linearOuter"}:
        return ""
    frames = [each and (each[0].frame - 1 if is_before else each[-1].frame + 1) for each in keys]
    return "slope " + " ".join(repr(each.velocity(frame) if each else 0.0) for each, frame in zip(curves, frames))


def sampled(frames: Sequence[int], values: Any, *, kind: str = "number") -> Value:
    """Values at whole frames in a row as a curve of lines, or of steps; a constant if they are all the same.

    `values`: (n,) or (n, 3), in radians for a rotation. Single precision keeps the fewest digits.
    """
    numbers = np.asarray(values, float)
    if kind == "switch":
        numbers = (numbers > _true).astype(float)
    is_single = bool((numbers == numbers.astype(np.float32)).all())
    rows = numbers.reshape(len(frames), -1)
    same = (rows[1:] == rows[:-1]).all(axis=1)
    if same.all():
        return constant(rows[0], kind, is_single=is_single)
    # Of values that stay, lines need both ends.
    stays = same if kind == "switch" else np.append(same[1:] & same[:-1], False)
    joints = ~np.concatenate([[False], stays])
    word = "step" if kind == "switch" else "linear"
    keys = []
    for index in np.flatnonzero(joints):
        value = constant(rows[index], kind, is_single=is_single)
        keys.append(pliant.Key(float(frames[index]), float(value) if kind == "switch" else value, interpolation=word))
    return pliant.Curve(keys)


# Writing.


def new(owner: Any, data_path: str, index: int = 0) -> Any:
    """An empty F-curve, in place of one that may be there."""
    return blender_curves.new_fcurve(owner, data_path, index)


def ensure(owner: Any, data_path: str, index: int = 0) -> Any:
    """The F-curve of a property with the keys that it has, also one that is muted; a new one if there is none."""
    animation = owner.animation_data
    for each in _fcurves_of(animation) if animation and animation.action else ():
        if (each.data_path, each.array_index) == (data_path, index):
            return each
    return new(owner, data_path, index)


def collections_of(action: Any) -> List[Any]:
    """Where the F-curves of an action are, whatever they move."""
    if not hasattr(action, "layers"):
        return [action.fcurves]
    return [bag.fcurves for layer in action.layers for strip in layer.strips for bag in strip.channelbags]


def remove(owner: Any, data_path: str) -> None:
    """Removes the F-curves of a property, and an action that is empty then and nobody else's."""
    animation = owner.animation_data
    if not animation or not animation.action or getattr(animation, "action_slot", True) is None:
        return
    action, found = animation.action, False
    for collection in blender_curves.collections_of(animation):
        for each in [each for each in collection if each.data_path == data_path]:
            collection.remove(each)
            found = True
    if not found or len(blender_curves.fcurves_of(animation)):
        return
    if action.users == 1 and not action.use_fake_user and len(getattr(action, "slots", ())) < 2:
        animation.action = None
        bpy.data.actions.remove(action)
        if not animation.drivers and not animation.nla_tracks:
            owner.animation_data_clear()


def write(
    owner: Any, data_path: str, value: Value, *, size: int, kind: str = "number", first: int, last: int, name: str
) -> List[str]:
    """Sets a property, and makes F-curves of a Curve or a Path. Returns notes.

    `size`: 1 or 3; `kind`: as of `read`. `first` to `last` are the frames that count; `name` is that of the channel.
    """
    if isinstance(value, pliant.Path) and not isinstance(value.progress, pliant.Curve):
        value = value.at(value.progress)
    if not isinstance(value, (pliant.Curve, pliant.Path)):
        remove(owner, data_path)
        _set(owner, data_path, _of_blender(np.asarray(value, float), kind))
        return []
    frames = np.arange(int(np.floor(first)) - 1, int(np.ceil(last)) + 2)
    values = _of_blender(_values_of(value, frames), kind).reshape(len(frames), size)
    _set(owner, data_path, values[1] if size > 1 else values[1, 0])
    try:
        shapes = _shapes_of(value, kind, float(frames[0]), float(frames[-1]))
        for index, shape in enumerate(shapes):
            fcurve = new(owner, data_path, index)
            blender_curves.fill(fcurve, shape)
            _check_filled(fcurve, frames, values[:, index], kind)
    except Sampled as reason:
        for index in range(size):
            _fill_sampled(new(owner, data_path, index), frames, values[:, index], kind)
        return [f"{name}: sampled: {reason}"]
    return []


def _values_of(value: Any, frames: Any) -> Any:
    if isinstance(value, pliant.Path):
        return np.array([value.at(each) for each in value.progress(frames.astype(float))])
    return np.asarray(value(frames.astype(float)))


def _of_blender(numbers: Any, kind: str) -> Any:
    if kind == "switch":
        return (numbers > _true).astype(float)
    return np.radians(numbers) if kind == "rotation" else numbers


def _set(owner: Any, data_path: str, value: Any) -> None:
    parent, _, name = data_path.rpartition(".")
    holder = owner.path_resolve(parent) if parent else owner
    is_switch = holder.bl_rna.properties[name].type == "BOOLEAN"
    setattr(holder, name, bool(value) if is_switch else value.tolist())


def _shapes_of(value: Any, kind: str, first: float, last: float) -> List[Dict[str, Any]]:
    """F-curves, one for each component, as the module writes them. Raises Sampled with what Blender has not."""
    if isinstance(value, pliant.Path):
        raise Sampled("a path")
    if value.loop:
        raise Sampled("an inner loop")
    words = ["", *(key.interpolation for key in value.keys)]
    if any(key.left not in (None, key.value) and word != "step" for key, word in zip(value.keys, words)):
        raise Sampled("a value from the left")
    if len(value.keys) == 1:
        shapes = _single_keys_of(value, kind)
    else:
        shapes = _written(value, kind, first, last)
    for shape in shapes:
        _restore_words(shape, value.keys, kind)
        _lengthen(shape)
    return shapes


def _single_keys_of(value: Any, kind: str) -> List[Dict[str, Any]]:
    """As `_written`; Blender has lines beside a single key."""
    frame = value.keys[0].frame
    numbers = [_of_blender(np.atleast_1d(each), kind).tolist() for each in (
        value(frame), value.velocity(frame - 1), value.velocity(frame + 1))]  # fmt: skip
    return [
        {
            "extrapolation": "LINEAR" if before or after else "CONSTANT",
            "keys": [
                {
                    "co": [frame, own],
                    "left": [frame - 1, own - before],
                    "right": [frame + 1, own + after],
                    "interpolation": "BEZIER",
                }
            ],
        }
        for own, before, after in zip(*numbers)
    ]


def _written(value: Any, kind: str, first: float, last: float) -> List[Dict[str, Any]]:
    path = _temporary()
    try:
        channel = "c.rotate" if kind == "rotation" else "c.magnitude"
        # What must be fitted is sampled, so that no fit need be good.
        losses = pliant.write_curves({channel: value}, path, first=first, last=last, tolerance=0.1)
        with open(path, encoding="utf-8") as file:
            shapes = json.load(file)["curves"]
    except pliant.Error as error:
        raise Sampled(error.message) from error
    finally:
        os.unlink(path)
    has_jumps = any(key.interpolation == "stepNext" for key in value.keys)
    for loss in losses:
        is_jump = has_jumps and "jump" in loss.message
        if (not loss.is_exact and not is_jump) or "overlong" in loss.message:
            raise Sampled(re.split(",? (?:became|changed too fast|was shortened)", loss.message)[0])
    return shapes


def _restore_words(shape: Dict[str, Any], keys: Sequence[Any], kind: str) -> None:
    """Interpolations of the keys at both ends, which say nothing of the values but beside lines."""
    own = shape["keys"]
    for key, following in zip(own, own[1:]):
        if key["interpolation"] == "ELASTIC" and key["co"][1] == following["co"][1]:
            key["amplitude"] = 0  # or Blender swings
    if len(own) != len(keys):
        return
    cycles = shape.get("cycles", {})

    def follows(side: str) -> bool:
        """Whether a line, not copies, is on this side."""
        is_endless = cycles.get(side, "NONE") != "NONE" and cycles[f"{side}_count"] == 0
        return shape["extrapolation"] == "LINEAR" and not is_endless

    if keys[0].interpolation == "linear" and len(own) > 1:
        if not follows("before") or _is_straight(own[0]["co"], own[1]["co"], own[0]["left"]):
            own[0]["interpolation"] = "LINEAR"
    word, end = keys[-1].interpolation, own[-1]
    if follows("after"):
        if word in ("step", "stepNext") and end["right"][1] != end["co"][1]:
            return
        if word == "linear" and not (len(own) > 1 and _is_straight(own[-2]["co"], end["co"], end["right"])):
            return
    if word in _name_of:
        end["interpolation"] = _name_of[word]
        return
    ease, side = next((word[: -len(each)], each) for each in ("InOut", "In", "Out") if word.endswith(each))
    end["interpolation"], end["easing"] = ease.upper(), {"In": "EASE_IN", "Out": "EASE_OUT"}.get(side, "EASE_IN_OUT")
    for name in ("back", "amplitude", "period"):
        number = getattr(keys[-1], name)
        if number is not None:
            end[name] = radians(number) if name == "amplitude" and kind == "rotation" else number


def _lengthen(shape: Dict[str, Any]) -> None:
    """Lines beyond the keys follow these handles, with an error of their tips in single precision."""
    if shape["extrapolation"] == "LINEAR":
        for key, name in ((shape["keys"][0], "left"), (shape["keys"][-1], "right")):
            key[name] = [at + 16 * (tip - at) for at, tip in zip(key["co"], key[name])]


def _is_straight(start: Any, end: Any, tip: Any) -> bool:
    """Whether a tip is on the line through both points."""
    slope = (end[1] - start[1]) / (end[0] - start[0])
    rise = start[1] + slope * (tip[0] - start[0])
    return abs(rise - tip[1]) <= 1e-6 * max(abs(end[1] - start[1]), abs(slope))


def _check_filled(fcurve: Any, frames: Any, values: Any, kind: str) -> None:
    """Raises Sampled if Blender makes other values of the keys, which it computes in single precision."""
    found = np.array([fcurve.evaluate(each) for each in frames.tolist()])
    if kind == "switch":
        found = (found > _true).astype(float)
    slack = 2e-6 * (values.max() - values.min()) + 2.0**-23 * abs(values).max()
    wrong = np.flatnonzero(~(abs(found - values) <= slack))
    if len(wrong):
        k = wrong[0]
        raise Sampled(f"Blender's single precision makes {found[k]:g} of {values[k]:g} on frame {frames[k]}")


def _fill_sampled(fcurve: Any, frames: Any, values: Any, kind: str) -> None:
    points = fcurve.keyframe_points
    points.add(len(frames))
    points.foreach_set("co", np.column_stack([frames, values]).astype(np.float32).ravel())
    rows = type(points[0]).bl_rna.properties
    for name, word in (
        ("interpolation", "CONSTANT" if kind == "switch" else "LINEAR"),
        ("handle_left_type", "VECTOR"),
        ("handle_right_type", "VECTOR"),
    ):
        points.foreach_set(name, np.full(len(frames), rows[name].enum_items[word].value, np.int32))
    fcurve.update()
