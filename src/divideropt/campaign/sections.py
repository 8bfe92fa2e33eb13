"""Sections of a campaign: pydantic models that say everything wrong with them at once, in sentences."""

import difflib
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any, Self, TypeVar

from pydantic import BaseModel, ConfigDict, ModelWrapValidatorHandler, ValidationError, model_validator
from pydantic_core import ErrorDetails, InitErrorDetails, PydanticCustomError

from divideropt.campaign.reader import MOST_MISTAKES

Loc = tuple[str | int, ...]
K = TypeVar("K", str, int)
V = TypeVar("V")

FEW = 12
"""So many names are listed in a mistake; of more, it points to `divideropt schema`."""


MOST_COMPARED = 500
"""So many names are looked through for one that was meant; a model's own, without its scenarios, come first."""


class Section(BaseModel):
    """A part of a campaign: frozen, without unknown keys, its mistakes sentences."""

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)

    @classmethod
    def rules(cls, raw: Mapping[str, Any]) -> Iterator[InitErrorDetails]:
        """Yield what is wrong between fields, judged on the section as written, even if a field is wrong."""
        yield from ()

    @model_validator(mode="wrap")
    @classmethod
    def _everything_at_once(cls, data: Any, handler: ModelWrapValidatorHandler[Self]) -> Self:
        found: list[InitErrorDetails] = []
        made: Self | None = None
        try:
            made = handler(data)
        except ValidationError as error:
            found = relay(error, names=cls.model_fields)
        if isinstance(data, Mapping):
            found += cls.rules(data)
        if made is None or found:
            raise together(found)
        return made


def section_of(raw: Mapping[str, Any], name: str) -> Mapping[str, Any]:
    """Return a section as written; empty where it is not there, or no mapping, which has its own mistake."""
    section = raw.get(name)
    return section if isinstance(section, Mapping) else {}


def mistake(loc: Loc, sentence: str, *, at_key: bool = False) -> InitErrorDetails:
    """Word one mistake.

    Args:
        loc: Where, from the section that says it.
        sentence: Value, limit, reason and remedy.
        at_key: Whether the key is wrong, not the value.
    """
    context = {"sentence": sentence, "at_key": at_key}
    return {"type": PydanticCustomError("mistake", "{sentence}", context), "loc": loc, "input": None}


def together(found: list[InitErrorDetails]) -> ValidationError:
    """Return one error that holds all mistakes; pydantic puts the outer path before theirs."""
    return ValidationError.from_exception_data("campaign", found)


def relay(error: ValidationError, prefix: Loc = (), names: Iterable[str] = ()) -> list[InitErrorDetails]:
    """Reword pydantic's errors as mistakes; `names` are those known where a key is not."""
    found = []
    for detail in error.errors(include_url=False)[:MOST_MISTAKES]:
        at_key = detail["type"] == "extra_forbidden" or bool(detail.get("ctx", {}).get("at_key"))
        if detail["type"] == "extra_forbidden":
            sentence = unknown("key", str(detail["loc"][-1]), names)
        else:
            sentence = _sentence(detail)
        if detail["type"] != "default_factory_not_called":  # follows from a mistake that is listed
            found.append(mistake((*prefix, *detail["loc"]), sentence, at_key=at_key))
    return found


def collect(value: object, names: Iterable[K], what: str, read: Callable[[K, object], V]) -> dict[K, V]:
    """Read a mapping from known names, in its own order.

    Args:
        value: The mapping as written.
        names: What may be a key.
        what: What a key is called: "parameter", "quantity", …
        read: Reads one entry by name; raises ValueError.

    Returns:
        What `read` made, by name.

    Raises:
        ValidationError: Every mistake of the mapping.
        ValueError: It is not a mapping.
    """
    if not isinstance(value, Mapping):
        raise ValueError(f"{show(value)} is not a mapping; write lines of the form `{what}: value` under this key")
    found: list[InitErrorDetails] = []
    made = {}
    for name, raw in value.items():
        if len(found) >= MOST_MISTAKES:
            break
        if name not in names:
            found.append(mistake((name,), unknown(what, str(name), map(str, names)), at_key=True))
            continue
        try:
            made[name] = read(name, raw)
        except ValidationError as error:
            found += relay(error, (name,))
        except ValueError as error:
            found.append(mistake((name,), str(error)))
    if found:
        raise together(found)
    return made


def unknown(what: str, name: str, names: Iterable[str]) -> str:
    """Say that a name is not known, and which are."""
    known = list(names)
    close = nearest(name, known)
    if close is not None:
        return f"the {what} {show(name)} is not known; did you mean {close}?"
    if len(known) > FEW:
        return f"the {what} {show(name)} is not known; `divideropt schema` lists the {len(known)} that are"
    return f"the {what} {show(name)} is not known; use {'one of ' * (len(known) > 1)}{', '.join(known)}"


def nearest(name: str, names: Iterable[str]) -> str | None:
    """Return the name that somebody may have meant who wrote another; None where there is none like it."""
    close = difflib.get_close_matches(name[:60], list(names)[:MOST_COMPARED], n=1)
    return close[0] if close else None


def show(value: object) -> str:
    """Write a value as the file has it, shortened."""
    if isinstance(value, Mapping):
        return "a mapping"
    if isinstance(value, list | tuple):
        return "a list"
    if value is None or isinstance(value, bool):
        return {None: "null", True: "true", False: "false"}[value]
    if isinstance(value, float) and value - value != 0.0:
        return ".nan" if value != value else "-.inf" if value < 0 else ".inf"  # noqa: PLR0124 (NaN is not itself)
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:56]}…{text[0]}" if isinstance(value, str) else f"{text[:56]}…"


_SENTENCES = {
    "mistake": "{sentence}",
    "value_error": "{error}",
    "model_type": "{value} is not a mapping; write lines of the form `key: value` under this key",
    "dict_type": "{value} is not a mapping; write lines of the form `key: value` under this key",
    "tuple_type": "{value} is not a list; write it in brackets, such as [a, b]",
    "too_short": "the list has {actual_length} values; write at least {min_length}",
    "too_long": "the list has {actual_length} values; write at most {max_length}",
    "int_type": "{value} is not a whole number; write one such as 10",
    "int_from_float": "{value} is not a whole number; write one such as 10",
    "greater_than_equal": "{value} is too small; the least permitted is {ge}",
    "less_than_equal": "{value} is too large; the most permitted is {le}",
    "literal_error": "{value} is not permitted; use {expected}",
    "bool_type": "{value} is neither true nor false; write one of them",
    "string_type": "{value} is not a word; write one, in quotes if it looks like a number",
}
"""What pydantic finds, as value, limit and remedy."""


def _sentence(detail: ErrorDetails) -> str:
    if detail["type"] == "missing":
        key = detail["loc"][-1]
        return f"{key!r} is missing; add it" if isinstance(key, str) else f"value {key + 1} is missing; add it"
    template = _SENTENCES.get(detail["type"], "{value} is not permitted here")
    return template.format(value=show(detail["input"]), **detail.get("ctx", {}))
