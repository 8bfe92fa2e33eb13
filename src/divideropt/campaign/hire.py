"""Who does the work of a campaign: this process alone, worker processes, or a cluster."""

from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

from divideropt.campaign.crew import Crew, LokyCrew
from divideropt.campaign.parallel import ParallelConfig


@contextmanager
def hired(parallel: ParallelConfig, workers: int, store: Path) -> Iterator[Crew | None]:
    """Have the workers a campaign asks for until this is left.

    Args:
        parallel: How the campaign wants its work spread.
        workers: Processes at a time, on this machine.
        store: The store's folder, which all must see.

    Yields:
        Them, or None where this process is alone.

    Raises:
        UsageError: The cluster is not there or unfit.
    """
    if parallel.scheduler is not None:
        from divideropt.campaign.cluster import DaskCrew  # noqa: PLC0415 (an optional extra)

        with closing(DaskCrew(parallel.scheduler, store)) as cluster:
            yield cluster
        return
    if parallel.backend == "sequential" or workers == 1:
        yield None
        return
    with closing(LokyCrew(workers)) as crew:
        yield crew
