"""What is solved of a scene, in which thread, and the files that it goes to."""

from __future__ import annotations

import math
import os
import tempfile
import threading
from typing import Any, Dict, List, Optional, Sequence, Set, Tuple

import bpy
import numpy as np

from . import pliant, properties, translate
from .point_cache import Cache
from .preferences import preferences
from .translate import Problem, Translation

most_reports = 2000
_folder = ""
_numbers = 0


def _new_path() -> str:
    global _folder, _numbers
    if not _folder or not os.path.isdir(_folder):
        _folder = tempfile.mkdtemp(prefix="pliant-", dir=bpy.app.tempdir or None)
    _numbers += 1
    return os.path.join(_folder, f"{_numbers}.pc2")


class Session(properties.Shown):
    """A scene of Blender that is live."""

    def __init__(self, name: str):
        self.name = name
        self.look: Any = None
        self.translation: Optional[Translation] = None
        self.simulation: Any = None
        self.caches: Dict[str, Cache] = {}  # by the names of objects
        self.buffers: Dict[str, np.ndarray] = {}
        self.rests: Dict[str, str] = {}  # what `rest` was, to see it change
        self.ready: Set[int] = set()
        self.reports: Dict[int, Dict[str, Any]] = {}  # of frames that a window may show
        self.failure: Tuple[Optional[int], List[Problem]] = (None, [])  # from which frame on there is none
        self.refused: List[Problem] = []  # of the last translation that gave no simulation
        self.told: Dict[str, List[Problem]] = {}
        self.warned: List[Problem] = []
        self.warned_frames = 0
        self.is_touched = False  # something was edited that no update has announced
        self.trusted = False  # samples differ from what is evaluated, and that was looked into
        self.ahead: Optional[int] = None  # the frame ahead of the start whose rest shape is in the file
        self.store = pliant.MemoryStore(int(preferences().memory * 2**30))
        self.lock = threading.RLock()
        self.worker: Optional[Worker] = None

    # Shown in the panel.

    @property
    def frames_ready(self) -> int:  # type: ignore[override]
        # Ahead of a frame that is solved all are.
        return max(self.ready) - self.simulation.frames[0] + 1 if self.ready else 0

    @property
    def status(self) -> str:  # type: ignore[override]
        return f"{self.frames_ready} of {len(self.simulation.frames)} frames" if self.simulation is not None else ""

    def messages(self) -> List[Problem]:
        found = list(self.refused)
        if self.translation:
            found += [each for each in self.translation.problems if each not in found]
        found += self.failure[1] + self.warned
        for each in self.told.values():
            found += each
        return sorted(dict.fromkeys(found), key=lambda each: ("ERROR", "WARNING", "NOTE").index(each.level))

    # Solving.

    def take(self, translation: Translation) -> bool:
        """Goes on with another scene, if it is one. Returns whether surfaces changed."""
        before = self.translation
        self.refused = []
        if translation.scene is None:
            self.refused = [each for each in translation.problems if each.level == "ERROR"]
            sound = before._replace(problems=[]) if before else None
            self.translation = sound
            return False
        if self.simulation is not None and before and before.scene == translation.scene:
            self._rename(before, translation)
            return False
        self.stop()
        if not translation.scene.surfaces:  # nothing is shown, and nothing is wrong
            self.simulation, self.translation = None, translation
            return True
        try:
            made = pliant.Simulation(translation.scene, threads=os.cpu_count() or 1, store=self.store)
        except pliant.Error as error:
            self.refused = self._problems(error, translation)
            self.translation = before._replace(problems=translation.problems) if before else None
            return False
        with self.lock:
            self.simulation, self.translation = made, translation
            self.ready, self.failure, self.warned, self.warned_frames = set(), (None, []), [], 0
            self.reports = {}
            self.ahead = None
            self._shape_caches()
        return True

    def _rename(self, before: Translation, translation: Translation) -> None:
        """Goes on with the same parts; their objects can have other names, such as A.1 and A_1."""
        new = {owner: translation.object_of[part] for part, owner in before.object_of.items()}
        with self.lock:
            self.translation = translation
            self.caches = {new[name]: each for name, each in self.caches.items()}
            self.buffers = {new[name]: each for name, each in self.buffers.items()}
            self.rests = {new.get(name, name): each for name, each in self.rests.items()}

    def _problems(self, error: Exception, translation: Translation) -> List[Problem]:
        problems = getattr(error, "problems", None)
        texts = [each.message for each in problems] if problems else [str(error)]
        return [translate.problem_of(text, "ERROR", translation.object_of) for text in texts]

    def _shape_caches(self) -> None:
        first, last = self.simulation.frames[0], self.simulation.frames[-1]
        wanted = {self.translation.object_of[each.name]: each for each in self.translation.scene.surfaces}
        for name in set(self.caches) - set(wanted):
            self.caches.pop(name).close()
            self.buffers.pop(name, None)
        for name, part in wanted.items():
            vertices = len(part.shape.positions)
            cache = self.caches.get(name)
            if cache is None:
                cache = self.caches[name] = Cache(_new_path())
            cache.shape(first - 1, last - first + 2, vertices)
            if name not in self.buffers or len(self.buffers[name]) != vertices:
                self.buffers[name] = np.empty((vertices, 3), np.float32)
            cache.write(first - 1, self._rest(name, part, first - 1))

    def _rest(self, name: str, part: Any, frame: int) -> np.ndarray:
        samples = self.translation.samples
        if samples and name in samples.shapes:
            index = min(max(frame - int(samples.frames[0]), 0), len(samples.frames) - 1)
            return np.ascontiguousarray(samples.shapes[name][index])
        return np.ascontiguousarray(part.shape.positions, np.float32)

    def write(self, number: int, frame: Any) -> None:
        """The positions of a solved frame into all files."""
        for name, cache in self.caches.items():
            cache.write(number, frame[self.translation.part_of[name]].positions(space="object", out=self.buffers[name]))

    def solve(self, number: int) -> bool:
        """Solves a frame, in whatever thread this is; False: there is none."""
        simulation, failed = self.simulation, self.failure[0]
        if failed is not None and number >= failed:
            return False
        try:
            frame = simulation.at(number)
            report = None if bpy.app.background else simulation.report(number)["surfaces"]
        except pliant.Interrupted:
            return False
        except Exception as error:  # also what a sandbox or memory says
            with self.lock:
                if simulation is self.simulation and (self.failure[0] is None or number < self.failure[0]):
                    self.failure = number, self._problems(error, self.translation)
            self._seek_sound(number)
            return False
        with self.lock:
            if simulation is not self.simulation:
                return False
            self.write(number, frame)
            self.ready.add(number)
            if report is not None:
                self.reports[number] = {each["name"]: each for each in report}
                if len(self.reports) > most_reports:
                    self.reports.pop(next(iter(self.reports)))
        return True

    def _seek_sound(self, failed: int) -> None:
        """Solves the last frame ahead of one that fails: it is shown in its place."""
        sound = max((each for each in self.ready if each < failed), default=self.simulation.frames[0] - 1)
        middle = (sound + failed) // 2
        if middle > sound and self.solve(middle):
            self._seek_sound(failed)

    def needed(self, scene: Any) -> List[int]:
        """The frames that the modifier mixes at the scene's frame."""
        frames = self.simulation.frames
        at = scene.frame_current + scene.frame_subframe
        found = {math.floor(at), math.ceil(at)}
        return sorted({min(each, frames[-1]) for each in found if each >= frames[0]})

    def ensure(self, scene: Any, patience: Optional[float]) -> bool:
        """Sees to it that the scene's frame is in the files, and that a thread goes on with the others. `patience`:
        how long to wait for it [s]; None: as long as it takes, without a thread. Returns whether it was written just
        now."""
        if self.simulation is None:
            return False
        missing = [each for each in self.needed(scene) if each not in self.ready]
        if patience is not None and self.worker is None and len(self.ready) < len(self.simulation.frames):
            self.worker = Worker(self)
        if not missing:
            return False
        if patience is not None:
            self.worker.want(missing[-1])
            self.worker.wait(missing, patience)
        else:
            self.stop()
            for each in missing:
                self.solve(each)
        for each in missing:
            if each not in self.ready:
                self._write_nearest(each)
                if self.worker:
                    self.worker.late = each
        return True

    def _write_nearest(self, number: int) -> None:
        with self.lock:
            sound = [each for each in self.ready if each <= number] or sorted(self.ready)[:1]
            nearest = max(sound) if sound else self.simulation.frames[0] - 1
            for name, cache in self.caches.items():
                cache.write(number, cache.read(nearest))

    def warn(self) -> None:
        """What the simulation has to say of the frames that are there."""
        if self.simulation is None or len(self.ready) == self.warned_frames or (self.worker and self.worker.is_busy):
            return
        self.warned_frames = len(self.ready)
        found = []
        for each in self.simulation.warnings():
            ranges = ", ".join(f"{a}" if a == b else f"{a} to {b}" for a, b in each.frames)
            text = f"{each.message} (frames {ranges})" if ranges else each.message
            owner = self.translation.object_of.get(each.force or each.surface, "")
            found.append(Problem("WARNING", owner, text))
        self.warned = found

    def stop(self) -> None:
        if self.worker:
            self.worker.stop()
            self.worker = None

    def close(self) -> None:
        self.stop()
        for cache in self.caches.values():
            cache.close()
        self.caches.clear()


class Worker:
    """Solves frames in a thread, in their order: first to the frame that is shown, then to the end."""

    def __init__(self, session: Session):
        self.session = session
        self.changed = threading.Condition()
        self.target = session.simulation.frames[0]
        self.is_stopped = False
        self.is_busy = True
        self.is_news = False
        self.late: Optional[int] = None  # the frame that is shown in place of another one
        self.thread = threading.Thread(target=self._run, name="pliant", daemon=True)
        self.thread.start()

    def want(self, frame: int) -> None:
        with self.changed:
            self.target = frame
            self.is_busy = True
            self.changed.notify_all()

    def wait(self, frames: Sequence[int], seconds: float) -> None:
        with self.changed:
            ready = self.session.ready
            self.changed.wait_for(lambda: not self.is_busy or all(each in ready for each in frames), seconds)

    def shown_late(self, scene: Any) -> bool:
        """Whether the frame that is shown came after it was shown; told once."""
        if self.late is None or self.late not in self.session.ready:
            return False
        self.late = None
        return True

    def stop(self) -> None:
        with self.changed:
            self.is_stopped = True
            self.changed.notify_all()
        while self.thread.is_alive():  # an interrupt acts on a call that runs
            self.session.simulation.interrupt()
            self.thread.join(0.01)
        self.is_busy = False

    def _next(self) -> Optional[int]:
        session = self.session
        failed = session.failure[0]
        frames = session.simulation.frames
        last = frames[-1] if failed is None else failed - 1
        if self.target not in session.ready and session.ready and self.target < max(session.ready):
            return self.target if self.target <= last else None
        return next((each for each in range(frames[0], last + 1) if each not in session.ready), None)

    def _run(self) -> None:
        while True:
            with self.changed:
                number = None
                while not self.is_stopped and (number := self._next()) is None:
                    self.is_busy = False
                    self.changed.notify_all()
                    self.changed.wait()
                if self.is_stopped:
                    return
            self.session.solve(number)
            with self.changed:
                self.is_news = True
                self.changed.notify_all()
