"""What computes: versions and processor, kept with a store, because either may change the last bits of a number."""

import hashlib
import json
import platform
from collections.abc import Mapping
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from llvmlite import binding

from divideropt.store.files import Check, publish

LIBRARIES = ("divideropt", "numpy", "scipy", "numba", "pymoo", "moocore")
"""Whose arithmetic and decisions are in a log."""

_SHOWN = 5
"""Processor features that are named in a message."""


def keep_fingerprint(path: Path, allowed: Check) -> str | None:
    """Add this machine to a store's file of those that wrote to it, if it is not the last there.

    Args:
        path: The file: a list in JSON, the latest last, with its digest.
        allowed: Asked before it is replaced.

    Returns:
        What is other than with the last writer, in a line; None where nothing is, or nobody wrote yet.

    Raises:
        DiskError: The disk refused.
    """
    before, now = _read(path), fingerprint()
    if before and before[-1] == now:
        return None
    writers = [*(before or []), now]
    text = json.dumps({"sha256": _digest(writers), "writers": writers}, indent=1)
    publish(path, lambda p: p.write_text(text, encoding="utf-8"), allowed)
    if before is None:
        return f"{path}: damaged, so nobody knows what wrote to this store before; {_JUDGE}"
    return f"this store was written with {_differences(before[-1], now)}; {_JUDGE}" if before else None


_JUDGE = "whether that matters is seen when what is logged is compared, bit by bit"


def read_fingerprints(path: Path) -> tuple[dict[str, str], ...]:
    """Return a store's list of those that wrote to it, the latest last; empty where nobody knows."""
    return tuple(_read(path) or ())


def fingerprint() -> dict[str, str]:
    """Versions by name, and the processor as the compiler knows it."""
    features: Mapping[str, bool] = binding.get_host_cpu_features()
    return {
        "python": platform.python_version(),
        **{name: _version(name) for name in LIBRARIES},
        "processor": binding.get_host_cpu_name(),
        "features": " ".join(sorted(name for name, has in features.items() if has)),
    }


def _read(path: Path) -> list[dict[str, str]] | None:
    """Read the file; None where it cannot be understood."""
    try:
        found: Any = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return []
    except (OSError, ValueError):
        return None
    if isinstance(found, dict):  # a list alone has no digest: so it was written before there was one
        writers = found.get("writers")
        found = writers if _digest(writers) == found.get("sha256") else None
    known = isinstance(found, list) and all(isinstance(entry, dict) for entry in found)
    return [{str(k): str(v) for k, v in entry.items()} for entry in found] if known else None


def _digest(writers: object) -> str:
    return hashlib.sha256(json.dumps(writers).encode("utf-8")).hexdigest()


def _differences(before: Mapping[str, str], now: Mapping[str, str]) -> str:
    words = [
        f"{name} {before.get(name, 'unknown')} (now {value})"
        for name, value in now.items()
        if name != "features" and before.get(name) != value
    ]
    had, has = (set(entry.get("features", "").split()) for entry in (before, now))
    for word, features in (("lost", had - has), ("new", has - had)):
        if features:
            more = "" if len(features) <= _SHOWN else f" and {len(features) - _SHOWN} more"
            words.append(f"processor features {word}: {' '.join(sorted(features)[:_SHOWN])}{more}")
    return ", ".join(words)


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed as a package"
