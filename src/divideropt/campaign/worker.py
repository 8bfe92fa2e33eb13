"""What a worker process does: one run, or a share of a batch; and how it ends with its parent."""

import os
import signal
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import cast

from divideropt.campaign.config import Campaign
from divideropt.campaign.execute import Simulate, StoppedError, execute
from divideropt.campaign.load import parse_campaign
from divideropt.campaign.plan import Run, build_problem, reference_of
from divideropt.campaign.progress import Reporter
from divideropt.campaign.reference import reference_problem
from divideropt.errors import DivideroptError
from divideropt.models.base import FloatArray
from divideropt.problem import Evaluations, Problem
from divideropt.store import Store, TableSchema

WATCH_SECONDS = 0.5
"""How often a worker looks whether its parent still lives."""

STOP_FILE = "stop"
"""Stands in the store's status folder while the runs are asked to stop."""


@dataclass(frozen=True)
class Ending:
    """How a run ended.

    Attributes:
        run: Its name.
        stopped: Whether it was asked to stop before its budget was spent.
        error: What went wrong, if a user can mend it.
    """

    run: str
    stopped: bool = False
    error: DivideroptError | None = None


def work_as_process(text: str, store: Store, run: Run) -> Ending:
    """Do one run of a campaign, given as resolved text, in a worker process of its own."""
    leave_signals_to_parent()
    campaign, problem = _prepared(text)
    return work(campaign, problem, store, run, problem.simulate)


def simulate_share(text: str, designs: FloatArray) -> Evaluations:
    """Evaluate a share of a batch in a worker process, for a campaign given as resolved text."""
    leave_signals_to_parent()
    return _prepared(text)[1].simulate(designs)


def simulate_again(text: str, designs: FloatArray) -> Evaluations:
    """Evaluate designs by the model's reference in a worker process, for a campaign given as resolved text."""
    leave_signals_to_parent()
    return _prepared_reference(text).simulate(designs)


def warm_up(problem: Problem) -> None:
    """Evaluate the middle of the box once, so that compiled code is in the cache before workers want it."""
    middle = (problem.space.lower + problem.space.upper) / 2
    problem.simulate(middle[None])


def work(campaign: Campaign, problem: Problem, store: Store, run: Run, simulate: Simulate) -> Ending:
    """Do one run in this process.

    Args:
        campaign: As resolved.
        problem: Made from it.
        store: Its store, which the caller or its parent holds for writing.
        run: Which run.
        simulate: Evaluates designs the log does not know.

    Returns:
        How it ended.
    """
    stop = store.status_folder / STOP_FILE
    reference = reference_of(campaign)
    reporter = Reporter(store.status_folder / f"{run.name}.json", run.name, run.options.budget, problem, reference)
    try:
        with store.writing_run(run.name):
            if stop.exists():
                raise StoppedError
            log = store.log(run.name, TableSchema.of(problem))
            execute(run, problem, log, simulate, reporter, _throttled(stop.exists))
    except StoppedError:
        reporter.write(finished=False)
        return Ending(run.name, stopped=True)
    except DivideroptError as error:
        return Ending(run.name, error=error)
    reporter.write(finished=True)
    return Ending(run.name)


def leave_signals_to_parent() -> None:
    """Let the parent decide on a signal to all, and end with it: loky's workers would outlive it by minutes."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    _watch_parent()


@cache
def _watch_parent() -> None:
    parent = os.getppid()

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(WATCH_SECONDS)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


@cache
def _prepared(text: str) -> tuple[Campaign, Problem]:
    """Read a campaign and make its problem, once a process."""
    campaign = parse_campaign(text)
    return campaign, build_problem(campaign)


@cache
def _prepared_reference(text: str) -> Problem:
    """Make the problem by which the campaign's is verified, which the parent has found to exist."""
    return cast(Problem, reference_problem(_prepared(text)[1]))


def _throttled(question: Callable[[], bool], seconds: float = 0.1) -> Callable[[], bool]:
    """Ask a question of the disk no more often than that."""
    asked, answer = 0.0, False

    def ask() -> bool:
        nonlocal asked, answer
        now = time.monotonic()
        if now - asked >= seconds:
            asked, answer = now, question()
        return answer

    return ask
