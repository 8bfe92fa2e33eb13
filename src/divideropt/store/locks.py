"""Locks of the kernel's, which end with the process that has them."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from filelock import FileLock, Timeout

from divideropt.errors import StoreInUseError, UsageError
from divideropt.store.files import disk_errors, make_folder


@contextmanager
def held(folder: Path, name: str, patience: float, reason: Callable[[], str]) -> Iterator[None]:
    """Hold a lock as long as this lasts.

    Args:
        folder: Where it is; made if it is not there.
        name: Its file.
        patience: How long to wait for it [s].
        reason: Says who has it, for the message.

    Raises:
        StoreInUseError: Another process keeps holding it.
        UsageError: A file is where the folder should be.
        DiskError: The disk refused.
    """
    if folder.exists() and not folder.is_dir():
        raise UsageError(f"{folder}: a file, not a folder; name another --store")
    make_folder(folder)
    with disk_errors(folder):
        lock = FileLock(folder / name, timeout=patience)
        try:
            lock.acquire()
        except Timeout:
            raise StoreInUseError(f"{folder}: {reason()}; wait until it is done, or name another --store") from None
    try:
        yield
    finally:
        lock.release()
