"""Curves: keys compiled into exact values."""

import functools
import pickle
import signal
import sys
import threading
import time

import numpy as np
import pytest

import pliant


@pytest.fixture
def curve():
    return pliant.Curve(
        [
            (0, 0),
            pliant.Key(4, 10, interpolation="linear"),
            pliant.Key(8, -3, tangent="flat", out_length=1.5),
            pliant.Key(13, 5, interpolation="elasticOut", amplitude=6, period=2, in_handle=(-2, 1)),
            pliant.Key(20, 1, interpolation="cubicBezier", control=(0.2, 0, 0.8, 1)),
            pliant.Key(24, 2, interpolation="step", left=4),
            pliant.Key(30, 0, in_tangent=0.5, out_tangent="spline"),
        ],
        before="repeat 2", after="slope 0.25", overshoot="contain",
    )  # fmt: skip


def vector():
    return pliant.Curve([(1, (0, 1, 2)), pliant.Key(9, (3, -1, 0), in_tangent=(1, 0, 2))], after="mirror")


def test_keys_say_what_they_were_made_of(curve):
    for each in (curve, vector()):
        again = pliant.Curve(each.keys, before=each.before, after=each.after, overshoot=each.overshoot, loop=each.loop)
        assert again == each and again.keys == each.keys and hash(again) == hash(each)
        assert pickle.loads(pickle.dumps(each)) == each
        assert eval(repr(each.keys), {"Key": pliant.Key}) == each.keys
    assert curve.before == "repeat 2" and curve.after == "slope 0.25" and curve.overshoot == "contain"
    looped = pliant.Curve([(0, 0), (2, 1), (4, 0)], loop=pliant.Loop(0, 4, after=3, offset=1))
    assert looped.loop == pliant.Loop(0, 4, after=3, offset=1)
    assert pliant.Curve(looped.keys, loop=looped.loop) == looped


def test_an_array_has_the_values_of_its_frames(curve):
    frames = np.concatenate([np.random.default_rng(3).uniform(-20, 50, 200), [0, 4, 8, 24, 30]])
    for each in (curve, vector()):
        for evaluate in (each, each.left_value, each.velocity, each.left_velocity):
            together = evaluate(frames)
            assert together.shape == (205,) + (3,) * (each.dimension == 3)
            for frame, value in zip(frames, together):
                assert np.array_equal(evaluate(frame), value)
            assert np.array_equal(evaluate(list(frames)), together)
            assert np.array_equal(evaluate(frames.astype(np.float64)[::-1])[::-1], together)
    assert type(curve(3)) is float and vector()(3).shape == (3,)
    for wrong in (np.nan, [1, np.inf]):
        with pytest.raises(ValueError, match="finite"):
            curve(wrong)
    for wrong in ("a", None, [[1, 2]]):
        with pytest.raises(TypeError):
            curve(wrong)


def test_the_range_holds_all_values(curve):
    frames = np.linspace(-5, 35, 4001)
    low, high = curve.range(-5, 35)
    values = curve(frames)
    assert low <= values.min() and values.max() <= high
    low, high = vector().range(-5, 35)
    assert (vector()(frames) >= low).all() and (vector()(frames) <= high).all()


def test_errors_name_the_key():
    with pytest.raises(pliant.InvalidInput, match="key 1"):
        pliant.Curve([(1, 0), (1, 1)])
    with pytest.raises(pliant.InvalidInput):
        pliant.Curve([])
    with pytest.raises(ValueError, match="interpolation.*linear"):
        pliant.Curve([pliant.Key(1, 0, interpolation="lineal")])
    with pytest.raises(ValueError, match="before"):
        pliant.Curve([(1, 0)], before="hover")
    with pytest.raises(TypeError):
        pliant.Curve([(1, 0), (2, (1, 2, 3))])
    with pytest.raises(TypeError):
        pliant.Key(1, "high")
    for wrong in (3, [3], "ab", None):
        with pytest.raises(TypeError):
            pliant.Curve(wrong)


def test_nothing_changes_a_key_or_a_curve(curve):
    for thing, name in ((curve.keys[0], "frame"), (curve, "before"), (pliant.Loop(0, 1), "to")):
        with pytest.raises(AttributeError):
            setattr(thing, name, 3)


def test_edits_keep_what_they_promise(curve):
    plain = pliant.Curve([(0, 0), (10, 5), pliant.Key(20, -2, in_tangent=0.5)])
    frames = np.linspace(-3, 25, 400)
    assert np.allclose(plain.insert_key(7)(frames), plain(frames), rtol=0, atol=1e-12)
    assert len(plain.insert_key(7).keys) == 4
    assert plain.insert_key(7).delete_keys([1]).keys[0] == plain.keys[0]
    assert np.allclose(plain.moved(3, 2)(frames + 3), plain(frames) + 2, rtol=0, atol=1e-12)
    assert np.allclose(plain.scaled(frame=1, time_factor=2, value=1, value_factor=3)(1 + 2 * frames),
                       1 + 3 * (plain(1 + frames) - 1), rtol=0, atol=1e-11)  # fmt: skip
    assert np.allclose(plain.reversed(10)(frames), plain(20 - frames), rtol=0, atol=1e-12)
    moved = plain.move_key(1, 2, 1)
    assert (moved.keys[1].frame, moved.keys[1].value) == (12, 6)
    baked = plain.baked(0, 20)
    assert [key.frame for key in baked.keys] == list(range(21))
    few, error = baked.simplified(0, 20, 0.01)
    assert len(few.keys) < 21 and np.abs(few(frames) - baked(frames)).max() <= error <= 0.01
    with pytest.raises(pliant.InvalidInput):
        plain.delete_keys([0, 1, 2])
    with pytest.raises(pliant.InvalidInput):
        plain.move_key(1, 15, 0)


def test_handles_end_where_the_curve_bends():
    curve = pliant.Curve([pliant.Key(0, 0, out_handle=(3, 2)), (10, 5)])
    assert curve.handles[0] == (0, 0, 3, 2) and curve.handles[0].frame == 3


def test_a_path_goes_through_its_waypoints():
    points = np.array([(0, 0, 0), (1, 2, 0), (3, 1, 1), (4, 0, 0)], float)
    path = pliant.Path(points, progress=pliant.Curve([(1, 0), (10, 1)]))
    assert (path.waypoints == points).all() and not path.waypoints.flags.writeable
    assert np.allclose(path.at(0), points[0]) and np.allclose(path.at(1), points[-1])
    assert path.length > 4 and not path.closed
    assert pickle.loads(pickle.dumps(path)) == path != pliant.Path(points)
    with pytest.raises(pliant.InvalidInput, match="waypoint"):
        pliant.Path([(0, 0, 0), (0, 0, 0), (1, 1, 1)])
    with pytest.raises(ValueError):
        pliant.Path([(0, 0), (1, 1), (2, 2)])


def test_keys_are_refused_as_the_format_refuses_them():
    for match, key in (
        ("key 1 at frame 2.*interpolation", {"interpolation": "lineal"}),
        ("key 1 at frame 2.*in_tangent", {"in_tangent": "nope"}),
        ("key 1 at frame 2.*tangent", {"tangent": "nope"}),
        ("key 1 at frame 2.*in_handle must have 2", {"in_handle": (-1, 1, 2, 3)}),
        ("key 1 at frame 2.*in_length and in_handle", {"in_handle": (-1, 1), "in_length": 2}),
        ("key 1 at frame 2.*out_tangent and out_handle", {"out_handle": (1, 1), "out_tangent": 2}),
        ("key 1 at frame 2.*tangent and in_tangent", {"tangent": "flat", "in_tangent": "linear"}),
        ("key 1 at frame 2.*tangent and out_handle", {"tangent": "flat", "out_handle": (1, 1)}),
        ("key 1 at frame 2.*control.*cubicBezier", {"control": (0, 0, 1, 1)}),
        ("key 1 at frame 2.*cubicBezier.*control", {"interpolation": "cubicBezier"}),
        ("key 1 at frame 2.*amplitude.*elastic", {"amplitude": 3}),
        ("key 1 at frame 2.*back.*backIn", {"back": 3, "interpolation": "elasticIn"}),
    ):
        with pytest.raises(pliant.InvalidInput, match=match):
            pliant.Curve([(1, 0), pliant.Key(2, 1, **key), (3, 0)])
    for side in ("before", "after", "overshoot"):
        with pytest.raises(pliant.InvalidInput, match=side):
            pliant.Curve([(1, 0)], **{side: "hover"})
    with pytest.raises(TypeError, match="loop"):
        pliant.Curve([(1, 0), (2, 1)], loop=3)


def long_work():
    """Calls that take long, as functions of one argument that are not of Python, with it."""
    frames = np.linspace(0, 1000, 20_000_000)
    small = pliant.Curve([(0, 0), (500, 1), (1000, 0)])
    scene = pliant.Scene(end=5, forces=[pliant.Point("p", magnitude=small)])
    noisy = pliant.Curve([(frame, frame % 7) for frame in range(300_000)])
    yield small, frames
    yield functools.partial(pliant._core.sample, scene, "p.magnitude"), frames
    yield functools.partial(small.baked, 0, 1000), 1000 / 999_000
    yield functools.partial(noisy.simplified, 0, 300_000), 1e300


def is_ended_by_ctrl_c(work, argument):
    """Whether Ctrl-C, pressed while the work lets other threads go on, ends it before its result."""
    main = threading.get_ident()
    works = threading.Lock()
    results = []

    def interrupt():
        with works:
            signal.pthread_kill(main, signal.SIGINT)

    other = threading.Thread(target=interrupt)
    interval = sys.getswitchinterval()
    works.acquire()
    other.start()
    sys.setswitchinterval(1000)  # the other thread goes on only where the main one releases the GIL
    try:
        works.release()
        results.extend(map(work, [argument]))  # Python looks for Ctrl-C only after it has the result
        other.join()
        time.sleep(60)
    except KeyboardInterrupt:
        return not results
    finally:
        sys.setswitchinterval(interval)
        other.join()


@pytest.mark.no_sanitizer
def test_ctrl_c_ends_long_work():
    for work, argument in long_work():
        # On a busy machine the other thread may come too late, but not each time.
        assert any(is_ended_by_ctrl_c(work, argument) for _ in range(10)), work
