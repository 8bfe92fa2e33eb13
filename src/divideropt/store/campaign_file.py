"""The campaign as resolved, in a store: YAML behind a line with its digest."""

import hashlib
from pathlib import Path

from divideropt.errors import DamagedFileError
from divideropt.store.files import Check, publish

LARGEST_CAMPAIGN = 2**22
"""No campaign as resolved is larger [bytes]: a campaign's file may have a quarter of it."""

_DIGEST = "# written by divideropt, which refuses it where it was changed; sha256: "


def read_campaign(path: Path) -> str:
    """Return the YAML without its first line.

    Raises:
        DamagedFileError: It cannot be read, or was changed.
    """
    try:
        if path.stat().st_size > LARGEST_CAMPAIGN:
            raise _damaged(path, f"larger than {LARGEST_CAMPAIGN // 2**20} MiB")
        content = path.read_bytes()
    except OSError as error:
        raise _damaged(path, str(error.strerror)) from error
    first, _, text = content.partition(b"\n")
    if first != _digest(text):
        raise _damaged(path, "changed since it was written")
    return text.decode("utf-8")


def write_campaign(path: Path, text: str, allowed: Check) -> None:
    """Replace it.

    Raises:
        DiskError: The disk refused.
        StoreInUseError: The store is another's now.
    """
    content = text.encode("utf-8")
    publish(path, lambda p: p.write_bytes(_digest(content) + b"\n" + content), allowed)


def _digest(text: bytes) -> bytes:
    return f"{_DIGEST}{hashlib.sha256(text).hexdigest()}".encode()


def _damaged(path: Path, reason: str) -> DamagedFileError:
    return DamagedFileError(f"{path}: damaged ({reason}); restore it, or start anew (--fresh)")
