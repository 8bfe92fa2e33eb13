"""What a worker process does: one run, or a share of a batch."""

import signal
import threading
import traceback
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from functools import cache
from typing import cast

from divideropt.campaign.cluster import abandoned, on_cluster
from divideropt.campaign.config import Campaign
from divideropt.campaign.dropping import SharedLog, Stopping
from divideropt.campaign.dump import dump_campaign
from divideropt.campaign.ending import keep_ending
from divideropt.campaign.execute import Simulate, StoppedError, execute
from divideropt.campaign.guard import Guard
from divideropt.campaign.load import parse_campaign
from divideropt.campaign.mishaps import Mishaps
from divideropt.campaign.parentage import end_with_parent
from divideropt.campaign.plan import Run, build_problem, dividers, reference_of
from divideropt.campaign.reference import reference_problem
from divideropt.campaign.standing import Reporter
from divideropt.errors import DivideroptError
from divideropt.models.base import FloatArray
from divideropt.problem import Evaluations, Problem
from divideropt.store import Store, TableSchema

STOP_FILE = "stop"
"""Stands in the store's status folder while the runs are asked to stop."""


@dataclass(frozen=True)
class Ending:
    """How a run ended.

    Attributes:
        run: Its name.
        stopped: Whether it was asked to stop before its end.
        error: What went wrong, if a user can mend it.
        failure: Why it was given up, if its process died or broke down again and again.
    """

    run: str
    stopped: bool = False
    error: DivideroptError | None = None
    failure: str | None = None


def work_as_process(text: str, store: Store, run: Run) -> Ending:
    """Do one run of a campaign, given as resolved text, in a worker process of its own."""
    leave_signals_to_parent()
    campaign, problem = _prepared(text)
    return work(campaign, problem, store, run)


def simulate_share(text: str, designs: FloatArray, suspicious: bool = False) -> Evaluations:
    """Evaluate a share of a batch in a worker process, for a campaign given as resolved text.

    Args:
        text: The campaign.
        designs: The share, shape (n, d).
        suspicious: Whether a process died of this share before.
    """
    leave_signals_to_parent()
    campaign, problem = _prepared(text)
    guarded = suspicious or campaign.model.deadline is not None or _endangers_cluster(problem)
    guard = _share_guard(text) if guarded else None
    return problem.simulate(designs) if guard is None else guard.simulate(designs)


def simulate_again(text: str, designs: FloatArray) -> Evaluations:
    """Evaluate designs by the model's reference in a worker process, for a campaign given as resolved text."""
    leave_signals_to_parent()
    return _prepared_reference(text).simulate(designs)


def warm_up(problem: Problem) -> None:
    """Evaluate the middle of the box once, so that compiled code is in the cache before workers want it.

    A model of somebody's own has nothing of ours to compile, and may die of that design.
    """
    if not dividers(problem.model):
        return
    middle = (problem.space.lower + problem.space.upper) / 2
    problem.simulate(middle[None])


def work(campaign: Campaign, problem: Problem, store: Store, run: Run, simulate: Simulate | None = None) -> Ending:
    """Do one run in this process.

    Args:
        campaign: As resolved.
        problem: Made from it.
        store: Its store, which the caller or its parent holds for writing.
        run: Which run.
        simulate: Evaluates designs the log does not know, elsewhere; the problem does it where None is given, in a
            child process where it may die or take too long.

    Returns:
        How it ended.
    """
    stop = store.status_folder / STOP_FILE
    reference = reference_of(campaign)
    reporter = Reporter(store.status_folder / f"{run.name}.json", run.name, run.budget, problem, reference)
    mishaps, gone = Mishaps(store.status_folder, run.name), abandoned()
    try:
        with store.writing_run(run.name), _surviving(mishaps) as died:
            if stop.exists():
                raise StoppedError
            log = SharedLog(store.log(run.name, TableSchema.of(problem)))
            with _guarding(campaign, problem, died) if simulate is None else nullcontext() as guard:

                def drop() -> None:
                    log.flush_from_aside()
                    if guard is not None:
                        guard.stop()

                with Stopping(lambda: stop.exists() or gone(), drop) as stopping:
                    here = problem.simulate if guard is None else guard.simulate
                    simulating = simulate or here
                    ended = execute(run, problem, log, simulating, reporter, lambda: stopping.heard, reference)
            keep_ending(store, run, ended)
    except StoppedError:
        reporter.write()
        return Ending(run.name, stopped=True)
    except DivideroptError as error:
        return Ending(run.name, error=error)
    reporter.write(ended.text)
    return Ending(run.name)


@contextmanager
def _surviving(mishaps: Mishaps) -> Iterator[bool]:
    """Count this process as one the run died of, until this is left; yield whether one did before."""
    died = mishaps.deaths > 0
    mishaps.begin()
    try:
        yield died
    except Exception as error:
        if not isinstance(error, DivideroptError | StoppedError):
            mishaps.trace(traceback.format_exc())
        raise
    finally:
        mishaps.survive()


@contextmanager
def _guarding(campaign: Campaign, problem: Problem, suspicious: bool) -> Iterator[Guard | None]:
    """Give a child process to simulate in where a design has a deadline or the last process died; else None.

    A model of somebody's own has one on a cluster, too, whose worker would take other tasks with it.
    """
    deadline = campaign.model.deadline
    if deadline is None and not suspicious and not _endangers_cluster(problem):
        yield None
        return
    guard = Guard(dump_campaign(campaign), len(problem.model.quantities), deadline, suspicious=suspicious)
    try:
        yield guard
    finally:
        guard.close()


def leave_signals_to_parent() -> None:
    """Let the parent decide on a signal to all, and end with it: loky's workers would outlive it by minutes."""
    if threading.current_thread() is not threading.main_thread():
        return  # an engine that is not ours keeps its own workers
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    end_with_parent()


@cache
def _prepared(text: str) -> tuple[Campaign, Problem]:
    """Read a campaign and make its problem, once a process."""
    campaign = parse_campaign(text)
    return campaign, build_problem(campaign)


@cache
def _prepared_reference(text: str) -> Problem:
    """Make the problem by which the campaign's is verified, which the parent has found to exist."""
    return cast(Problem, reference_problem(_prepared(text)[1]))


def _endangers_cluster(problem: Problem) -> bool:
    return on_cluster() and not dividers(problem.model)


@cache
def _share_guard(text: str) -> Guard:
    """Make the guard of this process's shares; it ends with the process."""
    campaign, problem = _prepared(text)
    return Guard(text, len(problem.model.quantities), campaign.model.deadline)
