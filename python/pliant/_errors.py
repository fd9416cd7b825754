"""What can go wrong: one class for each kind of error of the library."""

from __future__ import annotations

from typing import NamedTuple, Optional, Sequence, Tuple, Union


class Problem(NamedTuple):
    """One thing that is wrong, or a note, with its place."""

    severity: str  #: "error", "warning" or "note"
    message: str  #: one line: the thing, the value, the rule
    file: Optional[str] = None  #: None: not about a file
    line: Optional[int] = None  #: counted from 1; None: unknown

    def __str__(self) -> str:
        place = [str(part) for part in (self.file, self.line) if part is not None]
        line = ": ".join([":".join(place)] * bool(place) + [self.severity, self.message])
        return line.encode("utf-8", "backslashreplace").decode()  # names of files can be other bytes


class Error(Exception):
    """What pliant could not do, and why; its subclasses say what kind of error it is.

    `message`, `file` and `line` are the first problem's, None where unknown. `problems` has all, in
    the order of the library. `str(error)` has one line for each, as the command prints it.
    """

    def __init__(self, problems: Union[str, Sequence[Problem]]):
        if isinstance(problems, str):
            problems = (Problem("error", problems),)
        self.problems: Tuple[Problem, ...] = tuple(problems)
        if not self.problems:
            raise ValueError("an error has at least one problem")
        super().__init__(self.problems)

    @property
    def message(self) -> str:
        """One line: the thing, the value, the rule."""
        return self.problems[0].message

    @property
    def file(self) -> Optional[str]:
        """The file that it is about, or None."""
        return self.problems[0].file

    @property
    def line(self) -> Optional[int]:
        """The line in the file, counted from 1, or None."""
        return self.problems[0].line

    def __str__(self) -> str:
        return "\n".join(map(str, self.problems))

    def __reduce__(self):  # type: ignore[no-untyped-def]
        return type(self), (self.problems,)


class InvalidInput(Error, ValueError):
    """A scene, mesh or argument breaks a documented rule."""


class Unreadable(Error, OSError):
    """A file could not be opened or read."""


class Unwritable(Error, OSError):
    """A file could not be created, written or renamed."""


class OutOfMemory(Error, MemoryError):
    """The work does not fit in memory."""


class SolverFailed(Error, ArithmeticError):
    """A linear system could not be factored or solved."""


class NotFinite(Error, ArithmeticError):
    """A state stopped being finite."""


class Interrupted(Error):
    """The caller asked to stop."""
