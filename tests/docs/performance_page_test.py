"""Compares the ratios in CHANGELOG.md with the table of docs/performance.md.

usage: performance_page_test.py SOURCE_FOLDER
"""

import os
import re
import sys


def read(*path):
    with open(os.path.join(sys.argv[1], *path), encoding="utf-8") as file:
        return file.read()


def main():
    plates = read("docs", "performance.md").partition("## Frames")[0]
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in plates.splitlines()
            if re.match(r"^\| \d+ x \d+ ", line)]
    simplicial = [row[7].split(" / ") for row in rows if row[7] != "-"]
    assert len(simplicial) > 5, rows
    new, kept = ([int(ratios[k]) for ratios in simplicial] for k in (0, 1))
    changes = " ".join(read("CHANGELOG.md").split())
    said = (f"{min(kept)} to {max(kept)} times as fast as by sparse factors that are at hand, "
            f"{min(new)} to {max(new)} times where these are made anew")
    assert said in changes, said
    frame = re.search(r"^\| 1001 \|(?:[^|]*\|){11} ([\d.]+) \|", read("docs", "performance.md"), re.MULTILINE)
    said = f"1001 x 1001 vertices takes {frame.group(1)} ms"
    assert said in changes, said
    print("ok")


if __name__ == "__main__":
    main()
