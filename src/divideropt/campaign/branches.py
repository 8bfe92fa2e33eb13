"""Runs that go on as another: where a log and the strategy part, a branch begins with what they have in common.

A branch of `nsga2-1` is a run of the same strategy and seed, `nsga2-1-branch-1`, whose log begins with the batches of
its origin that the strategy still asks for. From there on it is a run like any other. The origin is left as it is,
and no more replayed; a branch may be an origin in turn, of `nsga2-1-branch-2`. That there is a branch, its log says.
"""

from dataclasses import replace
from itertools import islice, pairwise, takewhile

from divideropt.analysis import Summary, summarise
from divideropt.campaign.config import Campaign
from divideropt.campaign.plan import Run, plan_runs
from divideropt.problem import Problem
from divideropt.store import Store, TableSchema


def stored_runs(campaign: Campaign, store: Store) -> tuple[Run, ...]:
    """List the runs of a campaign, each before its branches in a store."""
    return tuple(run for planned in plan_runs(campaign) for run in _line(planned, store))


def active_runs(campaign: Campaign, store: Store) -> tuple[Run, ...]:
    """List the runs of a campaign that can go on: of each that branched, its last branch."""
    return tuple(_line(planned, store)[-1] for planned in plan_runs(campaign))


def summaries(campaign: Campaign, store: Store, problem: Problem, schema: TableSchema) -> dict[str, Summary]:
    """Sum up the log of every run and branch by its name; what a branch begins with is counted in its origin.

    Raises:
        StoreError: A log is damaged.
    """
    found = {}
    for planned in plan_runs(campaign):
        line = _line(planned, store)
        shared = [0, *(_in_common(store, schema, *pair) for pair in pairwise(line))]
        for run, count in zip(line, shared, strict=True):
            found[run.name] = summarise(store.log(run.name, schema).read(), problem, schema, count)
    return found


def branch_off(store: Store, campaign: Campaign, schema: TableSchema, origin: Run, batches: int) -> Run:
    """Begin a branch.

    Args:
        store: Held for writing.
        campaign: As resolved.
        schema: The columns of its tables.
        origin: The run, which is active.
        batches: So many of the first in its log are the branch's, too.

    Returns:
        The branch; with no batch in common its log is not there yet.

    Raises:
        StoreError: The origin's log is damaged.
        DiskError: The disk refused; there is no branch.
    """
    planned = next(run for run in plan_runs(campaign) if origin in _line(run, store))
    branch = _branch(planned, len(_line(planned, store)))
    store.log(branch.name, schema).begin(list(islice(store.log(origin.name, schema).replay(), batches)))
    return branch


def _line(planned: Run, store: Store) -> list[Run]:
    """A run as planned and its branches, each the origin of the next."""
    found = [planned]
    while store.has_log(_branch(planned, len(found)).name):
        found.append(_branch(planned, len(found)))
    return found


def _in_common(store: Store, schema: TableSchema, origin: Run, branch: Run) -> int:
    """Count the evaluations that a branch begins with: of its origin, up to the first batch that differs."""
    batches = zip(*(store.log(run.name, schema).replay() for run in (origin, branch)), strict=False)
    same = takewhile(lambda pair: pair[0].designs.tobytes() == pair[1].designs.tobytes(), batches)
    return sum(len(batch) for batch, _ in same)


def _branch(planned: Run, number: int) -> Run:
    return replace(planned, name=f"{planned.name}-branch-{number}")
