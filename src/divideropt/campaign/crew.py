"""Worker processes, each of which may die without harm to the others: loky's, or a Dask cluster's."""

import os
import re
import signal
import threading
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from itertools import islice
from pathlib import Path
from typing import Any, TypeVar

from joblib.externals.loky import ProcessPoolExecutor, process_executor
from joblib.externals.loky.backend import resource_tracker
from joblib.externals.loky.process_executor import BrokenProcessPool

from divideropt.campaign.mishaps import RESTARTS
from divideropt.campaign.parentage import end_with_parent

T = TypeVar("T")

_ONE_THREAD = dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS", "VECLIB_MAXIMUM_THREADS"), "1"
)
"""Processes share the cores, so each computes on one."""


class ProcessDiedError(Exception):
    """A worker process died of what it was to do; how.

    Attributes:
        final: Whether others died of it before, and it is not worth a further attempt.
    """

    def __init__(self, how: str, *, final: bool = False) -> None:
        """Say how."""
        super().__init__(how)
        self.final = final


class Crew(ABC):
    """Threads of this process, each of which has calls done by a worker process.

    Attributes:
        size: How many.
        here: Whether the processes are on this machine.
    """

    here = True

    def __init__(self, size: int) -> None:
        """Begin with so many threads; signals go past them and the processes they start, to the main thread."""
        self.size = size
        self._threads = ThreadPoolExecutor(size, "crew", initializer=_leave_signals_to_main_thread)

    @abstractmethod
    def call(self, function: Callable[..., T], *arguments: object) -> T:
        """Have a function called in a worker process; to be called in a thread of the crew.

        Raises:
            ProcessDiedError: The process died of it, and of nothing else.
        """

    def submit(self, task: Callable[..., T], *arguments: object) -> Future[T]:
        """Do a task in a thread of the crew."""
        return self._threads.submit(task, *arguments)

    def insist(self, function: Callable[..., T], *arguments: object) -> T:
        """Call again where the process died, three times; otherwise as `call`."""
        for _ in range(RESTARTS):
            try:
                return self.call(function, *arguments)
            except ProcessDiedError as died:
                if died.final:
                    raise
        return self.call(function, *arguments)

    def map(self, function: Callable[..., T], tasks: Iterable[tuple[Any, ...]]) -> Iterator[T]:
        """Yield what a function makes of each tuple of arguments, in their order, a few ahead of what is taken."""
        waiting = iter(tasks)
        ahead = [self.submit(self.insist, function, *task) for task in islice(waiting, 2 * self.size)]
        while ahead:
            yield ahead.pop(0).result()
            ahead += [self.submit(self.insist, function, *task) for task in islice(waiting, 1)]

    def close(self) -> None:
        """Let threads and processes go."""
        self._threads.shutdown(wait=True, cancel_futures=True)


class LokyCrew(Crew):
    """Processes of this machine. Each is an executor of its own, since loky fails all calls of one where one dies."""

    def __init__(self, size: int) -> None:
        """Begin; a process is started when its thread first needs it."""
        super().__init__(size)
        _start_tracker()
        self._mine, self._starting = threading.local(), threading.Lock()
        self._executors: list[ProcessPoolExecutor] = []

    def call(self, function: Callable[..., T], *arguments: object) -> T:
        """Have a function called in this thread's process; see `Crew.call`."""
        executor = getattr(self._mine, "executor", None)
        if executor is None:
            executor = self._mine.executor = self._started()
        try:
            result: T = executor.submit(function, *arguments).result()
        except BrokenProcessPool as error:
            self._mine.executor = None
            raise ProcessDiedError(_how(str(error))) from error
        return result

    def _started(self) -> ProcessPoolExecutor:
        """Start a process, and take the names from the semaphores it shares with this one, once it has them.

        A tracker of loky's unlinks them when this process has ended, unless that is killed with its whole group.
        """
        with self._starting:
            before = set(_semaphores())
            executor = ProcessPoolExecutor(1, env=_ONE_THREAD, initializer=_stay, initargs=(os.getpid(),))
            self._executors.append(executor)
            ready = executor.submit(os.getpid)
            named = set(_semaphores()) - before
        with suppress(BrokenProcessPool):  # which is heard of when the process is asked for more
            ready.result()
        for path in named:
            path.unlink(missing_ok=True)
        return executor

    def close(self) -> None:
        """End threads and processes."""
        for executor in self._executors:
            executor.shutdown(wait=True, kill_workers=True)
        super().close()


def _leave_signals_to_main_thread() -> None:
    signal.pthread_sigmask(signal.SIG_BLOCK, (signal.SIGINT, signal.SIGTERM))


def _stay(parent: int) -> None:
    """End with the parent, also one that has died while this worker was being started; else stay.

    loky would replace a worker that has grown by 300 MB, which imports and compiled code may make; its successor
    would look for semaphores that have no names any more.
    """
    end_with_parent(parent)
    process_executor._USE_PSUTIL = False


def _start_tracker() -> None:
    """Start loky's tracker of semaphores, and tell it not to complain when those are gone."""
    before = os.environ.get("PYTHONWARNINGS")
    os.environ["PYTHONWARNINGS"] = "ignore"
    try:
        resource_tracker.ensure_running()
    finally:
        if before is None:
            del os.environ["PYTHONWARNINGS"]
        else:
            os.environ["PYTHONWARNINGS"] = before


def _semaphores() -> Iterator[Path]:
    """The named semaphores loky has made in this process, where they are files (Linux)."""
    return Path("/dev/shm").glob(f"sem.loky-{os.getpid()}-*")


def _how(words: str) -> str:
    """Find in loky's words how the process ended."""
    found = re.search(r"\{([A-Z]+)\((-?\d+)\)", words)
    if found is None:
        return "its process died"
    if found[1] == "EXIT":
        return f"its process left with exit code {found[2]}"
    return f"its process was killed by signal {found[2].lstrip('-')}, {found[1]}"
