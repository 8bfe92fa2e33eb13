"""A table as a file of the store: whole, checked, with the columns and the version that are expected.

Parquet's page checksums cover the pages, not the headers and the footer that say how to read them: of 6,634 single
bits turned in a part, one read wrong with them (`benchmarks/damage.py --page-checksums`). So a file also has a digest
of all its bytes, in a gap before its footer, where no reader of parquet looks.
"""

import hashlib
from collections.abc import Callable
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from divideropt.errors import DamagedFileError, StoreError
from divideropt.store.schema import check_version

Publish = Callable[[Path, Callable[[Path], object]], None]
"""One of the ways of `divideropt.store.files`."""

_MARK = b"divideropt:sha256:"
_GAP = len(_MARK) + hashlib.sha256().digest_size
_TAIL = 8
"""The length of the footer, little-endian in four bytes, and the letters PAR1."""


def write_table(path: Path, table: pa.Table, publish: Publish) -> None:
    """Publish a table.

    Raises:
        DiskError: The disk refused; what was there is as it was.
        StoreInUseError: The store is another's now.
    """
    content = worded(table)
    publish(path, lambda p: p.write_bytes(content))


def worded(table: pa.Table) -> bytes:
    """Word a table as a file."""
    sink = pa.BufferOutputStream()
    pq.write_table(table, sink, write_page_checksum=True)
    content: bytes = sink.getvalue().to_pybytes()
    footer = _footer(content)
    return content[:footer] + _MARK + hashlib.sha256(content).digest() + content[footer:]


def read_table(path: Path, schema: pa.Schema, remedy: str) -> pa.Table:
    """Read a table and check that it is whole and this campaign's.

    Args:
        path: The file.
        schema: The columns it must have, metadata aside.
        remedy: What to do if it is not so, for the message.

    Raises:
        DamagedFileError: It is damaged.
        StoreError: It is of another version, or has other columns.
    """
    try:
        content = path.read_bytes()
    except OSError as error:
        raise DamagedFileError(f"{path}: cannot be read ({error.strerror}); {remedy}") from error
    whole = _is_whole(content)
    if whole is False:
        raise DamagedFileError(f"{path}: damaged (not the bytes that were written); {remedy}")
    try:
        table = pq.ParquetFile(pa.BufferReader(content), page_checksum_verification=True).read()
    except (pa.ArrowException, OSError, ValueError) as error:
        raise DamagedFileError(f"{path}: damaged ({error}); {remedy}") from error
    check_version(table.schema, path)
    if not table.schema.equals(schema):
        raise StoreError(f"{path}: its columns are not this campaign's; {remedy}")
    if whole is None:
        raise DamagedFileError(f"{path}: damaged, or written by something else (no digest in it); {remedy}")
    return table


def check_replaceable(path: Path) -> None:
    """Refuse a file that a later version of this program wrote; one that is damaged may be replaced.

    Raises:
        StoreError: A later version wrote it.
    """
    try:
        content = path.read_bytes()
        if _is_whole(content) is False:
            return
        schema = pq.read_schema(pa.BufferReader(content))
    except (pa.ArrowException, OSError, ValueError):
        return
    check_version(schema, path)


def _is_whole(content: bytes) -> bool | None:
    """Compare a file with its digest; None where it has none."""
    footer = _footer(content)
    gap = footer - _GAP
    if gap < 0 or content[gap : gap + len(_MARK)] != _MARK:
        return None
    digest = hashlib.sha256(memoryview(content)[:gap])
    digest.update(memoryview(content)[footer:])
    return digest.digest() == content[gap + len(_MARK) : footer]


def _footer(content: bytes) -> int:
    """Where the footer begins; below 0 where there is none."""
    return len(content) - _TAIL - int.from_bytes(content[-_TAIL:-4], "little")
