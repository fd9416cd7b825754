"""Scene files from Blender; one that is there keeps its comments and its order."""

from __future__ import annotations

import contextlib
import os
import re
import tempfile
import xml.parsers.expat
from typing import Any, Dict, Iterable, Iterator, List, Tuple

from . import pliant, translate
from .problems import Refused, error_of, refused_by
from .translate import Problem


def export(scene: Any, path: str, sampled: bool) -> List[Problem]:
    translation = translate.translate(scene, sampled=sampled)
    if translation.scene is None:
        raise Refused(*(each for each in translation.problems if each.level == "ERROR"))
    folder, name = os.path.split(os.path.abspath(path))
    if not os.path.isdir(folder):
        raise Refused(error_of(f"there is no folder {folder}"))
    notes = [each for each in translation.problems if each.level != "ERROR"]
    try:
        # Beside the file, so that all comes to its place by a rename.
        with tempfile.TemporaryDirectory(prefix=".pliant-", dir=folder) as aside:
            file = os.path.join(aside, name)
            translation.scene.save(file)
            problems = [each for each in pliant.validate(file) if each.severity == "error"]
            if problems:
                owners = translation.object_of
                raise Refused(*(translate.problem_of(each.message, "ERROR", owners) for each in problems))
            with open(file, "rb") as stream:
                text = stream.read()
            os.unlink(file)
            with _in_place(aside, folder):
                notes += write_scene(os.path.join(folder, name), text)
    except pliant.Error as error:
        raise refused_by(error) from error
    except OSError as error:
        raise Refused(error_of(str(error))) from error
    return notes


@contextlib.contextmanager
def _in_place(aside: str, folder: str) -> Iterator[None]:
    """Puts the files of a folder into another one, for good unless what follows fails."""
    names = os.listdir(aside)
    before = os.path.join(aside, "before")
    os.mkdir(before)
    try:
        for each in names:
            if os.path.exists(os.path.join(folder, each)):
                os.replace(os.path.join(folder, each), os.path.join(before, each))
            os.replace(os.path.join(aside, each), os.path.join(folder, each))
        yield
    except BaseException:
        for each in names:
            if not os.path.exists(os.path.join(aside, each)):
                os.unlink(os.path.join(folder, each))
            if os.path.exists(os.path.join(before, each)):
                os.replace(os.path.join(before, each), os.path.join(folder, each))
        raise


def write_scene(path: str, text: bytes) -> List[Problem]:
    """Writes a scene file; one that is there keeps its comments and its order."""
    folder = os.path.dirname(path)
    notes = []
    document = pliant.SceneDocument.from_text(text.decode(), name=path, folder=folder)
    if os.path.exists(path) and os.path.getsize(path):
        try:
            document = _edited(path, text, document.scene)
        except _Anew as reason:
            text_of = f"{os.path.basename(path)} is written anew, without its comments: {reason}"
            notes.append(Problem("WARNING", "", text_of))
    document.save_as(path)
    return notes


class _Anew(Exception):
    """Why a scene file cannot be edited."""


def _edited(path: str, text: bytes, wanted: Any) -> Any:
    """The document of a file, edited to the wanted scene, whose own text is `text`."""
    try:
        before = pliant.load(path)
    except pliant.Error as error:
        raise Refused(error_of(f"{path} is there already, and is no scene: {error.message}")) from error
    with open(path, "rb") as stream:
        data = stream.read()
    structure = _Structure(data, text, before, wanted)
    try:
        document = pliant.SceneDocument.from_text(structure.text().decode(), name=path, folder=os.path.dirname(path))
        operations = list(_operations(document.scene, wanted))
        if operations:
            document.apply(*operations, name="export")
    except pliant.Error as error:
        raise _Anew(error.message) from error
    if not is_same(document.scene, wanted):
        raise _Anew("not all of it can be changed")
    return document


def is_same(scene: Any, wanted: Any) -> bool:
    """Whether scenes are equal but for the order of their parts."""
    for name, row in scene._rows.items():
        a, b = getattr(scene, name), getattr(wanted, name)
        if row.kind == "parts":
            a, b = (sorted(each, key=lambda part: part.name) for each in (a, b))
        if a != b:
            return False
    return True


_read = ("shape", "subdivision", "wrap", "uv", "unit", "axis", "border", "weld", "cache", "cache_start")
_referring = ("group", "targets", "follow", "driven_by")
_structural = {"name", "maps", "holds", *_read, *_referring}


def _operations(scene: Any, wanted: Any) -> Iterator[Any]:
    """What makes the attributes of a scene those of the wanted one, whose parts are the same."""
    pairs = [("scene", scene, wanted)]
    pairs += [(each.name, each, wanted[each.name]) for each in scene._all()]
    for name, part, other in pairs:
        for row in part._rows.values():
            value = getattr(other, row.name)
            is_structural = row.kind == "parts" or (row.name in _structural and part is not scene)
            is_of_group = row.name == "deformation_radius" and getattr(part, "group", "")
            if is_structural or is_of_group or getattr(part, row.name) == value:
                continue
            path = f"{name}.{row.attribute}"
            if isinstance(value, pliant.Curve):
                yield pliant.edit.SetCurve(path, value)
            elif value == row.standard and not row.is_required:
                yield pliant.edit.Reset(path)
            else:
                yield pliant.edit.Set(path, value)


class _Element:
    """An element of a text: where it is, and what is in it."""

    def __init__(self, tag: str, name: str, start: int):
        self.tag, self.name, self.start = tag, name, start
        self.inside = self.end = 0  # behind its first tag, and behind itself
        self.children: List["_Element"] = []

    def of(self, *tags: str) -> List["_Element"]:
        return [each for each in self.children if each.tag in tags]

    @staticmethod
    def root(data: bytes) -> "_Element":
        parser = xml.parsers.expat.ParserCreate()
        top = _Element("", "", 0)
        open_ = [top]

        def start(tag: str, attributes: Dict[str, str]) -> None:
            made = _Element(tag, attributes.get("name", ""), parser.CurrentByteIndex)
            made.inside = re.compile(rb"<(?:[^>\"']|\"[^\"]*\"|'[^']*')*>").match(data, made.start).end()
            open_[-1].children.append(made)
            open_.append(made)

        def end(_tag: str) -> None:
            made = open_.pop()
            is_empty = data[made.inside - 2 : made.inside] == b"/>"
            made.end = made.inside if is_empty else data.index(b">", parser.CurrentByteIndex) + 1

        parser.StartElementHandler, parser.EndElementHandler = start, end
        parser.Parse(data, True)
        return top.children[0]

    def parts(self) -> Dict[str, Tuple["_Element", "_Element"]]:
        """Surfaces, forces and groups by their names, each with what contains it."""
        found = {}
        for holder in (self, *self.of("group")):
            found.update({each.name: (each, holder) for each in holder.children if each.name and each.tag != "define"})
        return found


class _Structure:
    """Makes the elements of a text those of the wanted one, where no operation does."""

    def __init__(self, data: bytes, text: bytes, before: Any, wanted: Any):
        self.data, self.new_data, self.before, self.wanted = data, text, before, wanted
        self.root, self.new_root = _Element.root(data), _Element.root(text)
        self.edits: List[Tuple[int, int, bytes]] = []
        self.behind: Dict[int, List[bytes]] = {}  # what comes behind a place
        self.filled: Dict[int, Tuple[_Element, List[bytes]]] = {}  # and into an empty element

    def text(self) -> bytes:
        old, new = self.root.parts(), self.new_root.parts()
        included = {each.name for each in self.before._all() if each.name not in old}
        for name in included:
            if name not in new or self._differ(name, ("__class__", *_structural)):
                raise _Anew(f"{name} is in a file that it includes")
        stays = {
            name for name, (element, holder) in old.items()
            if name in new and new[name][0].tag == element.tag and new[name][1].name == holder.name
        }  # fmt: skip
        for name, (element, _) in old.items():
            if name not in stays:
                self._remove(element)
            elif self._differ(name, _referring):
                self.edits.append((element.start, element.end, self._source(new[name][0])))
            elif element.tag == "surface":
                self._shape(element, new[name][0], self.before[name], self.wanted[name])
            elif getattr(self.before[name], "falloff", "") != getattr(self.wanted[name], "falloff", ""):
                self._draw_falloff(element, new[name][0])
        for holder in (self.new_root, *self.new_root.of("group")):
            if holder is not self.new_root and holder.name not in stays:
                continue
            there = self.root if holder is self.new_root else old[holder.name][0]
            depth = b"\n  " if holder is self.new_root else b"\n    "
            place = there.inside
            for each in holder.children:
                if each.name not in new or each.name in included:
                    continue
                if each.name in stays:
                    place = old[each.name][0].end
                else:
                    self._insert(there, place, depth + self._source(each))
        return self._applied()

    def _differ(self, name: str, attributes: Iterable[str]) -> bool:
        """Whether one of some attributes of a part is to change."""
        parts = self.before[name], self.wanted[name]
        return any(getattr(parts[0], each, None) != getattr(parts[1], each, None) for each in attributes)

    def _source(self, element: _Element) -> bytes:
        return self.new_data[element.start : element.end]

    def _remove(self, element: _Element) -> None:
        start = element.start
        while self.data[start - 1 : start] in (b" ", b"\t"):
            start -= 1
        for end in (b"\n", b"\r"):
            start -= self.data[start - 1 : start] == end
        self.edits.append((start, element.end, b""))

    def _insert(self, holder: _Element, place: int, text: bytes) -> None:
        if holder.inside == holder.end:  # it is empty
            self.filled.setdefault(holder.start, (holder, []))[1].append(text)
        else:
            self.behind.setdefault(place, []).append(text)

    def _draw_falloff(self, element: _Element, new: _Element) -> None:
        """Another <falloff>, or one in place of the attribute. (An operation makes it an attribute again.)"""
        for drawn in new.of("falloff"):
            source = self._source(drawn)
            for each in element.of("falloff"):
                self.edits.append((each.start, each.end, source))
                return
            word = re.compile(rb"\sfalloff\s*=\s*(?:\"[^\"]*\"|'[^']*')")
            plain = word.search(self.data, element.start, element.inside)
            if plain:
                self.edits.append((*plain.span(), b""))
            self._insert(element, element.inside, b"\n    " + source)

    def _shape(self, element: _Element, new: _Element, before: Any, wanted: Any) -> None:
        """Replaces the shape, the maps and the holds of a surface that differ."""
        if any(getattr(before, each) != getattr(wanted, each) for each in _read):
            shapes = [each.of("grid", "mesh", "nurbs", "subdivision") for each in (element, new)]
            if not all(shapes):
                raise _Anew(f"the shape of {before.name} is in a file that it includes")
            self.edits.append((shapes[0][0].start, shapes[0][0].end, self._source(shapes[1][0])))
        if before.holds != wanted.holds:
            for each in element.of("hold"):
                self._remove(each)
        if before.maps != wanted.maps:
            materials = [each.of("material") for each in (element, new)]
            if not materials[0]:
                shapes = element.of("grid", "mesh", "nurbs", "subdivision")
                if not shapes:
                    raise _Anew(f"the shape of {before.name} is in a file that it includes")
                self._insert(element, shapes[0].end, b"\n    " + self._source(materials[1][0]))
                return
            for each in materials[0][0].of("map"):
                self._remove(each)
            for each in materials[1][0].of("map") if materials[1] else ():
                self._insert(materials[0][0], materials[0][0].inside, b"\n      " + self._source(each))

    def _applied(self) -> bytes:
        edits = [*self.edits, *((place, place, b"".join(texts)) for place, texts in self.behind.items())]
        for holder, texts in self.filled.values():
            indent = re.search(rb"[ \t]*$", self.data[: holder.start])[0]
            closing = b"\n" + indent + b"</" + holder.tag.encode() + b">"
            edits.append((holder.end - 2, holder.end, b"".join([b">", *texts, closing])))
        # What is within a part that goes as a whole goes with it.
        edits = [
            each for each in edits
            if not any(a <= each[0] and each[1] <= b and each[:2] not in ((a, a), (b, b), (a, b)) for a, b, _ in edits)
        ]  # fmt: skip
        found, place = [], 0
        for start, end, text in sorted(edits, key=lambda each: each[:2]):
            found += [self.data[place:start], text]
            place = end
        made = b"".join([*found, self.data[place:]])
        if b"\r\n" not in self.data or re.search(rb"(?<!\r)\n", self.data):
            return made
        return re.sub(rb"(?<!\r)\n", b"\r\n", made)  # lines end as they did
