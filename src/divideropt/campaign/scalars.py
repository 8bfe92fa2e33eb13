"""What a plain value of a YAML file means."""

import re

from ruamel.yaml.events import ScalarEvent

_NULL = frozenset({"", "~", "null", "Null", "NULL"})
_BOOL = {word: word.lower() == "true" for word in ("true", "True", "TRUE", "false", "False", "FALSE")}
_INTEGER = re.compile(r"[-+]?[0-9]{1,18}|0o[0-7]{1,18}|0x[0-9a-fA-F]{1,15}", re.ASCII)
"""Longer ones read as floats: no campaign counts so far, and Python refuses to."""
_FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?", re.ASCII)
_SPECIAL = re.compile(r"[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)")


def resolved(event: ScalarEvent) -> object:
    """Resolve a scalar by the core schema of YAML 1.2 (section 10.3); ruamel's own adds dates and 1_000.

    Returns:
        A string, a number, a boolean or None; of what is quoted always a string.
    """
    text = event.value
    if not event.implicit[0]:  # quoted
        return text
    if text in _NULL:
        return None
    if text in _BOOL:
        return _BOOL[text]
    if _INTEGER.fullmatch(text):
        return int(text) if text[1:2] not in ("o", "x") else int(text, 0)
    if _FLOAT.fullmatch(text):
        return float(text)
    return float(text.replace(".", "", 1)) if _SPECIAL.fullmatch(text) else text
