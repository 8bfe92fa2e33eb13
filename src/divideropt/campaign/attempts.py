"""Does a campaign's runs, side by side or batch by batch; one that dies or breaks down is begun anew from its log."""

from collections.abc import Callable, Sequence
from typing import TextIO

import numpy as np

from divideropt.campaign.config import Campaign
from divideropt.campaign.crew import Crew, ProcessDiedError
from divideropt.campaign.execute import Simulate
from divideropt.campaign.interrupt import Interruption
from divideropt.campaign.mishaps import RESTARTS, Mishaps
from divideropt.campaign.plan import Run, dividers
from divideropt.campaign.progress import Display
from divideropt.campaign.worker import STOP_FILE, Ending, simulate_share, work, work_as_process
from divideropt.models.base import FloatArray
from divideropt.problem import Evaluations, Problem
from divideropt.store import Store
from divideropt.store.files import disk_errors


class Attempts:
    """Attempts at the runs of one campaign, in one store that is held."""

    def __init__(
        self, campaign: Campaign, text: str, store: Store, interruption: Interruption, words: TextIO
    ) -> None:
        """Prepare.

        Args:
            campaign: As resolved.
            text: The same as YAML, for other processes.
            store: The campaign's.
            interruption: Hears the signals.
            words: Where progress is shown.
        """
        self._campaign, self._text = campaign, text
        self._store, self._interruption, self._words = store, interruption, words

    def endings(self, runs: Sequence[Run], problem: Problem, crew: Crew | None) -> list[Ending]:
        """Do runs to their ends, or as far as they get.

        Args:
            runs: Which.
            problem: What they simulate.
            crew: Who does it; None where this process is alone.

        Returns:
            How each ended.

        Raises:
            DiskError: The disk refused.
            InterruptedRunError: A signal came before they began.
        """
        folder = self._store.status_folder
        with disk_errors(folder):
            folder.mkdir(parents=True, exist_ok=True)
            for old in (folder / STOP_FILE, *folder.glob("*.json")):
                old.unlink(missing_ok=True)
            for run in runs:  # where this process is alone, an earlier one may have died of the run
                Mishaps(folder, run.name).forget(deaths=crew is not None)
        self._interruption.check()
        with Display(folder, {run.name: run.budget for run in runs}, self._words) as display:
            if crew is None:
                return [self._persist(lambda run: self._work_here(run, problem), run, display) for run in runs]
            if len(runs) < crew.size:
                return self._share_batches(runs, problem, crew, display)
            return self._one_process_a_run(runs, crew, display)

    def _one_process_a_run(self, runs: Sequence[Run], crew: Crew, display: Display) -> list[Ending]:
        """Do the runs side by side, the longest first, so that no process is left alone with it in the end."""

        def attempt(run: Run) -> Ending:
            return crew.call(work_as_process, self._text, self._store.absolute(), run)

        longest = sorted(runs, key=lambda run: run.budget, reverse=True)
        waiting = [crew.submit(self._persist, attempt, run, display) for run in longest]
        return [ending.result() for ending in waiting]

    def _share_batches(self, runs: Sequence[Run], problem: Problem, crew: Crew, display: Display) -> list[Ending]:
        """Do the runs one after the other, each batch shared by threads, or by processes if threads gain nothing."""
        threaded = problem.on_threads(crew.size) if crew.here else None
        quick = bool(dividers(problem.model))

        def simulate(designs: FloatArray) -> Evaluations:
            if quick and len(designs) < crew.size:
                return problem.simulate(designs)
            shares = np.array_split(designs, min(len(designs), crew.size))
            waiting = [crew.submit(self._simulate_share, crew, share) for share in shares]
            return Evaluations.together([part.result() for part in waiting])

        def attempt(run: Run) -> Ending:
            return self._work_here(run, problem, simulate if threaded is None else threaded.simulate)

        return [self._persist(attempt, run, display) for run in runs]

    def _simulate_share(self, crew: Crew, share: FloatArray) -> Evaluations:
        """Have a share evaluated; where its process died, by one that expects that."""
        try:
            return crew.call(simulate_share, self._text, share)
        except ProcessDiedError:
            return crew.insist(simulate_share, self._text, share, True)

    def _persist(self, attempt: Callable[[Run], Ending], run: Run, display: Display) -> Ending:
        """Attempt a run; begin it anew from its log where its process dies or breaks down, three times."""
        reason = ""
        for number in range(RESTARTS + 1):
            if number > 0:
                display.say(f"{run.name}: {reason}; begun anew from its log, {number} of {RESTARTS}")
            try:
                return attempt(run)
            except ProcessDiedError as died:
                reason = str(died)
                if died.final:
                    break
            except Exception as error:  # a bug of ours, of a library or of a model, in this run alone
                reason = f"it broke down ({type(error).__name__}: {error})"
            if self._interruption.heard:
                return Ending(run.name, stopped=True)
        else:
            reason = f"{reason}, {RESTARTS + 1} times"
        Mishaps(self._store.status_folder, run.name).give_up(reason)
        display.say(f"{run.name}: given up: {reason}")
        return Ending(run.name, failure=reason)

    def _work_here(self, run: Run, problem: Problem, simulate: Simulate | None = None) -> Ending:
        return work(self._campaign, problem, self._store, run, simulate)
