"""Publishing a file: written under a temporary name, forced to disk, given its name, the folder forced to disk."""

import os
import secrets
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from errno import EEXIST, EMLINK, ENOSYS, ENOTDIR, ENOTEMPTY, EOPNOTSUPP, EPERM
from pathlib import Path

from divideropt.errors import DiskError, StoreInUseError, UsageError

TEMPORARY_PREFIX = ".new-"
"""Readers pass over names that begin with a dot."""

Write = Callable[[Path], object]
"""Writes the content to the path it is given."""

Check = Callable[[], None]
"""Raises where this process may not publish any more; asked right before a file gets its name."""

_LINKLESS = (EPERM, EOPNOTSUPP, ENOSYS, EMLINK)

_unsure: dict[Path, str] = {}
"""Folders in which a forced write failed in this process, and how: what the system says of their files is not known
to be on disk, a second fsync would say it is, so nothing is written there any more."""


def _always() -> None:
    return


def publish(path: Path, write: Write, allowed: Check = _always) -> None:
    """Write a file so that it is there whole or not at all, also after a crash; an older one is replaced at once.

    Args:
        path: Where it shall be; its folder is there.
        write: Writes the content to the path it is given.
        allowed: Asked before the old file is replaced.

    Raises:
        UsageError: `path` is there and no regular file, such as a device.
        DiskError: The disk refused; `path` is as it was.
    """
    path = path.resolve()  # a link stays a link to what is replaced
    if path.exists() and not path.is_file():
        raise UsageError(f"{path}: not a regular file, so it is not replaced; name another")
    with _staged(path, write, allowed) as temporary:
        temporary.replace(path)
        _force(path.parent, path.parent)


def publish_once(path: Path, write: Write, allowed: Check = _always) -> None:
    """Write a file that nothing ever replaces: it gets its name by a link, which fails where the name is taken.

    Raises:
        StoreInUseError: The file is there: another process writes here too.
        DiskError: The disk refused, the folder is gone, or its filesystem knows no links; nothing is at `path`.
    """
    path = path.resolve()
    with _staged(path, write, allowed) as temporary:
        _link(temporary, path)
        with suppress(OSError):  # then the next writer removes it
            temporary.unlink()
        _force(path.parent, path.parent)


def publish_folder(path: Path, write: Write, allowed: Check = _always) -> None:
    """Write a file whose folder is not there yet: the folder appears, by rename, with the file in it.

    Raises:
        StoreInUseError: The folder has got files meanwhile: another process writes here too.
        DiskError: The disk refused; the folder is not there.
    """
    path = path.resolve()
    folder = path.parent
    allowed()  # a store that is gone is not made anew
    make_folder(folder.parent)
    with _staged(folder, lambda staging: _fill(staging, path, write), allowed) as staging:
        try:
            staging.rename(folder)  # which replaces no folder but an empty one
        except OSError as error:
            if error.errno == ENOTEMPTY:
                raise _taken(folder) from error
            raise
        _force(folder.parent, folder)


def publish_tree(folder: Path, write: Write) -> None:
    """Make a folder of files that is there with all of them or not at all; nothing is ever replaced.

    Args:
        folder: Which; the folder above it is there.
        write: Writes files into the folder it is given, each forced to disk.

    Raises:
        UsageError: The folder is there and not empty, or the one above it is not there.
        DiskError: The disk refused; the folder is not there.
    """
    whole = folder.resolve()
    if not whole.parent.is_dir():
        raise UsageError(f"{folder}: there is no folder {folder.parent}; make it first")
    if whole.exists() and (not whole.is_dir() or any(whole.iterdir())):
        raise _in_the_way(folder)
    with disk_errors(folder):
        for old in whole.parent.glob(f"{TEMPORARY_PREFIX}*-{whole.name}"):
            if not _lives(old.name.removeprefix(TEMPORARY_PREFIX).split("-")[0]):
                _remove(old)  # of a process that was killed

    def fill(staging: Path) -> None:
        staging.mkdir()
        write(staging)

    with _staged(whole, fill, _always) as staging:
        try:
            staging.rename(whole)  # which replaces no folder but an empty one
        except OSError as error:
            if error.errno in (ENOTEMPTY, EEXIST, ENOTDIR):
                raise _in_the_way(folder) from error
            raise
        _force(whole.parent, whole.parent)


def make_folder(folder: Path) -> None:
    """Make a folder and what is missing above it, each forced to disk before the next.

    Raises:
        DiskError: The disk refused.
    """
    missing = [path for path in (folder, *folder.parents) if not path.exists()]
    with disk_errors(folder):
        for path in reversed(missing):
            path.mkdir(exist_ok=True)
            _force(path.parent, path)


def check_links(folder: Path) -> None:
    """Try whether a folder's filesystem knows links, before anything is computed that could not be published.

    Raises:
        DiskError: It does not, or the disk refused.
    """
    first, second = (folder / _temporary_name("link") for _ in range(2))
    with disk_errors(folder):
        try:
            first.touch()
            _link(first, second)
        finally:
            first.unlink(missing_ok=True)
            second.unlink(missing_ok=True)


def clear_temporaries(folder: Path) -> None:
    """Remove what killed processes left in a folder; for its only writer to call.

    Raises:
        DiskError: The disk refused.
    """
    with disk_errors(folder):
        for path in folder.glob(f"{TEMPORARY_PREFIX}*"):
            if _lives(path.name.removeprefix(TEMPORARY_PREFIX).split("-")[0]):
                continue  # somebody is writing the report
            if path.is_dir():
                shutil.rmtree(path)
            else:
                path.unlink(missing_ok=True)


@contextmanager
def disk_errors(path: Path) -> Iterator[None]:
    """Turn what the operating system says of a path into a `DiskError` that says what to do."""
    try:
        yield
    except OSError as error:
        raise _refused(path, error.strerror or str(error)) from error


@contextmanager
def _staged(target: Path, write: Write, allowed: Check) -> Iterator[Path]:
    """Write a file or a folder under a temporary name beside `target`, and remove it where it gets no other."""
    before = _unsure.get(target) or _unsure.get(target.parent)
    if before:
        raise _refused(
            target, f"{before} when a write was forced to disk (fsync), so this process writes here no more"
        )
    temporary = target.with_name(_temporary_name(target.name))
    with disk_errors(target):
        try:
            allowed()
            write(temporary)
            _force(temporary, target.parent if temporary.is_file() else target)
            allowed()
            yield temporary
        except BaseException as error:
            _remove(temporary)
            if isinstance(error, FileNotFoundError):
                allowed()  # a new owner of the store clears what an earlier one was writing
            raise


def _fill(staging: Path, path: Path, write: Write) -> None:
    staging.mkdir()
    write(staging / path.name)
    _force(staging / path.name, path.parent)


def _link(old: Path, new: Path) -> None:
    try:
        os.link(old, new)
    except FileExistsError as error:
        raise _taken(new) from error
    except OSError as error:
        if error.errno in _LINKLESS:
            raise DiskError(
                f"{new.parent}: this filesystem knows no hard links ({error.strerror}), by which parts are published "
                "without ever replacing one; name a --store on another"
            ) from error
        raise


def _force(path: Path, unsure: Path) -> None:
    """Force a file or a folder to disk; where that fails, `unsure` is written no more. Never tried again."""
    descriptor = os.open(path, os.O_RDONLY if path.is_dir() else os.O_RDWR)
    try:
        os.fsync(descriptor)
    except OSError as error:
        _unsure[unsure] = str(error.strerror)
        raise
    finally:
        os.close(descriptor)


def _temporary_name(name: str) -> str:
    """The process is in it, so that what a dead one left is known; and something random, for other machines."""
    return f"{TEMPORARY_PREFIX}{os.getpid()}-{secrets.token_hex(4)}-{name}"


def _lives(process: str) -> bool:
    """Whether there is another process of that number on this machine."""
    if not process.isdigit() or int(process) == os.getpid():
        return False
    try:
        os.kill(int(process), 0)
    except (ProcessLookupError, OverflowError):
        return False
    except PermissionError:
        return True
    return True


def _remove(path: Path) -> None:
    if path.is_dir():
        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink(missing_ok=True)


def _in_the_way(folder: Path) -> UsageError:
    return UsageError(f"{folder}: is there already, and is not replaced; name another folder, or delete it first")


def _taken(path: Path) -> StoreInUseError:
    return StoreInUseError(
        f"{path}: there already, so another process writes to this store; nothing was replaced. Wait until it is "
        "done, then run the same command again"
    )


def _refused(path: Path, reason: str) -> DiskError:
    return DiskError(
        f"{path}: {reason}. What was logged before is intact: make room or mend the folder, then run the "
        "same command again."
    )
