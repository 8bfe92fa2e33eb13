"""The workers of a Dask cluster as a crew; and a task's own knowledge that it runs on one."""

import os
import secrets
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from importlib.metadata import version
from pathlib import Path
from typing import Any, TypeVar

from divideropt.campaign.crew import Crew, ProcessDiedError
from divideropt.errors import UsageError
from divideropt.store.files import disk_errors

T = TypeVar("T")

CONNECT_SECONDS = 10.0
"""How long the scheduler, its first worker and the probe of the workers are waited for [s]."""

LOOK_SECONDS = 2.0
"""How often a call looks whether the scheduler is still there [s]."""

MOST_CALLS = 256
"""Calls at a time: each has a thread here, which waits."""

_DECISIVE = ("divideropt", "numpy", "scipy", "numba", "pymoo")
"""Packages whose versions decide over the last bits."""


class DaskCrew(Crew):
    """The workers of a cluster, each a process with one thread. A task whose worker dies is begun anew by Dask."""

    here = False

    def __init__(self, scheduler: str, store: Path) -> None:
        """Connect, and look whether the workers are fit.

        Args:
            scheduler: Its address.
            store: The store's folder, which all workers must see.

        Raises:
            UsageError: Dask is not installed, nobody answers, or a worker is unfit; which, and why.
            DiskError: The store's folder cannot be written.
        """
        distributed = _distributed()
        try:
            self._client = distributed.Client(
                scheduler, timeout=CONNECT_SECONDS, set_as_default=False, name="divideropt"
            )
            self._client.wait_for_workers(1, timeout=CONNECT_SECONDS)
        except (OSError, TimeoutError, ValueError) as error:
            raise UsageError(
                f"{scheduler}: no scheduler with a worker answers ({type(error).__name__}: {error}); start both, "
                "see docs/how-to/cluster.md, or mend parallel.scheduler"
            ) from None
        self._killed, self._cancelled = distributed.scheduler.KilledWorker, distributed.CancelledError
        try:
            super().__init__(min(self._fit_workers(scheduler, store.resolve()), MOST_CALLS))
        except BaseException:
            self._client.close()
            raise

    def call(self, function: Callable[..., T], *arguments: object) -> T:
        """Have a function called by a worker; see `Crew.call`."""
        self._check()
        future = self._client.submit(function, *arguments, pure=False)
        try:
            while not _ended(future):
                self._check()
            result: T = future.result()
        except self._killed as error:
            raise ProcessDiedError("Dask gave it up, since worker after worker died of it", final=True) from error
        except self._cancelled as error:
            raise ProcessDiedError("Dask dropped it") from error
        finally:
            future.release()
        return result

    def _check(self) -> None:
        """Wait no longer where nobody answers: what is submitted to a client that has given up never ends."""
        if self._client.status in {"closing", "closed"}:
            raise ProcessDiedError("the scheduler was lost", final=True)

    def close(self) -> None:
        """Leave the cluster; its workers drop what they do for this client."""
        self._client.close()
        super().close()

    def _fit_workers(self, scheduler: str, store: Path) -> int:
        """Count the workers, all of which have one thread, our versions and the store's folder in sight."""
        many = [address for address, threads in self._client.nthreads().items() if threads != 1]
        if many:
            raise UsageError(
                f"{scheduler}: the worker {many[0]} has more than one thread, and simulations in one process would "
                "disturb each other; start workers with --nthreads 1 --nworkers N"
            )
        with _written(store) as (path, word):
            try:
                answers: Mapping[str, Any] = self._client.run(_probe, os.fspath(path))
            except Exception as error:  # whatever Dask makes of a worker that lacks our package
                raise UsageError(
                    f"{scheduler}: a worker cannot run divideropt ({type(error).__name__}: {error}); install the "
                    "same version there"
                ) from error
        ours = _versions()
        for address, (found, versions) in answers.items():
            other = [f"{name} {versions[name]}, here {ours[name]}" for name in ours if versions[name] != ours[name]]
            if other:
                raise UsageError(
                    f"{scheduler}: the worker {address} has {'; '.join(other)}: results would not be the same to the "
                    "bit; install the same versions"
                )
            if found != word:
                raise UsageError(
                    f"{scheduler}: the worker {address} does not see the store {store} (it found {found!r} where we "
                    "wrote a word); name a --store on a filesystem that all workers share, under the same path"
                )
        return len(answers)


def _ended(future: Any) -> bool:
    """Wait a little for a task, and say whether it has come to some end."""
    with suppress(TimeoutError):
        future.result(timeout=LOOK_SECONDS)
    return bool(future.done())


def on_cluster() -> bool:
    """Whether this is a task of a Dask worker."""
    return _task() is not None


def abandoned() -> Callable[[], bool]:
    """Return what says, from any thread, whether this thread's task is a worker's whose client wants it no more."""
    return _task() or (lambda: False)


def _task() -> Callable[[], bool] | None:
    """Return what asks the worker whether the task of this thread is still wanted; None outside of one."""
    if "distributed" not in sys.modules:
        return None
    from distributed import get_worker  # noqa: PLC0415 (an optional extra)

    try:
        worker = get_worker()
        key = worker.get_current_task()
    except (ValueError, AttributeError):
        return None

    def unwanted() -> bool:
        state = worker.state.tasks.get(key)
        return state is None or state.state != "executing"

    return unwanted


def _distributed() -> Any:
    try:
        import distributed  # noqa: PLC0415 (an optional extra)
    except ImportError:
        raise UsageError(
            "parallel.backend: dask needs Dask distributed, which is not installed; pip install 'divideropt[dask]'"
        ) from None
    return distributed


@contextmanager
def _written(store: Path) -> Iterator[tuple[Path, str]]:
    """Have a word on disk that nobody could guess."""
    word = secrets.token_hex(16)
    path = store / f".probe-{word[:8]}"
    with disk_errors(path):
        path.write_text(word, encoding="utf-8")
    try:
        yield path, word
    finally:
        path.unlink(missing_ok=True)


def _probe(path: str) -> tuple[str, dict[str, str]]:
    """Say, on a worker, what is in the file, and which versions are there."""
    try:
        found = Path(path).read_text(encoding="utf-8")
    except OSError as error:
        found = error.strerror or str(error)
    return found, _versions()


def _versions() -> dict[str, str]:
    python = f"{sys.version_info.major}.{sys.version_info.minor}"
    return {"python": python} | {name: version(name) for name in _DECISIVE}
