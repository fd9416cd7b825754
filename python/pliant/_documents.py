"""The text of a scene file, and its edits."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple, Optional, Tuple

from . import _core
from ._parts import _file_name
from ._scene import Scene, _root
from .edit import Operation, _json_text

if TYPE_CHECKING:
    from ._types import File


class TextEdit(NamedTuple):
    """A change of a text: from the byte `at` of its UTF-8 on, `removed` gives way to `inserted`."""

    at: int
    removed: str
    inserted: str


class Change(NamedTuple):
    """What an edit changed."""

    name: str  #: of the edit
    edits: Tuple[TextEdit, ...]  #: of the text, made one after the other
    parts: Tuple[str, ...]  #: `NAME.attribute`, or `NAME` of a whole object; sorted


_core.register(TextEdit=TextEdit, Change=Change)


class SceneDocument:
    """The text of a scene file, which operations change no more than they must.

    Comments, order, indentation, quotes and numbers that they do not touch stay byte for byte. It is
    always a scene that `validate` accepts: an edit that would make another one is refused with its
    problems, and changes nothing. `root` contains all files that it names. Raises InvalidInput and
    Unreadable, with file and line. Safe to call from several threads; it cannot be pickled.
    """

    __slots__ = ("_own",)

    def __init__(self, file: File, *, root: Optional[File] = None):
        self._own = _core.Document(_file_name(file), _root(root))

    @classmethod
    def from_text(cls, text: str, *, name: str = "<text>", folder: File = ".") -> "SceneDocument":
        """A document of a text; files in it are relative to `folder`, and `name` is told in messages."""
        made = cls.__new__(cls)
        made._own = _core.Document.from_text(text, name, _file_name(folder))
        return made

    @property
    def text(self) -> str:
        """The text as it is now."""
        return self._own.text

    @property
    def scene(self) -> Scene:
        """A new `Scene` of the text as it is now."""
        return self._own.scene

    @property
    def file(self) -> str:
        """The file, or the name of the text."""
        return self._own.file

    def apply(self, *operations: Operation, name: str = "") -> Change:
        """Makes operations of `pliant.edit` as one edit, all or nothing.

        `name` is that of the edit, by default what the first one does. Raises InvalidInput if one
        names what is not there or the scene would have a problem; TypeError for what is no
        operation.
        """
        return self._own.apply(_json_text(operations), name)

    def undo(self) -> Change:
        """Takes the last edit back. Raises InvalidInput if there is none."""
        return self._own.undo()

    def redo(self) -> Change:
        """Makes the last edit that was undone again. Raises InvalidInput if there is none."""
        return self._own.redo()

    @property
    def can_undo(self) -> bool:
        """Whether there is an edit to take back."""
        return self._own.can_undo

    @property
    def can_redo(self) -> bool:
        """Whether there is an edit to make again."""
        return self._own.can_redo

    @property
    def undo_name(self) -> str:
        """The name of the edit that `undo` takes back; empty: there is none."""
        return self._own.undo_name

    @property
    def redo_name(self) -> str:
        """The name of the edit that `redo` makes again; empty: there is none."""
        return self._own.redo_name

    def save(self) -> None:
        """Writes the file, whole or not at all. Raises Unwritable if another program has changed it."""
        self._own.save()

    def save_as(self, file: File) -> None:
        """Writes any file, which is the document's from then on. Raises InvalidInput, Unwritable."""
        self._own.save_as(_file_name(file))

    @property
    def is_saved(self) -> bool:
        """Whether the file was read or saved with this text."""
        return self._own.is_saved

    def has_file_changed(self) -> bool:
        """Whether the file has other bytes now than when it was read or saved. Raises Unreadable."""
        return self._own.has_file_changed()

    def __repr__(self) -> str:
        return f"<pliant.SceneDocument {self.file}>"

    def __reduce__(self) -> Any:
        raise TypeError("a SceneDocument cannot be pickled; pickle its text")
