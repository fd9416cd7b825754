"""What the tests of the Python module share. PYTHONPATH has the module."""

import os
import pathlib
import subprocess

import pytest

import pliant

root = pathlib.Path(__file__).parents[2]


def pytest_configure(config):
    config.addinivalue_line("markers", "no_sanitizer: a sanitizer finds nothing in it, or takes what it measures")
    config.addinivalue_line("markers", "forks: which no thread sanitizer follows")


@pytest.fixture(scope="session")
def examples():
    return root / "examples"


@pytest.fixture(scope="session")
def command():
    """Runs the command, and returns what it printed."""
    path = os.environ.get("PLIANT_COMMAND", str(root / "build/release/pliant"))

    # It has its own sanitizer, if any.
    environment = {name: value for name, value in os.environ.items() if name != "LD_PRELOAD"}

    def run(*arguments, status=0):
        done = subprocess.run([path, *map(str, arguments)], env=environment, capture_output=True, text=True)
        assert done.returncode == status, done.stderr
        return done.stdout

    return run


@pytest.fixture
def scene():
    """A sheet that one force pokes."""
    return pliant.Scene(
        start=1,
        end=12,
        surfaces=[pliant.Surface("sheet", shape=pliant.Grid(13, 11, width=12, depth=10), damping=4)],
        forces=[
            pliant.Point(
                "poke",
                deformation_radius=4,
                force_radius=2,
                magnitude=pliant.Curve([(1, 0), (4, 900), (12, 0)]),
            )
        ],
    )
