"""YAML text to plain data, with the place of every key and value, and all of the text's mistakes at once.

A campaign needs no more of YAML 1.2 than mappings, lists and plain values. Anchors, aliases, tags, merge keys
and further documents are refused where they stand; nothing is expanded, so no file can blow up in memory.
The limits below are what a hostile file can cost: less than a second, and no more memory than the program itself.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError, YAMLError
from ruamel.yaml.events import (
    AliasEvent,
    DocumentStartEvent,
    Event,
    MappingEndEvent,
    MappingStartEvent,
    ScalarEvent,
    SequenceEndEvent,
    SequenceStartEvent,
    StreamEndEvent,
)
from ruamel.yaml.reader import ReaderError

from divideropt.campaign.scalars import resolved
from divideropt.campaign.textfile import read_text_file
from divideropt.errors import FileMistakes, Mistake, UsageError, shortened

KeyPath = tuple[str | int, ...]
"""Where a value is in the data: keys of mappings, indices of lists."""

LARGEST_FILE = 2**20
"""Bytes; a campaign of a hundred lines has some 4,000."""

DEEPEST = 32
"""Levels of nesting; a campaign needs five."""

MOST_VALUES = 10_000
"""Values and keys in a file; they bound the time a hostile file can take, to about a second."""

MOST_LINES = 20_000
"""Lines in a file; the parser takes its time over each, even over an empty one."""

LONGEST_LINE = 20_000
"""Characters in a line; the parser's time over one word grows with the square of its length."""

LONGEST_NAME = 200
"""Characters of an anchor, an alias or a tag, which are refused in any case; a longer one ends the reading."""

MOST_MISTAKES = 100
"""No more are listed: who made a hundred made one of them a hundred times."""


class Broken:
    """Stands in the data where the file has something refused, which has its own mistake already."""


@dataclass(frozen=True)
class Place:
    """A place in a file, both from 1."""

    line: int
    column: int


@dataclass(frozen=True)
class Document:
    """What a file says, and where.

    Attributes:
        path: The file, as the caller named it.
        data: Mappings, lists, strings, numbers, booleans, None; `Broken` where something was refused.
        keys: Places of the keys, by path.
        values: Places of the values, by path.
        mistakes: What was refused; the rest of the data can be judged all the same.
    """

    path: str
    data: object
    keys: dict[KeyPath, Place] = field(default_factory=dict)
    values: dict[KeyPath, Place] = field(default_factory=dict)
    mistakes: list[Mistake] = field(default_factory=list)

    def place(self, path: KeyPath, *, at_key: bool = False) -> Place:
        """Return where a value, or its key, stands; of something missing, the key of what should hold it."""
        if path in self.values and not at_key:
            return self.values[path]
        for n in range(len(path), 0, -1):
            found = self.keys.get(path[:n]) or self.values.get(path[:n])
            if found:
                return found
        return self.values.get((), Place(1, 1))

    def is_broken(self, path: KeyPath) -> bool:
        """Whether a path leads to or through something refused, of which nothing more is to be said."""
        data: Any = self.data
        for step in path:
            if isinstance(data, Broken):
                return True
            inside = step in data if isinstance(data, dict) else isinstance(data, list) and step in range(len(data))
            if not inside:
                return False
            data = data[step]
        return isinstance(data, Broken)


def read_document(path: Path | str) -> Document:
    """Read a YAML file.

    Args:
        path: The file: at most `LARGEST_FILE` bytes of UTF-8.

    Returns:
        Its data and places, with the mistakes after which reading could go on.

    Raises:
        UsageError: There is no such file, or it cannot be read, is too large or empty.
        FileMistakes: It is not UTF-8 or not YAML, or reading had to stop.
    """
    return read_text(read_text_file(path, LARGEST_FILE, "campaign"), str(path))


def read_text(text: str, path: str = "campaign") -> Document:
    """Read YAML text; `path` names it in mistakes. Otherwise as `read_document`."""
    _check_lines(text, path)
    walk = _Walk(text)
    try:
        document = walk.document(path)
    except _StopReading:
        raise FileMistakes(path, walk.mistakes) from None
    except YAMLError as error:
        raise FileMistakes(path, [_syntax_mistake(error, text, walk.here)]) from None
    except (
        ValueError,
        ArithmeticError,
        AssertionError,
    ):  # ruamel, of an escape beyond Unicode and of an absurd %YAML line
        message = "this cannot be read as YAML; look for an escape or a % directive from here on"
        raise FileMistakes(path, [Mistake(walk.here.line, walk.here.column, message)]) from None
    if document.data is None:
        raise UsageError(f"{path}: the file is empty; `divideropt init my.yaml` writes one to begin with")
    return document


def _check_lines(text: str, path: str) -> None:
    """Refuse what would keep the parser busy: too many lines, or too long a one."""
    lines = _LINE_END.split(text)
    for number, line in enumerate(lines[:MOST_LINES], start=1):
        if len(line) > LONGEST_LINE:
            message = f"the line has {len(line)} characters, the most permitted are {LONGEST_LINE}; break it"
            raise FileMistakes(path, [Mistake(number, LONGEST_LINE + 1, message)])
    if len(lines) > MOST_LINES + 1 or (len(lines) == MOST_LINES + 1 and lines[-1]):
        message = f"the file has more than {MOST_LINES} lines; a campaign has no use for so many"
        raise FileMistakes(path, [Mistake(MOST_LINES + 1, 1, message)])


def _syntax_mistake(error: YAMLError, text: str, here: Place) -> Mistake:
    if isinstance(error, ReaderError):
        before = _LINE_END.split(text[: error.position])
        message = f"the control character U+{ord(text[error.position]):04X} is not permitted in YAML; delete it"
        return Mistake(len(before), len(before[-1]) + 1, message)
    if not isinstance(error, MarkedYAMLError):
        return Mistake(here.line, here.column, "this is not YAML; check the lines around")
    mark = error.problem_mark or error.context_mark
    place = _place(mark) if mark else here
    problem = " ".join(filter(None, [error.context, error.problem]))
    if "\\t" in problem:
        problem = "a tab cannot indent or begin a value in YAML; use spaces"
    return Mistake(place.line, place.column, f"this is not YAML: {shortened(problem)}")


def _place(mark: Any) -> Place:
    return Place(mark.line + 1, mark.column + 1)


class _StopReading(Exception):
    """Reading cannot go on; the mistakes say why."""


class _Walk:
    """One pass over the parser's events, which never resolves an alias."""

    def __init__(self, text: str) -> None:
        self.events: Iterator[Event] = YAML(typ="safe", pure=True).parse(text)
        self.here = Place(1, 1)
        self.count = 0
        self.keys: dict[KeyPath, Place] = {}
        self.values: dict[KeyPath, Place] = {}
        self.mistakes: list[Mistake] = []

    def document(self, path: str) -> Document:
        data: object = None
        seen = False
        while not isinstance(event := self._next(), StreamEndEvent):
            if isinstance(event, DocumentStartEvent):
                if seen:
                    self._stop("a second document begins here; a campaign is one, so delete the line `---`")
                data, seen = self._node(self._next(), ()), True
        return Document(path, data, self.keys, self.values, self.mistakes)

    def _next(self) -> Event:
        event = next(self.events)
        self.here = _place(event.start_mark)
        self.count += 1
        if self.count > MOST_VALUES:
            self._stop(f"more than {MOST_VALUES} keys and values; a campaign has no use for so many")
        return event

    def _mistake(self, message: str, place: Place | None = None) -> None:
        place = place or self.here
        self.mistakes.append(Mistake(place.line, place.column, message))
        if len(self.mistakes) >= MOST_MISTAKES:
            raise _StopReading

    def _stop(self, message: str) -> None:
        self._mistake(message)
        raise _StopReading

    def _node(self, event: Any, path: KeyPath) -> object:
        place = self.values[path] = self._stands(event, path)
        self._check_names(event)
        if isinstance(event, AliasEvent):
            self._mistake(f"the alias *{event.anchor} is not permitted; write the value itself")
            return Broken()
        if len(path) > DEEPEST:
            self._stop(f"nested more than {DEEPEST} deep; a campaign needs five levels")
        if event.anchor is not None:
            self._mistake(
                f"the anchor &{event.anchor} is not permitted; delete it, and write values out where needed"
            )
        value = self._content(event, path)
        if event.tag is not None:
            self._mistake(f"the tag {event.tag} is not permitted; delete it, and write the plain value", place)
            return Broken()
        return value

    def _check_names(self, event: Any) -> None:
        for name in (event.anchor, getattr(event, "tag", None)):
            if name is not None and len(str(name)) > LONGEST_NAME:
                self._stop("anchors, aliases and tags are not permitted; delete this one, which is long besides")

    def _stands(self, event: Any, path: KeyPath) -> Place:
        """Return where a value stands; one that is left out, at its key."""
        absent = isinstance(event, ScalarEvent) and event.implicit[0] and not event.value
        return self.keys.get(path, self.here) if absent else self.here

    def _content(self, event: Any, path: KeyPath) -> object:
        if isinstance(event, MappingStartEvent):
            return self._mapping(path)
        if isinstance(event, SequenceStartEvent):
            return self._sequence(path)
        return resolved(event)

    def _sequence(self, path: KeyPath) -> list[object]:
        made: list[object] = []
        while not isinstance(event := self._next(), SequenceEndEvent):
            made.append(self._node(event, (*path, len(made))))
        return made

    def _mapping(self, path: KeyPath) -> dict[str, object]:
        made: dict[str, object] = {}
        while not isinstance(event := self._next(), MappingEndEvent):
            key = self._key(event, path, made)
            value = self._node(self._next(), (*path, _NAMELESS if key is None else key))
            if key is not None:
                made[key] = value
        return made

    def _key(self, event: Any, path: KeyPath, made: dict[str, object]) -> str | None:
        """Return the key, or None after having said why its entry cannot count."""
        place = self.here
        key = self._node(event, (*path, _NAMELESS))
        if isinstance(event, ScalarEvent) and event.implicit[0] and key == "<<":
            self._mistake("the merge key << is not permitted; write the entries out", place)
        elif not isinstance(key, str):
            if not isinstance(key, Broken):
                self._mistake("this key is not a name; keys are names, such as `spool_radius`", place)
        elif key in made:
            first = self.keys[(*path, key)].line
            self._mistake(
                f"{shortened(repr(key))} is here a second time, after line {first}; delete one of the two", place
            )
        else:
            self.keys[(*path, key)] = place
            return key
        return None


_NAMELESS = -1
"""Stands in the path of an entry without a usable key; no list has it as index."""

_LINE_END = re.compile("\r\n|[\n\r\x85\u2028\u2029]")
"""What ends a line in YAML 1.1, and in ruamel's scanner."""
