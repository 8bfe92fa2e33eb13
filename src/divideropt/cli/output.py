"""What commands share: how they read a campaign, and how they write data and say words."""

import errno
import os
import stat
import sys
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from divideropt.errors import DiskError, UsageError

if TYPE_CHECKING:
    import pandas as pd

    from divideropt.campaign.config import Campaign

# ruff: noqa: PLC0415 (what takes time is imported where it is needed)


_MISTAKEN = (errno.ENAMETOOLONG, errno.EACCES, errno.ELOOP, errno.ENOTDIR)
"""What the system says of a path that cannot be meant."""


class _File(click.Path):
    """A path by which something can be looked up, whether or not it is there."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Read it; what the system refuses is a mistake of the user's, and no later look need expect it.

        Raises:
            UsageError: A name is too long, or a folder on the way or at its end is not to be entered.
        """
        path = Path(os.fsdecode(super().convert(value, param, ctx)))
        try:
            if stat.S_ISDIR(path.stat().st_mode):
                (path / "campaign.yaml").stat()
        except OSError as error:
            if error.errno not in _MISTAKEN:  # not there, or the disk's failure
                return path
            raise UsageError(f"{path}: {error.strerror}; name another path") from None
        return path


FILE = _File(path_type=Path)

AS_JSON = click.option("--json", "as_json", is_flag=True, help="As JSON on standard output.")

WORKERS = click.option(
    "--workers", type=click.IntRange(1, 256), help="Processes at a time; the campaign's where not given."
)


def load(path: Path | None, *, to_simulate: bool = True) -> "Campaign":
    """Read a campaign; the one that ships with the package where none is given. Raises as `load_campaign`."""
    from divideropt.campaign.reader import read_document

    document = None if path is None else read_document(path)  # before the rest is imported, which takes a second
    from divideropt.campaign.load import campaign_of, default_campaign

    if to_simulate:
        say_when_compiling()
    return default_campaign() if document is None else campaign_of(document)


def say_when_compiling() -> None:
    """Say so when this process first compiles something."""
    from divideropt.campaign.compiling import say_when_compiling as listen

    listen(sys.stderr)


def check_out(out: Path | None, known: tuple[str, ...], read: Path | None = None) -> None:
    """Refuse an output that cannot be written, or that would replace what is read or belongs to a store.

    Args:
        out: Where to; None for standard output.
        known: How its name may end.
        read: The file that the command reads, if any.

    Raises:
        UsageError: It is refused.
    """
    if out is None:
        return
    if out.suffix not in known:
        raise UsageError(f"--out {out}: the name must end in {_any_of(known)}")
    if not out.parent.is_dir():
        raise UsageError(f"--out {out}: there is no folder {out.parent}; make it first")
    if read is not None and out.exists() and read.exists() and out.samefile(read):
        raise UsageError(f"--out {out}: that is the file to be read; name another")
    whole = out.resolve()
    stores = [p for p in whole.parents if (p / "campaign.yaml").is_file() and (p / "evaluations").is_dir()]
    if stores and whole != stores[0] / "report.html":
        raise UsageError(f"--out {out}: that is inside the store {stores[0]}; name a file elsewhere")


def _any_of(words: tuple[str, ...]) -> str:
    return " or ".join(filter(None, [", ".join(words[:-1]), words[-1]]))


def write_table(table: "pd.DataFrame", out: Path | None) -> None:
    """Write a table to a file by its ending, or as CSV to standard output.

    Raises:
        DiskError: The disk refused.
    """
    if out is None:
        write_data(table.to_csv(index=False))
        return
    from divideropt.store.files import publish

    def write(path: Path) -> Any:
        return table.to_parquet(path, index=False) if out.suffix == ".parquet" else table.to_csv(path, index=False)

    publish(out, write)


def write_text(text: str, out: Path) -> None:
    """Write a text to a file, there whole or not at all.

    Raises:
        DiskError: The disk refused.
    """
    from divideropt.store.files import publish

    publish(out, lambda path: path.write_text(text, encoding="utf-8"))


def write_json(data: Any) -> None:
    """Write plain data as JSON to standard output; null for what is no finite number."""
    import json

    write_data(json.dumps(_finite(data), indent=2, ensure_ascii=False, allow_nan=False) + "\n")


def write_data(text: str) -> None:
    """Write to standard output; a reader who has seen enough is no mistake, a full disk is.

    Raises:
        DiskError: The disk refused, or standard output is closed.
    """
    if sys.stdout is None:
        raise DiskError("standard output is closed; give --out, or let it be open")
    try:
        sys.stdout.write(text)
        sys.stdout.flush()
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except OSError as error:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        raise DiskError(f"standard output: {error.strerror}; nothing in a store was touched") from error


def plural(count: int, word: str) -> str:
    """Word a number of things: `1 design`, `2 designs`."""
    return f"{count} {word}{'' if count == 1 else 's'}"


def say(words: str) -> None:
    """Write words to standard error."""
    with suppress(OSError):  # nobody to hear it
        click.echo(words, err=True)


def _finite(data: Any) -> Any:
    if isinstance(data, dict):
        return {key: _finite(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [_finite(value) for value in data]
    return None if isinstance(data, float) and data - data != 0.0 else data
