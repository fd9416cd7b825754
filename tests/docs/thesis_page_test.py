"""Compares docs/thesis.md with examples/thesis: every scene has a row with its reference, every
picture and link exists, and the named figures are those that script/figures draws.

usage: thesis_page_test.py SOURCE_FOLDER
"""

import os
import re
import sys
import xml.etree.ElementTree as ElementTree

SOURCE = os.path.abspath(sys.argv[1])


def main():
    folder = os.path.join(SOURCE, "examples", "thesis")
    scenes = {file: ElementTree.parse(os.path.join(folder, file)).getroot()
              for file in os.listdir(folder) if file.endswith(".xml")}
    with open(os.path.join(SOURCE, "docs", "thesis.md"), encoding="utf-8") as file:
        page = file.read()
    rows = {}
    for line in page.splitlines():
        found = re.match(r"\|.*\[`(\S+)`\]\(\.\./examples/thesis/(\S+)\).*\| `(\w+)` \|$", line)
        if found:
            assert found[1] == found[2], f"{found[1]} links to {found[2]}"
            rows[found[1]] = found[3]
    assert rows.keys() == scenes.keys(), f"rows and scenes differ: {rows.keys() ^ scenes.keys()}"
    for file, scene in scenes.items():
        reference = scene.find("surface/solver").get("reference", "rest")
        assert rows[file] == reference, f"{file} has reference {reference}, its row {rows[file]}"
    for path in re.findall(r"\]\((?!https?:)([^)#]+)\)", page):
        assert os.path.exists(os.path.join(SOURCE, "docs", path)), f"docs/thesis.md links to {path}"
    with open(os.path.join(SOURCE, "script", "figures"), encoding="utf-8") as file:
        drawn = set(re.findall(r"\bbake\(thesis\(\"([\w-]+)\"\)\)", file.read()))
    assert {name + ".xml" for name in drawn} == scenes.keys(), "script/figures draws other scenes"
    print(f"ok {len(rows)} scenes")


if __name__ == "__main__":
    main()
