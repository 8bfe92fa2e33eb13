"""A table as a file of the store: whole, checked, with the columns and the version that are expected."""

from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from divideropt.errors import StoreError
from divideropt.store.files import disk_errors, publish
from divideropt.store.schema import check_version


def write_table(path: Path, table: pa.Table) -> None:
    """Publish a table; its folder is made if need be, an older file replaced.

    Raises:
        DiskError: The disk refused; what was there is as it was.
    """
    with disk_errors(path.parent):
        path.parent.mkdir(parents=True, exist_ok=True)
    publish(path, lambda p: pq.write_table(table, p, write_page_checksum=True))


def read_table(path: Path, schema: pa.Schema, remedy: str) -> pa.Table:
    """Read a table and check that it is whole and this campaign's.

    Args:
        path: The file.
        schema: The columns it must have, metadata aside.
        remedy: What to do if it is not so, for the message.

    Raises:
        StoreError: It is damaged, of another version, or has other columns.
    """
    try:
        table = pq.ParquetFile(path, page_checksum_verification=True).read()
    except (pa.ArrowException, OSError) as error:
        raise StoreError(f"{path}: damaged ({error}); {remedy}") from error
    check_version(table.schema, path)
    if not table.schema.equals(schema):
        raise StoreError(f"{path}: its columns are not this campaign's; {remedy}")
    return table
