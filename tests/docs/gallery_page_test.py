"""Compares docs/gallery.md with script/gallery: the same pictures, all existing, of all examples.

usage: gallery_page_test.py SOURCE_FOLDER
"""

import os
import re
import sys

SOURCE = os.path.abspath(sys.argv[1])


def read(name):
    with open(os.path.join(SOURCE, name), encoding="utf-8") as file:
        return file.read()


def main():
    shown = re.findall(r"\]\(images/gallery/([\w-]+)\.png\)", read("docs/gallery.md"))
    taken = re.findall(r"^take ([\w-]+) ([\w/-]+) \d+ ", read("script/gallery"), re.MULTILINE)
    assert sorted(shown) == sorted(name for name, _ in taken), set(shown) ^ {name for name, _ in taken}
    folder = os.path.join(SOURCE, "docs/images/gallery")
    assert sorted(os.listdir(folder)) == sorted(f"{name}.png" for name in shown)
    scenes = {name.removesuffix(".xml") for name in os.listdir(os.path.join(SOURCE, "examples"))
              if name.endswith(".xml")}
    scenes |= {f"thesis/{name.removesuffix('.xml')}" for name in os.listdir(os.path.join(SOURCE, "examples/thesis"))}
    assert scenes == {scene for _, scene in taken}, scenes ^ {scene for _, scene in taken}
    print("ok", len(shown), "pictures")


if __name__ == "__main__":
    main()
