"""Publishing a file: written under a temporary name, forced to disk, renamed, the folder forced to disk."""

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from divideropt.errors import DiskError, UsageError

TEMPORARY_PREFIX = ".new-"
"""Readers pass over names that begin with a dot."""


def publish(path: Path, write: Callable[[Path], None]) -> None:
    """Write a file so that it is there whole or not at all, also after a crash.

    Args:
        path: Where it shall be; an older file there is replaced at once.
        write: Writes the content to the path it is given.

    Raises:
        UsageError: `path` is there and no regular file, such as a device.
        DiskError: The disk refused; `path` is as it was.
    """
    path = path.resolve()  # a link stays a link to what is replaced
    if path.exists() and not path.is_file():
        raise UsageError(f"{path}: not a regular file, so it is not replaced; name another")
    temporary = path.with_name(f"{TEMPORARY_PREFIX}{os.getpid()}-{path.name}")
    with disk_errors(path):
        try:
            write(temporary)
            _force(temporary, os.O_RDWR)
            temporary.rename(path)
        except BaseException:
            temporary.unlink(missing_ok=True)
            raise
        _force(path.parent, os.O_RDONLY)


@contextmanager
def disk_errors(path: Path) -> Iterator[None]:
    """Turn what the operating system says of a path into a `DiskError` that says what to do."""
    try:
        yield
    except OSError as error:
        reason = error.strerror or str(error)
        raise DiskError(
            f"{path}: {reason}. What was logged before is intact: make room or mend the folder, then run the "
            "same command again."
        ) from error


def _force(path: Path, flags: int) -> None:
    """Force a file or a folder to disk."""
    descriptor = os.open(path, flags)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
