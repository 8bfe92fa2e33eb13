"""What befell a run's processes, in small files beside its standing: how often one died, why the run was given up."""

from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

RESTARTS = 3
"""So often a run is begun anew from its log before it is given up: what dies a fourth time dies a fifth."""

_BEGUN, _FAILED, _TRACE = ".begun", ".failed", ".trace"


@dataclass(frozen=True)
class Mishaps:
    """The mishaps of one run since its command began. A disk that refuses these files does not matter here.

    Attributes:
        folder: The store's status folder.
        run: The run's name.
    """

    folder: Path
    run: str

    @property
    def deaths(self) -> int:
        """How many processes began the run and neither ended nor gave up the run."""
        try:
            return self._path(_BEGUN).stat().st_size
        except OSError:
            return 0

    @property
    def failure(self) -> str | None:
        """Why the run was given up, None if it was not."""
        try:
            return self._path(_FAILED).read_text(encoding="utf-8") or None
        except (OSError, UnicodeDecodeError):
            return None

    def begin(self) -> None:
        """Say that a process begins the run; it counts as dead until `survive` is called."""
        with suppress(OSError), self._path(_BEGUN).open("ab") as file:
            file.write(b".")

    def survive(self) -> None:
        """Say that the process that began the run last has not died of it."""
        with suppress(OSError), self._path(_BEGUN).open("ab") as file:
            file.truncate(max(0, self.deaths - 1))

    def give_up(self, reason: str) -> None:
        """Mark the run as failed."""
        with suppress(OSError):
            self._path(_FAILED).write_text(reason, encoding="utf-8")

    def trace(self, text: str) -> Path:
        """Keep a traceback, and say where."""
        path = self._path(_TRACE)
        with suppress(OSError):
            path.write_text(text, encoding="utf-8")
        return path

    def forget(self, *, deaths: bool) -> None:
        """Forget what an earlier command met with; `deaths` only if asked to."""
        for suffix in (_FAILED, _TRACE, *([_BEGUN] if deaths else [])):
            self._path(suffix).unlink(missing_ok=True)

    def _path(self, suffix: str) -> Path:
        return self.folder / f"{self.run}{suffix}"
