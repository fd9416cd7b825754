"""Threads, signals and processes."""

import os
import signal
import subprocess
import sys
import textwrap
import threading
import time

import numpy as np
import pytest

import pliant


def long_scene(size=151, end=400):
    return pliant.Scene(
        end=end,
        surfaces=[pliant.Surface("sheet", shape=pliant.Grid(size, size), dt=0.001)],
        forces=[pliant.Point("poke", magnitude=1, deformation_radius=9, force_radius=9)],
    )


def in_threads(*works):
    failures = []

    def guarded(work):
        try:
            work()
        except BaseException as caught:  # noqa: BLE001
            failures.append(caught)

    threads = [threading.Thread(target=guarded, args=(work,)) for work in works]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(60)
        assert not thread.is_alive()
    if failures:
        raise failures[0]


def run_python(code, **options):
    """Runs code in another process, in which Ctrl-C and forks do no harm."""
    return subprocess.run([sys.executable, "-c", textwrap.dedent(code)], capture_output=True, text=True, timeout=100, **options)


def test_one_call_waits_for_the_other(scene):
    straight = pliant.Simulation(scene).positions()
    simulation = pliant.Simulation(scene)

    def play(order):
        for frame in order:
            assert (simulation.at(frame)["sheet"].positions() == straight[frame - 1]).all()
            simulation.report(frame)
            simulation.warnings()

    in_threads(*[lambda order=order: play(order) for order in (range(1, 13), range(12, 0, -1), [5, 1, 9, 5])])


def test_simulations_share_a_store(scene):
    store = pliant.MemoryStore(10**7)
    straight = pliant.Simulation(scene).positions()

    def play():
        assert (pliant.Simulation(scene, store=store).positions() == straight).all()

    in_threads(*[play] * 4)


def test_custom_forces_work_in_threads_of_the_engine(scene):
    scene.surfaces.append(pliant.Surface("other", shape=pliant.Grid(9, 9, width=12, depth=10)))
    scene.forces = [pliant.Custom("own", lambda points, time: points * 0 + [0, 1, 0], magnitude=5, deformation_radius=9, force_radius=9)]
    one = pliant.Simulation(scene)
    two = pliant.Simulation(scene, threads=2)
    for name in ("sheet", "other"):
        assert (one.positions(name) == two.positions(name)).all()


def test_a_scene_may_be_edited_while_it_is_read(scene):
    done = threading.Event()

    def edit():
        k = 0
        while not done.is_set():
            k += 1
            scene["poke"].magnitude = float(k % 7)
            scene.forces = scene.forces[:1] + [pliant.Point(f"p{k % 5}", magnitude=k)] * (k % 2)

    def read():
        try:
            for _ in range(60):
                pliant.Simulation(scene).at(2)
                scene.to_xml()
        finally:
            done.set()

    in_threads(edit, read)


def test_a_call_can_be_interrupted_and_made_again():
    simulation = pliant.Simulation(long_scene())
    simulation.interrupt()  # nothing runs: nothing happens
    simulation.at(2)
    with pytest.raises(pliant.Interrupted):
        timer = threading.Timer(0.2, simulation.interrupt)
        timer.start()
        simulation.at(400)
    timer.join()
    assert (simulation.at(5)["sheet"].positions() == pliant.Simulation(long_scene()).at(5)["sheet"].positions()).all()


def test_should_stop_is_asked(scene):
    asked = []
    wants = []

    def should_stop():
        asked.append(1)
        return bool(wants)

    straight = pliant.Simulation(scene, should_stop=should_stop).positions()
    assert asked
    assert (pliant.Simulation(scene).positions() == straight).all()
    wants.append(1)
    with pytest.raises(pliant.Interrupted):
        pliant.Simulation(scene, should_stop=should_stop).positions()
    with pytest.raises(ZeroDivisionError):
        pliant.Simulation(scene, should_stop=lambda: 1 / 0).positions()


def test_ctrl_c_ends_a_call():
    done = run_python(
        """
        import os, signal, sys, threading, time
        import numpy as np, pliant
        sys.path.insert(0, "tests/python")
        from test_threads import long_scene
        simulation = pliant.Simulation(long_scene())
        straight = simulation.at(4)["sheet"].positions()
        threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
        try:
            simulation.at(400)
        except KeyboardInterrupt:
            assert (simulation.at(4)["sheet"].positions() == straight).all()
            print("ended")
        """,
        cwd=str(__import__("pathlib").Path(__file__).parents[2]),
    )
    assert done.stdout == "ended\n" and done.returncode == 0, done.stderr


@pytest.mark.forks
def test_a_child_makes_its_own(scene):
    simulation = pliant.Simulation(scene, threads=2)
    straight = simulation.positions()
    child = os.fork()
    if child == 0:
        status = 1
        try:
            try:
                simulation.at(3)
            except RuntimeError:
                if (pliant.Simulation(scene, threads=2).positions() == straight).all():
                    status = 0
        finally:
            os._exit(status)
    assert os.waitpid(child, 0)[1] == 0
    assert (simulation.positions() == straight).all()


def test_exit_is_clean_whatever_is_alive():
    done = run_python(
        """
        import threading
        import numpy as np, pliant
        scene = pliant.Scene(end=3000, surfaces=[pliant.Surface("sheet", shape=pliant.Grid(101, 101), dt=0.001)],
                             forces=[pliant.Custom("own", lambda p, t: p * 0 + 1, magnitude=1)])
        simulation = pliant.Simulation(scene)
        frame = simulation.at(2)
        view = frame["sheet"].object_positions
        live = pliant.LiveSimulation(scene)
        store = pliant.MemoryStore(1000)
        threading.Thread(target=lambda: pliant.Simulation(scene, store=store).at(3000), daemon=True).start()
        """
    )
    assert done.returncode == 0 and done.stderr == "", (done.returncode, done.stderr)


def test_exit_waits_for_the_functions_of_python_that_are_called():
    """Python ends other threads where they come back to it, in the middle of our frames."""
    done = run_python(
        """
        import threading, time
        import pliant

        simulation = pliant.Simulation(pliant.Scene(surfaces=[pliant.Surface("sheet", shape=pliant.Grid(3, 3))]))
        begun = threading.Event()

        class SlowFrame:
            def __index__(self):
                begun.set()
                time.sleep(0.3)
                print("came back", flush=True)
                return 1

        threading.Thread(target=lambda: simulation.at(SlowFrame()), daemon=True).start()
        assert begun.wait(60)
        """
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "came back\n", "")


def test_a_copy_of_the_package_works_beside_it(tmp_path):
    import pathlib
    import shutil

    package = pathlib.Path(pliant.__file__).parent
    (tmp_path / "host").mkdir()
    (tmp_path / "host" / "__init__.py").touch()
    shutil.copytree(package, tmp_path / "host" / "pliant")
    done = run_python(
        f"""
        import sys
        sys.path.insert(0, {str(tmp_path)!r})
        import pliant, host.pliant as other
        assert other is not pliant and other.Scene is not pliant.Scene
        for module in (pliant, other):
            scene = module.Scene(end=3, surfaces=[module.Surface("sheet")])
            assert module.Simulation(scene).positions().shape == (3, 9, 3)
            try:
                module.Curve([])
            except module.InvalidInput:
                pass
        """
    )
    assert done.returncode == 0, done.stderr


@pytest.mark.forks
@pytest.mark.parametrize("made", ["Simulation(scene, threads=2)", "LiveSimulation(scene, threads=2)"])
def test_a_child_lets_go_of_what_its_parent_made(made):
    done = run_python(f"""
        import os, signal, pliant
        scene = pliant.Scene(end=9, surfaces=[pliant.Surface("sheet", shape=pliant.Grid(41, 41), damping=1)])
        own = pliant.{made}
        own.at(5) if hasattr(own, "at") else own.advance()
        child = os.fork()
        if child == 0:
            signal.alarm(20)
            for use in (lambda: own.scene, lambda: own.frames, lambda: own.frame, lambda: own.interrupt()):
                try:
                    use()
                except (RuntimeError, AttributeError):
                    continue
                os._exit(3)
            own = pliant.{made}
            raise SystemExit(7)
        assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 7
        own.interrupt()
    """)
    assert done.returncode == 0, done.stderr


@pytest.mark.forks
def test_a_child_ends_at_once_while_its_parent_works():
    done = run_python("""
        import os, signal, threading, time, pliant
        scene = pliant.Scene(end=10**6, surfaces=[pliant.Surface("sheet", shape=pliant.Grid(101, 101), damping=1)])
        simulation = pliant.Simulation(scene)
        threading.Thread(target=lambda: simulation.at(10**6), daemon=True).start()
        time.sleep(0.3)
        child = os.fork()
        if child == 0:
            signal.alarm(5)
            raise SystemExit(7)
        assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 7
    """)
    assert done.returncode == 0, done.stderr

@pytest.mark.forks
def test_a_child_that_a_force_has_forked_waits_for_its_threads():
    """Its own thread was outside of Python when it forked, and has come back; others have not."""
    done = run_python("""
        import atexit, os, signal, threading, time

        told = []
        atexit.register(lambda: os._exit(7 if told else 3))  # after what pliant does at the exit
        import pliant

        class Forked(Exception):
            pass

        def fork(points, time):
            if not children:
                children.append(os.fork())
                if children[0] == 0:
                    raise Forked
            return 0 * points

        def rest(points, when):
            inside.set()
            time.sleep(0.3)
            told.append(1)
            return 0 * points

        def simulation(force):
            return pliant.Simulation(pliant.Scene(end=3, surfaces=[pliant.Surface("sheet")], forces=[
                pliant.Custom("own", force, magnitude=1, deformation_radius=9, force_radius=9)]))

        children, inside = [], threading.Event()
        try:
            simulation(fork).at(3)
        except Forked:
            signal.alarm(20)
            resting = simulation(rest)
            threading.Thread(target=resting.at, args=(3,), daemon=True).start()
            inside.wait()
            raise SystemExit(0)
        os._exit(os.waitstatus_to_exitcode(os.waitpid(children[0], 0)[1]))
    """)
    assert done.returncode == 7, (done.returncode, done.stderr)


def test_ctrl_c_ends_the_wait_for_another_call():
    done = run_python("""
        import os, signal, threading, time, pliant
        scene = pliant.Scene(end=10**6, surfaces=[pliant.Surface("sheet", shape=pliant.Grid(101, 101), damping=1)])
        simulation = pliant.Simulation(scene)
        other = threading.Thread(target=lambda: simulation.at(10**6), daemon=True)
        other.start()
        time.sleep(0.3)
        threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
        try:
            simulation.at(3)
        except KeyboardInterrupt:
            print("ended", other.is_alive())
    """)
    assert done.stdout == "ended True\n", done.stderr


def test_a_call_from_within_another_is_refused():
    """Whatever of Python runs within a call: handlers of signals, and arguments that compute."""
    simulation = pliant.Simulation(long_scene(size=101, end=10**6))
    live = pliant.LiveSimulation(long_scene(size=11))
    told = []

    def handler(number, frame):
        with pytest.raises(RuntimeError, match="that it has called"):
            simulation.frame_counts
        told.append(number)
        simulation.interrupt()

    before = signal.signal(signal.SIGALRM, handler)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.2)
        with pytest.raises(pliant.Interrupted):
            simulation.at(10**6)
    finally:
        signal.signal(signal.SIGALRM, before)
    assert told == [signal.SIGALRM]

    class Number:
        def __index__(self):
            return simulation.frame_counts[0] or 1

        def __float__(self):
            return float(live.frame)

    class Type:
        dtype = property(lambda self: (simulation.frame_counts, np.dtype("float64"))[1])

    with pytest.raises(RuntimeError, match="that it has called"):
        simulation.positions(frames=[Number()])
    with pytest.raises(TypeError, match="data type"):  # NumPy's, of what the property raised
        simulation.positions(frames=[1], dtype=Type())
    live.set("poke.magnitude", Number())  # computed before the call has its turn
    assert simulation.at(Number()).number >= 1
    assert simulation.at(2).number == 2


def test_calls_work_while_python_ends():
    """In handlers that run after pliant's own: work of the last thread goes on in other threads."""
    done = run_python("""
        import atexit

        def at_exit():
            straight = pliant.Sweep(scene, vary={"sheet.damping": [1, 2]}).run(threads=2)
            assert list(straight["status"]) == ["done", "done"], straight
            assert pliant.Simulation(scene, threads=2).at(3).number == 3
            print("worked")

        atexit.register(at_exit)
        import pliant

        scene = pliant.Scene(end=3, surfaces=[pliant.Surface("sheet")], forces=[
            pliant.Point("poke", magnitude=3, deformation_radius=9, force_radius=9)])
    """)
    assert done.stdout == "worked\n" and done.stderr == "", done.stderr
