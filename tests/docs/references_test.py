"""Checks that what the sources refer to exists: equations of docs/model.md and docs/timeline.md, sections of
its rules (as "SPEC 5"), sections of the thesis that docs/thesis.md lists, pages of docs/ and their titles.

usage: references_test.py SOURCE_FOLDER
"""

import os
import re
import sys

SOURCE = os.path.abspath(sys.argv[1])
FOLDERS = ["lib", "forces", "timeline", "viewer", "editor", "cli", "bench", "cmake", "script", "tests", "examples"]
TEXTS = re.compile(r"(\.([ch]pp|py|cmake|ts|html|xml|in)|/CMakeLists\.txt|^script/\w+)$")


def pattern(text):
    """A space stands for any number of spaces and line ends."""
    return re.compile(text.replace(" ", r"\s+"))


NUMBER = r"\(?\d+[a-z]?\)?"
EQUATIONS = pattern(r"(docs/[\w-]+\.md, |[Tt]hesis(?: [\d.]+,)? )?"
                    rf"\b[Ee]q\. ?({NUMBER}(?:(?:,|,? and| to) {NUMBER}(?!\w))*)( of docs/[\w-]+\.md)?")
SPEC = pattern(r"\bSPEC (\d+(?:\.\d+)*(?:(?:, | and | to |-)\d+(?:\.\d+)*)*)(?:, \\?\"([^\"\\]+)\\?\")?")
THESIS = pattern(r"\b[Tt]hesis(?:'s(?: \w+)?)?,? \(?(\d+(?:\.\d+)*)")
# Names under which texts outside of the repository are known.
ELSEWHERE = pattern(r"\b(?:(PHYSICS|MESHES|SWEEP|TIMELINE|SCENE_FORMAT)\b"
                    r"|(CONTROL|CONTACT|EDITOR|PYTHON|BLENDER|CLI|ARCHITECTURE|PERFORMANCE)(?:\.md| \d|, \\?\"))")
PAGE = pattern(r"docs/([\w-]+\.md)(?:,(?: section)? \\?\"([^\"\\]+)\\?\")?")


def numbers(text):
    """["2", "4"] of "(2) to (4)": numbers have no gaps, so that the ends of a range are enough."""
    return re.findall(r"\d+(?:\.\d+)*[a-z]?", text)


class Documents:
    def __init__(self):
        folder = os.path.join(SOURCE, "docs")
        self.pages = {}
        for name in os.listdir(folder):
            if name.endswith(".md"):
                with open(os.path.join(folder, name), encoding="utf-8") as file:
                    self.pages[name] = file.read()
        # An equation's number ends its line in model.md and begins it, or a cell, in timeline.md.
        self.equations = {
            "model.md": re.findall(r"^ {4}.* {2}\((\d+[a-z]?)\)$", self.pages["model.md"], re.MULTILINE),
            "timeline.md": re.findall(r"(?:^ {2}|\| |`: )\((\d+[a-z]?)\) (?!and )", self.pages["timeline.md"],
                                      re.MULTILINE)}
        parts = re.split(r"^## (\d+)\. ", self.pages["model.md"], flags=re.MULTILINE)
        self.spec = dict(zip(parts[1::2], parts[2::2]))
        listed = self.pages["thesis.md"].partition("## Sections that the code cites\n")[2].partition("\n## ")[0]
        self.thesis = re.findall(r"^\| (\d+(?:\.\d+)*) \|", listed, re.MULTILINE)

        for heading in re.findall(r"^## \d.*\((.*)\)$", self.pages["model.md"], re.MULTILINE):
            for section in re.findall(r"(?<!fig\. )(?<!eq\. )\b\d+(?:\.\d+)*", heading):
                assert section in self.thesis, f"docs/thesis.md does not list section {section} of the thesis"

    def has_title(self, page, title):
        return re.search(rf"^(#+ |\*\*){re.escape(title)}\b", self.pages[page], re.MULTILINE | re.IGNORECASE)

    def faults(self, path, text):
        """The references of a file to what does not exist, as (line, message)."""
        text = re.sub(r"^[ \t]*(//+|#+|\*)", "", text, flags=re.MULTILINE)  # comments continue on the next line
        faults = []

        def expect(found, holds, message):
            if not holds:
                faults.append(f"{path}:{text.count(chr(10), 0, found.start()) + 1}: {message}")

        own = "timeline.md" if path.startswith(("timeline/", "tests/timeline/")) else "model.md"
        for found in EQUATIONS.finditer(text):
            if (found[1] or "").lower().startswith("thesis"):
                continue
            named = re.search(r"docs/([\w-]+\.md)", (found[1] or "") + (found[3] or ""))
            page = named[1] if named else own
            for number in numbers(found[2]):
                expect(found, number in self.equations.get(page, []), f"docs/{page} has no equation ({number})")
        for found in SPEC.finditer(text):
            for number in numbers(found[1]):
                expect(found, number in self.spec, f"docs/model.md has no section {number}")
            if found[2]:
                section = self.spec.get(numbers(found[1])[-1], "")
                expect(found, " ".join(found[2].split()).lower() in section.lower(),
                       f"section {found[1]} of docs/model.md does not mention \"{found[2]}\"")
        for found in ELSEWHERE.finditer(text):
            expect(found, False, f"{found[1] or found[2]} is no page of docs/")
        for found in THESIS.finditer(text):
            expect(found, found[1] in self.thesis, f"docs/thesis.md does not list section {found[1]} of the thesis")
        for found in PAGE.finditer(text):
            expect(found, found[1] in self.pages, f"there is no docs/{found[1]}")
            if found[2] and found[1] in self.pages:
                title = " ".join(found[2].split())
                expect(found, self.has_title(found[1], title), f"docs/{found[1]} has no title \"{title}\"")
        return faults


LINK = pattern(r"\]\(([\w./-]*\.md)?(?:#([\w-]+))?\)")
SECTION = pattern(r"\*([A-Z][^*\n]+)\* in (?:the )?\[[^\]]*\]\(([\w./-]+\.md)\)")


def anchors_of(text):
    """The anchors of a page's titles, as GitHub makes them."""
    titles = re.findall(r"^#+ (.+)$", text, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", title.strip().lower()).replace(" ", "-") for title in titles}


def broken_links(path, text, pages):
    """Links of a page, and sections that it names in another, that are not there. `pages`: text by path."""
    faults = []
    for found in LINK.finditer(text):
        page = os.path.normpath(os.path.join(os.path.dirname(path), found[1])) if found[1] else path
        if page not in pages:
            faults.append(f"{path}: there is no {page}")
        elif found[2] and found[2] not in anchors_of(pages[page]):
            faults.append(f"{path}: {page} has no section #{found[2]}")
    for found in SECTION.finditer(text):
        page = os.path.normpath(os.path.join(os.path.dirname(path), found[2]))
        if " ".join(found[1].split()) not in re.findall(r"^#+ (.+)$", pages.get(page, ""), re.MULTILINE):
            faults.append(f"{path}: {page} has no section \"{found[1]}\"")
    return faults


def check_links(documents):
    pages = {os.path.join("docs", name): text for name, text in documents.pages.items()}
    for name in ("README.md", "CHANGELOG.md"):
        with open(os.path.join(SOURCE, name), encoding="utf-8") as file:
            pages[name] = file.read()
    faults = [fault for path, text in pages.items() for fault in broken_links(path, text, pages)]
    assert not faults, "\n".join(faults)
    pages["docs/a.md"] = "# Some `thing`, twice\n"
    for text in ("[x](a.md)", "[x](a.md#some-thing-twice)", "[x](../README.md)", "*Units* in the [README](../README.md)"):
        assert broken_links("docs/b.md", text, pages) == [], text
    for text in ("[x](c.md)", "[x](a.md#some)", "*Choosing numbers* in the\n[README](../README.md)"):
        assert len(broken_links("docs/b.md", text, pages)) == 1, text


def sources():
    for top in FOLDERS:
        for folder, folders, files in os.walk(os.path.join(SOURCE, top)):
            folders[:] = [name for name in folders if name not in ("node_modules", "dist", "__pycache__")]
            for name in files:
                path = os.path.relpath(os.path.join(folder, name), SOURCE)
                if TEXTS.search(path) and not os.path.samefile(os.path.join(SOURCE, path), __file__):
                    yield path


def check_the_check(documents):
    for found, least in ((documents.equations["model.md"], 42), (documents.equations["timeline.md"], 25),
                         (list(documents.spec), 11)):
        whole = [number for number in found if number.isdigit()]
        assert whole == [str(k + 1) for k in range(len(whole))] and len(whole) >= least, whole
    for text in ("// Eq. (4) and (5), of docs/model.md, eq. (18) to (20)", "// thesis 4.2, eq. 99; SPEC 2 to 4",
                 "// docs/timeline.md,\n// eq. 6a", "// SPEC 7, \"Transforms\"", "// docs/model.md, \"Release\""):
        assert documents.faults("lib/a.cpp", text) == [], text
    for text in ("// Eq. (99)", "// eq. (41) to (98)", "// docs/timeline.md,\n// eq. 14 to 99", "// eq. (6a)",
                 "// Eq. (0) of docs/model.md", "// docs/timeline.md, eq. (99)", "// SPEC 12", "// SPEC 2 and\n/// 99",
                 "// SPEC 5.9", "// SPEC 7, \"Nothing\"", "// thesis 5.9.1", "// docs/nothing.md",
                 "// docs/model.md, \"Nothing\"", "// PHYSICS 3.", "// as in MESHES", "// CONTROL\n// 5", "// CLI.md"):
        assert len(documents.faults("lib/a.cpp", text)) == 1, (text, documents.faults("lib/a.cpp", text))
    assert documents.faults("timeline/a.cpp", "// Eq. 6a") == []
    assert documents.faults("timeline/a.cpp", "\n\n// Eq. 26") == [
        "timeline/a.cpp:3: docs/timeline.md has no equation (26)"]


def main():
    documents = Documents()
    faults = []
    count = 0
    for path in sources():
        with open(os.path.join(SOURCE, path), encoding="utf-8") as file:
            text = file.read()
        count += len(EQUATIONS.findall(text)) + len(SPEC.findall(text))
        faults += documents.faults(path, text)
    assert not faults, "\n".join(faults)
    check_the_check(documents)
    check_links(documents)
    assert count > 150, count
    print(f"ok {count} references")


if __name__ == "__main__":
    main()
