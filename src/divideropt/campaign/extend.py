"""May a store go on with this campaign? Only budgets, seeds and strategies may be added to.

A `termination` may change too, as long as no logged run would have ended by it before the last of its evaluations:
loosened or deleted, the runs go on; tightened, those that have gone further are in the way.

What touches no evaluation, `verification`, `optimality`, `nominal` and `parallel`, may be changed at will; and
`model.deadline`, which counts for designs that are not yet logged.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from divideropt.campaign.branches import active_runs
from divideropt.campaign.config import Campaign
from divideropt.campaign.dump import dump_campaign
from divideropt.campaign.ending import Ended, Watch
from divideropt.campaign.plan import reference_of
from divideropt.campaign.reader import read_text
from divideropt.errors import StoreError
from divideropt.problem import Problem
from divideropt.store import Store, TableSchema

BUDGETS = ("generations", "evaluations", "trajectories", "samples")
"""Options that may grow."""

PROBLEM = ("model", "variables", "objectives", "constraints", "reference_point", "uncertainty")
"""Sections that say what is optimised, and how well a front is."""

_SIDES = ("the store", "the campaign")


def check_extends(stored: Campaign, asked: Campaign, where: object) -> None:
    """Check that a store's campaign and the one asked for are the same, or the latter asks for more.

    Args:
        stored: What the store was made with.
        asked: What is to be run.
        where: The store, for the message.

    Raises:
        StoreError: They differ; the message lists each differing key.
    """
    differences = list(_differences(stored, asked))
    if differences:
        raise StoreError(
            f"{where}: this store belongs to another campaign:\n  "
            + "\n  ".join(differences)
            + "\nOnly generations, evaluations, trajectories, samples, seeds and strategies may be added, and a "
            "termination changed; name another folder (--store), or start anew (--fresh, which moves the old store "
            "aside)."
        )


def check_endings(asked: Campaign, problem: Problem, store: Store) -> None:
    """Check that no run of a store has gone on after the end that its termination now gives it.

    Raises:
        StoreError: One has; or its log is damaged.
    """
    schema, reference = TableSchema.of(problem), reference_of(asked)
    for run in active_runs(asked, store):
        if run.termination is None:
            continue
        watch = Watch(run, problem, reference)
        ended: Ended | None = None
        for batch in store.log(run.name, schema).replay():
            if ended is not None:
                raise StoreError(
                    f"{store.folder}: run {run.name} has gone on after {ended.evaluations} evaluations, where it "
                    f"would have ended by the termination asked for now ({ended.text}); loosen or delete "
                    f"strategies.{run.strategy}.termination, name another folder (--store), or start anew (--fresh)"
                )
            ended = watch.hear(problem.tell(batch))


def differences(
    first: Campaign, second: Campaign, sections: Sequence[str] = PROBLEM, sides: tuple[str, str] = _SIDES
) -> Iterator[str]:
    """Say in which keys two campaigns differ, a sentence each.

    Args:
        first: A campaign.
        second: Another.
        sections: Where to look.
        sides: What the sentences call them.
    """
    before, after = _as_written(first), _as_written(second)
    for section in sections:
        yield from _compare(section, before.get(section), after.get(section), sides)
    for section in ("variables", "objectives", "constraints"):
        old, new = list(before[section]), list(after[section])
        if old != new and sorted(old) == sorted(new):
            yield f"{section}: in the order {', '.join(old)} in {sides[0]}, {', '.join(new)} in {sides[1]}"


def _differences(stored: Campaign, asked: Campaign) -> Iterator[str]:
    yield from differences(stored, asked, ("name", *PROBLEM))
    before, after = _as_written(stored), _as_written(asked)
    for name, plan in before["strategies"].items():
        if name in after["strategies"]:
            yield from _compare_plans(f"strategies.{name}", plan, after["strategies"][name])
        else:
            yield f"strategies.{name}: in the store, not in the campaign"


def _as_written(campaign: Campaign) -> Any:
    """Return a campaign as resolved, as plain data with units: what a user can compare."""
    data: Any = read_text(dump_campaign(campaign), "campaign").data
    data["model"].pop("deadline", None)
    return data


def _compare(path: str, before: Any, after: Any, sides: tuple[str, str] = _SIDES) -> Iterator[str]:
    if isinstance(before, Mapping) and isinstance(after, Mapping):
        for key in dict.fromkeys([*before, *after]):
            yield from _compare(f"{path}.{key}", before.get(key), after.get(key), sides)
    elif before != after:
        yield f"{path}: {before} in {sides[0]}, {after} in {sides[1]}"


def _compare_plans(path: str, before: Mapping[str, Any], after: Mapping[str, Any]) -> Iterator[str]:
    for option in dict.fromkeys([*before, *after]):
        old, new = before.get(option), after.get(option)
        if option == "seeds":
            missing = [seed for seed in before["seeds"] if seed not in after["seeds"]]
            if missing:
                yield f"{path}.seeds: {missing} in the store, not in the campaign"
        elif option == "termination":
            continue  # the logs judge it, see `check_endings`
        elif option not in BUDGETS:
            yield from _compare(f"{path}.{option}", old, new)
        elif before[option] > after[option]:
            yield f"{path}.{option}: {old} in the store, {new} in the campaign; a budget can only grow"
