"""How work ends early: by a signal, which is a request to stop, or by the loss of worker processes."""

import os
import signal
import socket
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from divideropt.campaign.crew import ProcessDiedError
from divideropt.errors import DivideroptError

LEAVE_SECONDS = 3.5
"""How long after the first signal the command ends, whatever is still at work [s]. What workers have computed is on
disk by then; see `divideropt.campaign.dropping`."""

_SIGNALS = (signal.SIGINT, signal.SIGTERM)


class InterruptedRunError(DivideroptError):
    """A signal stopped the work; what was computed is on disk."""

    def __init__(self, number: int, folder: Path, again: str) -> None:
        """Word it for a signal, a store, and the command that goes on."""
        self.exit_code = 128 + number
        super().__init__(
            f"stopped by {signal.Signals(number).name}; everything computed is in {folder}. To go on:\n  {again}"
        )


class WorkerLostError(DivideroptError):
    """Worker processes died again and again; the exit code is that of a bug, since nothing of the user's made it."""


class Interruption:
    """Hears the signals, and words how the work on a store ended before it was done."""

    def __init__(self, folder: Path, again: str, stop: Path) -> None:
        """Prepare.

        Args:
            folder: The store's.
            again: The command that goes on.
            stop: The file that tells workers to stop.
        """
        self.again = again
        self._folder, self._stop = folder, stop
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
            raise InterruptedRunError(self._signal, self._folder, self.again)

    @contextmanager
    def signals(self) -> Iterator[None]:
        """Turn the first SIGINT or SIGTERM into a request to stop; the second ends everything at once.

        They are heard by a thread, through a pipe: the main thread may be in compiled code for long.
        """
        ours, theirs = socket.socketpair()
        theirs.setblocking(False)
        listener = threading.Thread(target=self._listen, args=(ours,), daemon=True)
        listener.start()
        old = {number: signal.signal(number, self._hear) for number in _SIGNALS}
        old_pipe = signal.set_wakeup_fd(theirs.fileno(), warn_on_full_buffer=False)
        try:
            yield
        finally:
            signal.set_wakeup_fd(old_pipe)
            for number, handler in old.items():
                signal.signal(number, handler)
            theirs.close()
            listener.join()
            ours.close()

    def _listen(self, link: socket.socket) -> None:
        """Hear the first signal and the second; an empty answer says that the work is over."""
        while received := link.recv(1):
            if received[0] in _SIGNALS:
                break
        else:
            return
        self._hear(received[0])
        link.settimeout(LEAVE_SECONDS)
        try:
            received = link.recv(1)
        except TimeoutError:
            self._leave()
        if received:
            os._exit(128 + received[0])

    def _hear(self, number: int, frame: object = None) -> None:
        """Take a signal for a request to stop, in the main thread if that is free, else in the listener's."""
        if self._signal is None:
            self._signal = number
            with suppress(OSError):  # a disk that refuses will be heard of soon enough
                self._stop.touch()

    def _leave(self) -> None:
        """End the command while its main thread is still at work, as if it had ended by itself."""
        with suppress(OSError, InterruptedRunError):
            if sys.stderr.isatty():
                sys.stderr.write("\x1b[?25h")  # the cursor, which the display hides
            try:
                self.check()
            except InterruptedRunError as error:
                sys.stderr.write(f"divideropt: {error}\n")
                sys.stderr.flush()
        os._exit(128 + (self._signal or 0))

    @contextmanager
    def workers(self) -> Iterator[None]:
        """Word the loss of worker processes.

        Raises:
            InterruptedRunError: Somebody asked to stop.
            WorkerLostError: They died of something else, again and again.
        """
        try:
            yield
        except ProcessDiedError as error:
            self.check()
            raise WorkerLostError(
                f"a worker process was killed, again and again ({error}), perhaps for want of memory. What was "
                f"logged is intact. To go on:\n  {self.again}"
            ) from error
