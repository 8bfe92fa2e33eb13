"""A text file that a user names: read at once and no further than it may be long, as UTF-8."""

import os
import re
import stat
from contextlib import suppress
from difflib import get_close_matches
from itertools import islice
from pathlib import Path

from divideropt.errors import LONGEST_WORDS, FileMistakes, Mistake, UsageError

MOST_COMPARED = 1000
"""With no more files is a name compared that is not there."""

ALIKE = 0.75
"""How much of two names is to be the same for one to be meant by the other; most end in the same five letters."""


def read_text_file(path: Path | str, most: int, what: str) -> str:
    """Read a regular file. A pipe or a device, which may never end, is neither waited for nor read.

    Args:
        path: The file.
        most: The most bytes it may have.
        what: What is read from it, for the message: "campaign".

    Returns:
        Its text, without a byte order mark.

    Raises:
        UsageError: There is no such file, it is no regular one, cannot be read, or is too large.
        FileMistakes: It is not UTF-8.
    """
    content = _bytes(path, most)
    if len(content) > most:
        raise UsageError(
            f"{path}: the file is larger than {most >> 20} MiB, the most a {what} may have; is it the right file?"
        )
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        before = _LINE_END.split(error.object[: error.start])
        message = f"the byte 0x{error.object[error.start]:02x} is not UTF-8; save the file as UTF-8"
        column = len(before[-1].decode()) + 1
        raise FileMistakes(str(path), [Mistake(len(before), column, message)]) from None


_LINE_END = re.compile(rb"\r\n|[\n\r]")


def _bytes(path: Path | str, most: int) -> bytes:
    """Read a file, a longer one to one byte more than `most`."""
    try:
        with open(path, "rb", opener=_open_at_once) as file:
            if not stat.S_ISREG(os.fstat(file.fileno()).st_mode):
                raise UsageError(
                    f"{path}: this is a pipe or a device; save what comes from it as a file, and name that"
                )
            return file.read(most + 1)
    except FileNotFoundError:
        raise UsageError(f"{path}: there is no such file; {_instead_of(Path(path))}") from None
    except IsADirectoryError:
        raise UsageError(f"{path}: {_of_folder(Path(path))}") from None
    except PermissionError:
        raise UsageError(f"{path}: reading it is not permitted; check the file's permissions") from None
    except OSError as error:
        raise UsageError(f"{path}: it cannot be read ({error.strerror}); check the path") from None
    except ValueError:
        raise UsageError(f"{str(path)!r} cannot be the name of a file; check the path") from None


def _of_folder(path: Path) -> str:
    within = path / "campaign.yaml"
    if within.is_file():
        return f"this is a store, the folder of a campaign's results; its campaign is {within}"
    return "this is a folder; name the file in it"


def _instead_of(path: Path) -> str:
    """Say what may have been meant by a file that is not there."""
    with suppress(OSError):
        beside = [other.name for other in islice(path.parent.iterdir(), MOST_COMPARED)]
        meant = get_close_matches(path.name[:LONGEST_WORDS], beside, n=1, cutoff=ALIKE)
        if meant:
            return f"did you mean {path.with_name(meant[0])}?"
    begin = "; `divideropt init` writes a campaign to start from" if path.suffix in (".yaml", ".yml") else ""
    return f"check the name and the folder{begin}"


def _open_at_once(path: str, flags: int) -> int:
    """Open a file without waiting for somebody to write to it, as opening a named pipe would."""
    return os.open(path, flags | getattr(os, "O_NONBLOCK", 0))
