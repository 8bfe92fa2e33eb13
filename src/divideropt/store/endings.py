"""How a run ended, kept beside its log: a small file in JSON, with a digest of what it says."""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from divideropt.errors import DamagedFileError
from divideropt.store.files import Check, make_folder, publish

LARGEST = 2**16
"""No such file is larger [bytes]."""


@dataclass(frozen=True)
class EndingRecord:
    """How a run ended.

    Attributes:
        reason: A word for it.
        text: A sentence about it.
        evaluations: How many the log held then; with more or fewer the record is out of date.
        asked: What the run was asked for: its budget and its termination, as plain data. Asked for something else,
            it need not end there.
    """

    reason: str
    text: str
    evaluations: int
    asked: Mapping[str, Any] = field(default_factory=dict)


def write_ending(path: Path, record: EndingRecord, allowed: Check) -> None:
    """Publish a record, if it is not there already.

    Raises:
        DiskError: The disk refused; what was there is as it was.
        StoreInUseError: The store is another's now.
    """
    said = asdict(record)
    content = json.dumps({**said, "sha256": _digest(said)}, indent=1, sort_keys=True).encode() + b"\n"
    if path.is_file() and path.stat().st_size == len(content) and path.read_bytes() == content:
        return
    allowed()  # a store that is gone is not made anew
    make_folder(path.parent)  # which another run's process may do at the same time
    publish(path, lambda p: p.write_bytes(content), allowed)


def read_ending(path: Path) -> EndingRecord | None:
    """Read a record, or None if there is none.

    Raises:
        DamagedFileError: It is damaged; it follows from the log.
    """
    try:
        if path.stat().st_size > LARGEST:
            raise _damaged(path, f"larger than {LARGEST // 2**10} KiB")
        content = path.read_bytes()
        said = json.loads(content)
        digest = said.pop("sha256")
        record = EndingRecord(**said)
    except FileNotFoundError:
        return None
    except OSError as error:
        raise _damaged(path, str(error.strerror)) from error
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError) as error:
        raise _damaged(path, "not what was written") from error
    if digest != _digest(said):
        raise _damaged(path, "changed since it was written")
    return record


def _digest(said: Mapping[str, Any]) -> str:
    return hashlib.sha256(json.dumps(said, sort_keys=True).encode()).hexdigest()


def _damaged(path: Path, reason: str) -> DamagedFileError:
    return DamagedFileError(
        f"{path}: damaged ({reason}); it follows from the log: delete it and run the campaign again"
    )
