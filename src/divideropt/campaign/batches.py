"""Batches of designs simulated after the runs, one after the other, by whoever there is to do it."""

from collections.abc import Iterable, Iterator
from contextlib import closing, nullcontext

from divideropt.campaign.config import Campaign
from divideropt.campaign.crew import Crew
from divideropt.campaign.dump import dump_campaign
from divideropt.campaign.guard import Guard
from divideropt.campaign.interrupt import Interruption
from divideropt.campaign.plan import dividers
from divideropt.campaign.worker import simulate_share
from divideropt.models.base import FloatArray
from divideropt.problem import Evaluations, Problem


class Batches:
    """Simulates batches by the problem of one campaign, until somebody asks to stop."""

    def __init__(self, campaign: Campaign, problem: Problem, interruption: Interruption) -> None:
        """Prepare; nothing is simulated yet.

        Args:
            campaign: As resolved.
            problem: Made from it.
            interruption: Hears the signals.
        """
        self._campaign, self._problem, self._interruption = campaign, problem, interruption
        self._text = dump_campaign(campaign)

    def simulate(self, batches: Iterable[FloatArray], crew: Crew | None) -> Iterator[Evaluations]:
        """Yield what comes out of each batch, in their order.

        A model of somebody's own may die of a design, and is given a process to do so.

        Args:
            batches: Designs, shape (n_i, d) each.
            crew: Who simulates; None for this process alone.

        Raises:
            InterruptedRunError: A worker process was lost when somebody had asked to stop.
            WorkerLostError: Worker processes died again and again.
        """
        asked = self._until_stopped(batches)
        ours = bool(dividers(self._problem.model))
        if crew is not None:
            with self._interruption.workers():
                yield from crew.map(simulate_share, ((self._text, batch, not ours) for batch in asked))
            return
        guard = Guard(self._text, len(self._problem.model.quantities), self._campaign.model.deadline)
        with nullcontext() if ours else closing(guard):
            yield from map(self._problem.simulate if ours else guard.simulate, asked)

    def _until_stopped(self, batches: Iterable[FloatArray]) -> Iterator[FloatArray]:
        for batch in batches:
            if self._interruption.heard:
                return
            yield batch
