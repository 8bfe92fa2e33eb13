"""A batch that takes too long when a run is asked to stop: its log is flushed without it."""

import threading
from collections.abc import Callable, Iterator

from divideropt.campaign.execute import Log
from divideropt.errors import DivideroptError
from divideropt.problem import Evaluations

ASK_SECONDS = 0.1
"""How often it is asked whether to stop."""

BATCH_PATIENCE = 2.0
"""How long a batch may take to end by itself once its run is asked to stop [s]."""


class Stopping(threading.Thread):
    """Asks whether a run shall stop, and drops a batch that does not end soon after."""

    def __init__(self, asked: Callable[[], bool], drop: Callable[[], None]) -> None:
        """Prepare.

        Args:
            asked: Whether the run shall stop; a question to the disk.
            drop: Called from this thread if the run has not ended some seconds later.
        """
        super().__init__(daemon=True)
        self._asked, self._drop = asked, drop
        self._told, self._over = threading.Event(), threading.Event()

    @property
    def heard(self) -> bool:
        """Whether the run was asked to stop."""
        return self._told.is_set()

    def run(self) -> None:
        """Ask, wait, drop."""
        while not self._over.wait(ASK_SECONDS):
            if self._asked():
                self._told.set()
                if not self._over.wait(BATCH_PATIENCE):
                    self._drop()
                return

    def __enter__(self) -> "Stopping":
        """Begin to ask."""
        self.start()
        return self

    def __exit__(self, *exc: object) -> None:
        """Ask no more."""
        self._over.set()
        self.join()


class SharedLog:
    """A log that a second thread may flush while the first simulates."""

    def __init__(self, log: Log) -> None:
        """Share a log."""
        self._log, self._lock = log, threading.Lock()
        self._refused: DivideroptError | None = None

    def replay(self) -> Iterator[Evaluations]:
        """Yield the logged batches in order."""
        return self._log.replay()

    def append(self, evaluations: Evaluations) -> None:
        """Log a batch."""
        with self._lock:
            self._check()
            self._log.append(evaluations)

    def flush(self) -> None:
        """Publish what is pending."""
        with self._lock:
            self._check()
            self._log.flush()

    def flush_from_aside(self) -> None:
        """Publish what is pending unless that is being done; the run's own thread hears of a disk that refuses."""
        if self._lock.acquire(blocking=False):
            try:
                self._log.flush()
            except DivideroptError as error:
                self._refused = error
            finally:
                self._lock.release()

    def _check(self) -> None:
        """End the run if its log could not be flushed: what was refused is not tried again."""
        if self._refused is not None:
            raise self._refused
