"""Compilation by numba, with a cache that notices every change.

numba keeps compiled functions on disk, but looks at the age of a function's own file only: where a compiled function
of another file has changed, a caller goes on with the old one. So the cache is in a folder named after the content of
every compiled source of the package and of what it imports; another content is another folder.
"""

import hashlib
import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba

_PACKAGE = Path(__file__).parents[1]
_MARK = b"ode.compiled import"
"""What a source with compiled functions holds."""
_IMPORT = re.compile(rb"^from divideropt\.([\w.]+) import", re.MULTILINE)


def compiled(function: Callable[..., Any]) -> Any:
    """Compile a function at its first call, or load it from the cache; division by zero gives infinity, as in numpy.

    Args:
        function: Of floats, arrays and records; it may call other compiled functions of the package.

    Returns:
        The dispatcher; `py_func` is the function itself.
    """
    given = numba.config.CACHE_DIR
    if not given:
        numba.config.CACHE_DIR = str(_FOLDER)
    try:
        return numba.njit(cache=True, nogil=True, error_model="numpy")(function)
    finally:
        numba.config.CACHE_DIR = given


def _folder() -> Path:
    digest = hashlib.sha256()
    for path in _sources():
        digest.update(path.read_bytes())
    name = f"compiled-{digest.hexdigest()[:16]}"
    beside = _PACKAGE / "__pycache__"
    if os.access(beside if beside.exists() else _PACKAGE, os.W_OK):
        return beside / name
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "divideropt" / name


def _sources() -> list[Path]:
    """Every source with compiled functions, and what these import: there are constants that were compiled in."""
    found: set[Path] = set()
    for path in _PACKAGE.rglob("*.py"):
        content = path.read_bytes()
        if _MARK in content:
            imported = (_PACKAGE.joinpath(*name.decode().split(".")) for name in _IMPORT.findall(content))
            found.update(path.with_suffix(".py") for path in imported)
            found.add(path)
    return sorted(path for path in found if path.is_file())


_FOLDER = _folder()
