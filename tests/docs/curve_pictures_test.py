"""Compares the pictures of curves with the command: each .svg in docs/curves must equal the output
of `pliant curves` for the scene beside it, and some page must show it. --bless writes them again.

usage: curve_pictures_test.py PLIANT SOURCE_FOLDER [--bless]
"""

import glob
import os
import subprocess
import sys
import tempfile

PLIANT, SOURCE = (os.path.abspath(argument) for argument in sys.argv[1:3])


def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def main():
    pages = "".join(read(page) for page in glob.glob(os.path.join(SOURCE, "docs", "*.md")))
    scenes = sorted(glob.glob(os.path.join(SOURCE, "docs", "curves", "*.xml")))
    assert scenes, "no scenes in docs/curves"
    with tempfile.TemporaryDirectory() as folder:
        for scene in scenes:
            picture = scene.removesuffix(".xml") + ".svg"
            drawn = os.path.join(folder, os.path.basename(picture))
            subprocess.run([PLIANT, "curves", scene, "-o", drawn], check=True, timeout=60)
            if sys.argv[3:] == ["--bless"]:
                os.replace(drawn, picture)
                continue
            assert read(drawn) == read(picture), f"{picture} is not what the command draws"
            name = os.path.relpath(picture, os.path.join(SOURCE, "docs"))
            assert f"]({name})" in pages, f"no page shows {name}"
            print("ok", name)


if __name__ == "__main__":
    main()
