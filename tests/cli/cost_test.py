"""What a file costs grows with its bytes, or hardly faster. Counted are instructions, by Valgrind: they are the same
whatever else the machine does."""

import os
import re
import subprocess
import tempfile
import unittest

from command import PLIANT, main
from hostile import KINDS

# Of sizes n, 2n and 4n, the second step's cost by the first's: 2 if it grows with the bytes, 2.2 for sorting, 4 for n^2.
MOST = 2.5
# The least of the first step by the cost of the smallest size.
LEAST = 0.1


def instructions(arguments, folder):
    """Instructions of a run, which may fail as a run of a bad file does."""
    run = subprocess.run(["valgrind", "--tool=cachegrind", "--cache-sim=no", "--cachegrind-out-file=/dev/null",
                          PLIANT, *arguments], cwd=folder, capture_output=True, text=True, errors="replace",
                         timeout=600, stdin=subprocess.DEVNULL, check=False)
    count = re.search(r"I\s+refs:\s+([\d,]+)", run.stderr)
    if run.returncode not in (0, 1, 2) or count is None:
        raise AssertionError(f"{arguments}: exit code {run.returncode}: {run.stderr[-2000:]}")
    return int(count.group(1).replace(",", ""))


def test_of(make, size):
    def test(self):
        counts = []
        for n in (size, 2 * size, 4 * size):
            with tempfile.TemporaryDirectory(prefix="pliant-cost-") as folder:
                counts.append(instructions(make(folder, n), folder))
        # Differences leave out what every run costs.
        first, second = counts[1] - counts[0], counts[2] - counts[1]
        self.assertGreater(first, LEAST * counts[0], f"{counts}: too small to tell growth from the start")
        self.assertLess(second, MOST * first, f"{counts}")

    return test


class Cost(unittest.TestCase):
    pass


for name, (make, size) in KINDS.items():
    setattr(Cost, f"test_{name}", test_of(make, size))

if __name__ == "__main__":
    main()
