"""Strategies of one store or of several against each other: the work of `divideropt compare`."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path

import numpy as np

from divideropt.analysis import (
    Choice,
    Comparison,
    Contender,
    Summary,
    choose,
    compare,
    hypervolume,
    median_surface,
    nondominated,
    region,
    summarise,
    worst_surface,
)
from divideropt.analysis.attainment import DIMENSIONS
from divideropt.analysis.ranking import SIGNIFICANCE, least_p
from divideropt.campaign.branches import active_runs
from divideropt.campaign.config import Campaign
from divideropt.campaign.extend import differences
from divideropt.campaign.load import stored_campaign
from divideropt.campaign.plan import build_problem, reference_of
from divideropt.errors import NoFeasibleDesignError, UsageError
from divideropt.models.base import FloatArray
from divideropt.problem import Problem
from divideropt.store import Store, TableSchema


@dataclass(frozen=True)
class Group:
    """What is compared: a strategy of a store, over its seeds.

    Attributes:
        store: The store's folder, as given.
        strategy: The strategy.
        surfaces: Hypervolumes of what half of the runs reach and of what all do; None where they have none: no
            reference point, one run, or neither two nor three objectives.
    """

    store: Path
    strategy: str
    surfaces: tuple[float, float] | None


@dataclass(frozen=True)
class Point:
    """A design of the best known front: its store, its name, its variables and objectives in the platform's units."""

    store: Path
    design_id: str
    variables: tuple[float, ...]
    objectives: tuple[float, ...]


@dataclass(frozen=True)
class Compared:
    """What came out.

    Attributes:
        problem: What all stores optimise.
        groups: What is compared, by the name it has in `comparison`.
        comparison: The indicators and the tests.
        designs: How many designs the best known front has, that of everything in the stores.
        front: Those within the reference point, as far as there is one.
        choice: Which of its designs are worth a look.
        words: What is to be said beside it, a sentence each.
    """

    problem: Problem
    groups: Mapping[str, Group]
    comparison: Comparison
    designs: int
    front: tuple[Point, ...]
    choice: Choice
    words: tuple[str, ...]


def compare_stores(folders: Sequence[Path], evaluations: int | None = None) -> Compared:
    """Compare the strategies in stores of one problem.

    Args:
        folders: The stores.
        evaluations: How many of each run count; the smallest number common to all where not given.

    Returns:
        The comparison.

    Raises:
        UsageError: There is no store, one is named twice, their problems differ, or no run has got so far.
        StoreError: A store is damaged.
        NoFeasibleDesignError: No design is feasible.
    """
    campaigns = _campaigns(folders)
    problem, reference = build_problem(campaigns[0]), reference_of(campaigns[0])
    schema = TableSchema.of(problem)
    logs: dict[tuple[Path, str, str], Summary] = {}
    for folder, campaign in zip(folders, campaigns, strict=True):
        for run in active_runs(campaign, Store(folder)):
            log = Store(folder).log(run.name, schema).read()
            logs[folder, run.strategy, run.name] = summarise(log, problem, schema)
    several = len(folders) > 1
    contenders = [
        Contender(_label(folder, strategy, several), run, log.told) for (folder, strategy, run), log in logs.items()
    ]
    _check_evaluations(contenders, evaluations)
    comparison = compare(contenders, problem.objectives, reference, evaluations)
    if comparison is None:
        raise NoFeasibleDesignError("no design is feasible in any of these stores, so there is nothing to compare")
    labels = {_label(folder, strategy, several): (folder, strategy) for folder, strategy, _ in logs}
    groups = {
        name: Group(*labels[name], _surfaces([c for c in contenders if c.group == name], comparison, reference))
        for name in comparison.groups
    }
    front = _front(logs, problem, schema)
    values = np.array([point.objectives for point in front])
    kept = region(values, reference)
    choice = choose(values[kept], problem.objectives)
    within = tuple(point for point, keep in zip(front, kept, strict=True) if keep)
    words = tuple(_words(comparison, contenders, evaluations))
    return Compared(problem, groups, comparison, len(front), within, choice, words)


def _campaigns(folders: Sequence[Path]) -> list[Campaign]:
    """Read the campaigns of stores, and make sure that they are of one problem."""
    places = [folder.resolve() for folder in folders]
    twice = next((f for f, place in zip(folders, places, strict=True) if places.count(place) > 1), None)
    if twice is not None:
        raise UsageError(f"{twice}: named twice; a store compared with itself says nothing, so name each once")
    campaigns = [stored_campaign(Store(folder)) for folder in folders]
    for folder, campaign in zip(folders[1:], campaigns[1:], strict=True):
        found = list(differences(campaigns[0], campaign, sides=(str(folders[0]), str(folder))))
        if found:
            raise UsageError(
                f"{folder}: not the problem of {folders[0]}, and fronts of different problems cannot be compared:\n  "
                + "\n  ".join(found)
                + "\nName stores that differ in their strategies only."
            )
    return campaigns


def _label(folder: Path, strategy: str, several: bool) -> str:
    return f"{strategy} in {folder}" if several else strategy


def _check_evaluations(contenders: Sequence[Contender], asked: int | None) -> None:
    most = max(c.evaluations for c in contenders)
    if most == 0:
        raise UsageError("nothing has been simulated in any of these stores yet; run their campaigns first")
    if asked is not None and asked > most:
        raise UsageError(f"--at {asked}: no run has so many evaluations; the longest has {most}")


def _surfaces(
    runs: Sequence[Contender], comparison: Comparison, reference: FloatArray | None
) -> tuple[float, float] | None:
    fronts = [c.front(comparison.evaluations) for c in runs if c.evaluations >= comparison.evaluations]
    if reference is None or len(reference) not in DIMENSIONS or len(fronts) < 2:
        return None
    return hypervolume(median_surface(fronts), reference), hypervolume(worst_surface(fronts), reference)


def _front(logs: Mapping[tuple[Path, str, str], Summary], problem: Problem, schema: TableSchema) -> tuple[Point, ...]:
    found: list[Point] = []
    for (folder, _, _), log in logs.items():
        told = schema.evaluations(log.front)
        rows = zip(
            log.front["design_id"].to_pylist(), told.designs.tolist(), problem.tell(told).F.tolist(), strict=True
        )
        found += [Point(folder, name, tuple(design), tuple(values)) for name, design, values in rows]
    kept = nondominated(np.array([point.objectives for point in found]))
    return tuple(point for point, keep in zip(found, kept, strict=True) if keep)


def _words(comparison: Comparison, contenders: Sequence[Contender], asked: int | None) -> Iterator[str]:
    at = comparison.evaluations
    if asked is None:
        shortest = min((c for c in contenders if c.evaluations), key=lambda c: c.evaluations)
        longest = max(c.evaluations for c in contenders)
        more = f"; the longest run has {longest}, --at N compares at another number" if longest > at else ""
        yield f"compared after {at} evaluations of each run, as many as {_named(shortest)} has{more}"
    else:
        yield f"compared after the first {at} evaluations of each run"
    if comparison.left_out:
        most: dict[str, list[int]] = {}
        for contender in comparison.left_out:
            most.setdefault(contender.group, []).append(contender.evaluations)
        runs = ", ".join(f"{len(counts)} of {name} (at most {max(counts)})" for name, counts in most.items())
        yield f"runs left out, having fewer evaluations: {runs}"
    sizes = {name: len(scores) for name, scores in comparison.groups.items()}
    if len(sizes) == 1:
        yield "one strategy only, so there is nothing to test; name another store too, or add a strategy"
        return
    single = [name for name, count in sizes.items() if count < 2]
    if single:
        yield f"no rank test where a strategy has one run: {', '.join(single)}; give it more seeds"
    pairs = {tuple(sorted(pair)) for pair in combinations(sizes.values(), 2) if min(pair) > 1}
    for first, second in sorted(pairs):
        least = least_p(first, second)
        if least > SIGNIFICANCE:
            yield f"{first} against {second} runs give no p below {least:.2g}, however far apart; give more seeds"


def _named(contender: Contender) -> str:
    place = contender.group.partition(" in ")[2]
    return f"{contender.run} in {place}" if place else contender.run
