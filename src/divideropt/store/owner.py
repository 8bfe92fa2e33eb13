"""Who may write to a store: a token in it, which a writer that was taken for dead finds replaced."""

import json
import os
import secrets
import socket
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path

from divideropt.errors import DiskError, StoreInUseError
from divideropt.store.files import publish


@dataclass(frozen=True)
class Owner:
    """A process that holds a store for writing, and those that work for it.

    Attributes:
        host: Its machine.
        process: Its number there.
        token: Something random: another process of that number is another owner.
    """

    host: str
    process: int
    token: str

    @classmethod
    def here(cls) -> "Owner":
        """This process, as an owner that there was not before."""
        return cls(socket.gethostname(), os.getpid(), secrets.token_hex(8))

    def claim(self, path: Path) -> None:
        """Write the owner down; whoever was there may not publish any more.

        Raises:
            DiskError: The disk refused.
        """
        publish(path, lambda p: p.write_text(json.dumps(asdict(self)), encoding="utf-8"))

    def check(self, path: Path) -> None:
        """Make sure that the store still is this owner's.

        Raises:
            StoreInUseError: It is another's, or nobody's: the owner has ended.
            DiskError: The store's folder is gone.
        """
        found = _read(path)
        if found == self:
            return
        if not path.parent.is_dir():
            raise DiskError(
                f"{path.parent}: the folder is gone. What was logged in it went with it: put it back, then run the "
                "same command again."
            )
        now = "nobody" if found is None else found
        raise StoreInUseError(
            f"{path.parent}: held by {now} now, not by {self}, for whom this process works; nothing more is written"
        )

    def release(self, path: Path) -> None:
        """Give the store up: those who still work for this owner may not publish any more."""
        if _read(path) == self:
            with suppress(OSError):  # then it stays until the next owner
                path.unlink()

    def __str__(self) -> str:
        """Word it for a message."""
        return f"process {self.process} on {self.host}"


def holder(path: Path) -> str:
    """Word who holds a store."""
    found = _read(path)
    return "a process that has not said which" if found is None else str(found)


def _read(path: Path) -> Owner | None:
    """Read who is written down; None where nobody is, or nothing that can be read."""
    try:
        return Owner(**json.loads(path.read_text(encoding="utf-8")))
    except (OSError, ValueError, TypeError):
        return None
