"""Why an operator does nothing."""

from __future__ import annotations

from typing import Any

from .translate import Problem


class Refused(Exception):
    """Why an operator does nothing."""

    def __init__(self, *problems: Problem):
        super().__init__(*problems)
        self.problems = list(problems)


def error_of(text: str, owner: str = "") -> Problem:
    return Problem("ERROR", owner, text)


def refused_by(error: Any) -> Refused:
    """What the library says of a file or a scene."""
    return Refused(*(error_of(text) for text in str(error).splitlines()))
