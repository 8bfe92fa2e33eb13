"""How work ends early: by a signal, which is a request to stop, or by the loss of a worker process."""

import os
import signal
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from types import FrameType

from joblib.externals.loky.process_executor import TerminatedWorkerError

from divideropt.errors import DivideroptError


class InterruptedRunError(DivideroptError):
    """A signal stopped the work; what was computed is on disk."""

    def __init__(self, number: int, folder: Path, again: str) -> None:
        """Word it for a signal, a store, and the command that goes on."""
        self.exit_code = 128 + number
        super().__init__(
            f"stopped by {signal.Signals(number).name}; everything computed is in {folder}. To go on:\n  {again}"
        )


class WorkerLostError(DivideroptError):
    """A worker process died; the exit code is that of a bug, since nothing of the user's made it."""


class Interruption:
    """Hears the signals, and words how the work on a store ended before it was done."""

    def __init__(self, folder: Path, again: str, stop: Path) -> None:
        """Prepare.

        Args:
            folder: The store's.
            again: The command that goes on.
            stop: The file that tells workers to stop.
        """
        self._folder, self._again, self._stop = folder, again, stop
        self._signal: int | None = None

    @property
    def heard(self) -> bool:
        """Whether somebody asked to stop."""
        return self._signal is not None

    def check(self) -> None:
        """End if somebody asked to stop.

        Raises:
            InterruptedRunError: Somebody did.
        """
        if self._signal is not None:
            raise InterruptedRunError(self._signal, self._folder, self._again)

    @contextmanager
    def signals(self) -> Iterator[None]:
        """Turn the first SIGINT or SIGTERM into a request to stop; the second ends everything at once."""

        def hear(number: int, frame: FrameType | None) -> None:
            if self._signal is not None:
                os._exit(128 + number)
            self._signal = number
            with suppress(OSError):  # a disk that refuses will be heard of soon enough
                self._stop.touch()

        old = {number: signal.signal(number, hear) for number in (signal.SIGINT, signal.SIGTERM)}
        try:
            yield
        finally:
            for number, handler in old.items():
                signal.signal(number, handler)

    @contextmanager
    def workers(self) -> Iterator[None]:
        """Word the loss of a worker process.

        Raises:
            InterruptedRunError: A signal reached it before it could ignore it.
            WorkerLostError: It died of something else.
        """
        try:
            yield
        except TerminatedWorkerError as error:
            self.check()
            raise WorkerLostError(
                f"a worker process was killed, perhaps for want of memory. What was logged is intact. To go on:\n"
                f"  {self._again}"
            ) from error
