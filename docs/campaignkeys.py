"""The keys of a campaign's file as tables, from the sections that read it: the directive `campaign-keys`."""

from collections.abc import Iterator, Mapping
from typing import Any, get_args, get_origin

from docutils import nodes
from pydantic.fields import FieldInfo
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective
from sphinx.util.typing import ExtensionMetadata

from divideropt.campaign.config import Campaign
from divideropt.campaign.fields import Measure, OneOf
from divideropt.campaign.sections import Section
from divideropt.models import Domain

_KINDS = {bool: "`true` or `false`", int: "a whole number", str: "a text"}


def setup(app: Sphinx) -> ExtensionMetadata:
    """Register the directive."""
    app.add_directive("campaign-keys", _CampaignKeys)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}


def campaign_keys() -> str:
    """Write a heading a top-level key, and a row a key below it, as Markdown."""
    found = []
    for name, field in Campaign.model_fields.items():
        sections, needed = list(_sections(field)), "A campaign has it." if field.is_required() else "May be left out."
        found += [f"## {name}", "", f"{_words(field)} {needed}", ""]
        for section in sections:
            found += [(section.__doc__ or "").partition("\n")[0], ""] if len(sections) > 1 else []
            rows = _rows(section, _path(name, field))
            found += ["| key | is | given as | where not given |", "|---|---|---|---|", *rows, ""]
    return "\n".join(found)


class _CampaignKeys(SphinxDirective):
    def run(self) -> list[nodes.Node]:
        found = self.parse_text_to_nodes(campaign_keys(), allow_section_headings=True)
        for table in (table for node in found for table in node.findall(nodes.table)):
            table["classes"].append("keys")
        return found


def _rows(section: type[Section], path: str) -> Iterator[str]:
    """Write the keys of a section, and of the sections that they take."""
    for name, field in section.model_fields.items():
        key = f"{path}.{name}"
        yield f"| `{key}` | {_words(field)} | {_given(field)} | {_default(field)} |"
        for inner in _sections(field):
            yield from _rows(inner, _path(key, field))


def _sections(field: FieldInfo) -> Iterator[type[Section]]:
    parts = _parts(field.annotation)
    return (part for part in parts if isinstance(part, type) and issubclass(part, Section))


def _path(key: str, field: FieldInfo) -> str:
    """Say where the keys below a key are: in it, by a name of the user's own, or in each of a list."""
    parts = list(_parts(field.annotation))
    return key + (".NAME" if Mapping in parts else "[…]" if tuple in parts else "")


def _parts(annotation: Any) -> Iterator[Any]:
    """Take an annotation to pieces: what it is made of, and what that is made of."""
    origin = get_origin(annotation)
    yield annotation if origin is None else origin
    for part in get_args(annotation):
        yield from _parts(part)


def _words(field: FieldInfo) -> str:
    return " ".join((field.description or "").split()).replace("|", "\\|")


def _measure(field: FieldInfo) -> Measure | None:
    return next((part for part in (*field.metadata, *_parts(field.annotation)) if isinstance(part, Measure)), None)


def _given(field: FieldInfo) -> str:
    """Say what to write: a measure and its domain, one of some names, or a kind of value."""
    measure, parts = _measure(field), list(_parts(field.annotation))
    if measure is not None:
        limit = "" if measure.domain == Domain() else f", {measure.domain}"
        text = f"in {measure.unit}{limit}" if measure.unit else f"a number{limit}"
        return f"two, each {text}" if tuple in parts else text
    names = next((entry for entry in field.metadata if isinstance(entry, OneOf)), None)
    if names is not None:
        return ", ".join(f"`{name}`" for name in names.names)
    if {Mapping, dict, tuple} & set(parts):
        return "by name" if Mapping in parts or dict in parts else "a list"
    return next((words for kind, words in _KINDS.items() if kind in parts), "")


def _default(field: FieldInfo) -> str:
    """Say what stands where nothing is given, as it would be written; nothing where the sentence says it."""
    if field.is_required():
        return "has to be given"
    measure = _measure(field)
    values = field.default if isinstance(field.default, tuple) else (field.default,)
    if not values or not all(isinstance(value, bool | int | float | str) for value in values):
        return ""
    texts = [
        f"{value:g} {measure.unit}".strip()
        if measure
        else str(value).lower()
        if isinstance(value, bool)
        else str(value)
        for value in values
    ]
    return f"`{', '.join(texts)}`"
