"""What robustness costs: a campaign's front and its companion's, each judged by both problems."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from divideropt.analysis import hypervolume
from divideropt.campaign.beside import Side, both_sides
from divideropt.campaign.config import Campaign
from divideropt.campaign.plan import reference_of
from divideropt.models.base import FloatArray, Verdict
from divideropt.models.divider.scenarios import failed_scenario
from divideropt.models.uncertain import fails_in_samples
from divideropt.problem import AGGREGATES, Problem
from divideropt.report.display import axis_of
from divideropt.report.scenarios import DesignUnder, read_scenarios
from divideropt.store import Store

GOALS = "goal_attainment"
"""In what a design is the best by max λ."""


@dataclass(frozen=True)
class Reading:
    """What one problem makes of one design.

    Attributes:
        objectives: By the campaign's objectives; NaN where the simulation failed or the problem has not this one.
        met: Whether each one's goal is met, None where there is none.
        attainment: max λ_i of (3.24), None where an objective has no goal or the simulation failed.
        words: `feasible`, or why it is not.
    """

    objectives: tuple[float, ...]
    met: tuple[bool | None, ...]
    attainment: float | None
    words: str


@dataclass(frozen=True)
class Best:
    """A design that is the best of its front in something.

    Attributes:
        nominal: Whether of the companion's front; else of the campaign's.
        design_id: On that front.
        reasons: In what: `GOALS`, or objectives by name.
        alone: What the companion's problem makes of it, None where that has not been simulated.
        whole: What the campaign's makes of it, likewise.
    """

    nominal: bool
    design_id: str
    reasons: tuple[str, ...]
    alone: Reading | None
    whole: Reading | None


@dataclass(frozen=True)
class Reason:
    """Why designs of the companion's front do not stand the whole campaign: in words, how many, and an example."""

    words: str
    count: int
    example: str


@dataclass(frozen=True)
class Placed:
    """A design in the campaign's problem: whose front it is on, its objectives, whether it is feasible there."""

    design_id: str
    nominal: bool
    objectives: tuple[float, ...]
    feasible: bool


@dataclass(frozen=True)
class Cost:
    """What a report says of the companion.

    Attributes:
        objectives: The campaign's objectives, by the names it gives.
        points: Designs that stand for the companion's front.
        size: Designs on that front.
        known: How many of the points were simulated in the whole campaign.
        feasible: How many of these are feasible there.
        reasons: Why the others are not; a design that breaks several constraints counts with each.
        bests: The best of either front, the companion's first.
        volumes: Hypervolume of the companion's front and of the campaign's, of the points that stand for each, in the
            companion's problem and in the campaign's; None without a reference point.
        placed: Designs of both fronts that have objectives in the campaign's problem.
        under: The best of the companion's front under each scenario of the campaign; none where there is but one.
    """

    objectives: tuple[str, ...]
    points: int
    size: int
    known: int
    feasible: int
    reasons: tuple[Reason, ...]
    bests: tuple[Best, ...]
    volumes: tuple[tuple[float, float], tuple[float, float]] | None
    placed: tuple[Placed, ...]
    under: tuple[DesignUnder, ...]


def read_cost(campaign: Campaign, store: Store) -> Cost | None:
    """Read what is known of a campaign's companion.

    Args:
        campaign: As resolved; one that asks for a companion.
        store: Its store.

    Returns:
        It; None before the companion has a front, and designs of it were simulated in the whole campaign.

    Raises:
        StoreError: The companion's store is damaged.
    """
    own, nominal = both_sides(campaign, store)
    front = nominal.front() if nominal.store.exists else None
    if front is None:
        return None
    theirs, ours = nominal.points(), own.points()
    known = own.known(theirs, nominal.schema)
    fronts = {
        True: (_judged(nominal, theirs), _judged(own, known)),
        False: (_judged(nominal, nominal.known(ours, own.schema)), _judged(own, ours)),
    }
    there = fronts[True][1]
    if theirs.num_rows and not there.ids:
        return None
    bests = tuple(best for of_nominal, (alone, whole) in fronts.items() for best in _bests(of_nominal, alone, whole))
    return Cost(
        tuple(campaign.objectives),
        theirs.num_rows,
        front.num_rows,
        len(there.ids),
        int(there.feasible.sum()),
        _reasons(there),
        bests,
        _volumes(own, nominal, fronts),
        tuple(place for of_nominal, (_, whole) in fronts.items() for place in _placed(of_nominal, whole)),
        _under(own.problem, known, bests),
    )


@dataclass(frozen=True)
class _Judged:
    """Designs in one problem.

    Attributes:
        names: The problem's objectives, by the names its campaign gives.
        ids: The designs.
        values: Their objectives, shape (n, k), NaN where a simulation failed.
        feasible: Shape (n,).
        broken: Whether each bound is broken, shape (n, c).
        verdicts: How the simulations ended.
        attainment: Shape (n,), NaN where not defined.
        problem: Who judges.
    """

    names: tuple[str, ...]
    ids: list[str]
    values: FloatArray
    feasible: NDArray[np.bool_]
    broken: NDArray[np.bool_]
    verdicts: Sequence[Verdict]
    attainment: FloatArray
    problem: Problem


def _under(problem: Problem, known: pa.Table, bests: Sequence[Best]) -> tuple[DesignUnder, ...]:
    """Say what the best of the companion's front, by its goals where it has any, does under each scenario."""
    first = next((best for best in bests if best.nominal), None)
    if first is None:
        return ()
    label = f"nominal front, best in {', '.join(first.reasons).replace('_', ' ')}"
    found = read_scenarios(problem, known, [(label, first.design_id)])
    return (
        tuple(replace(design, design_id=f"nominal/{design.design_id}") for design in found.designs) if found else ()
    )


def _judged(side: Side, table: pa.Table) -> _Judged:
    problem = side.problem
    evaluations = side.schema.evaluations(table)
    told = problem.tell(evaluations)
    failed = told.G[:, 0] > 0.0
    values = np.where(failed[:, None], np.nan, told.F)
    attainment = np.full(len(values), np.nan)
    if all(o.goal is not None for o in problem.objectives):
        attainment = AGGREGATES["goal_attainment"](values, problem.objectives)
    return _Judged(
        tuple(side.campaign.objectives),
        table["design_id"].to_pylist(),
        values,
        told.feasible,
        (told.G[:, 1:] > 0.0) & ~failed[:, None],
        evaluations.verdicts,
        attainment,
        problem,
    )


def _bests(of_nominal: bool, alone: _Judged, whole: _Judged) -> Iterator[Best]:
    """The best of a front by what it was optimised for, by the goals first."""
    own = alone if of_nominal else whole
    if not own.ids:
        return
    found: dict[int, tuple[str, ...]] = {}
    if not np.isnan(own.attainment).any():
        found[int(own.attainment.argmin())] = (GOALS,)
    for name, row in zip(own.names, own.values.argmin(axis=0).tolist(), strict=True):
        found[row] = (*found.get(row, ()), name)
    for row, reasons in found.items():
        name = own.ids[row]
        yield Best(of_nominal, name, reasons, _reading(alone, name, whole.names), _reading(whole, name, whole.names))


def _reading(judged: _Judged, design_id: str, objectives: Sequence[str]) -> Reading | None:
    if design_id not in judged.ids:
        return None
    row = judged.ids.index(design_id)
    values = dict(zip(judged.names, judged.values[row].tolist(), strict=True))
    goals = dict(zip(judged.names, (o.goal for o in judged.problem.objectives), strict=True))
    attainment = float(judged.attainment[row])
    return Reading(
        tuple(values.get(name, float("nan")) for name in objectives),
        tuple(_met(values.get(name), goals.get(name)) for name in objectives),
        None if np.isnan(attainment) else attainment,
        "; ".join(words for words, _ in _objections(judged, row)) or "feasible",
    )


def _met(value: float | None, goal: float | None) -> bool | None:
    return None if value is None or goal is None or np.isnan(value) else value <= goal


def _objections(judged: _Judged, row: int) -> Iterator[tuple[str, str]]:
    """Say why a design is not feasible: in words that others may share, and in the simulation's own."""
    if judged.feasible[row]:
        return
    verdict = judged.verdicts[row]
    if not verdict.ok:
        scenario = failed_scenario(verdict)
        where = " in samples" if fails_in_samples(verdict) else ""
        where += f" in scenario {scenario}" if scenario else ""
        yield f"{verdict.outcome}{where}", verdict.text
    elif np.isnan(judged.values[row]).any():
        yield "an objective is not defined", verdict.text
    bounds = list(_bounds(judged.problem))
    yield from ((bounds[i], "") for i in np.flatnonzero(judged.broken[row]))


def _bounds(problem: Problem) -> Iterator[str]:
    """Word how each bound is broken, in the order of `Told.G`."""
    for constraint in problem.constraints:
        for side, bound in (("below", constraint.minimum), ("above", constraint.maximum)):
            if bound is not None:
                axis = axis_of(constraint.quantity, [bound or constraint.quantity.scale])
                yield f"{axis.words} {side} {axis.bound(bound)}"


def _reasons(judged: _Judged) -> tuple[Reason, ...]:
    """Count why designs are not feasible, the most frequent first."""
    found: dict[str, list[str]] = {}
    for row in range(len(judged.ids)):
        for words, example in _objections(judged, row):
            found.setdefault(words, []).append(example)
    reasons = (Reason(words, len(examples), examples[0]) for words, examples in found.items())
    return tuple(sorted(reasons, key=lambda reason: -reason.count))


def _volumes(
    own: Side, nominal: Side, fronts: dict[bool, tuple[_Judged, _Judged]]
) -> tuple[tuple[float, float], tuple[float, float]] | None:
    alone, whole = reference_of(nominal.campaign), reference_of(own.campaign)
    if alone is None or whole is None:
        return None
    first, second = ((_volume(a, alone), _volume(w, whole)) for a, w in fronts.values())
    return first, second


def _volume(judged: _Judged, reference: FloatArray) -> float:
    return hypervolume(judged.values[judged.feasible], reference)


def _placed(of_nominal: bool, whole: _Judged) -> Iterator[Placed]:
    for row, name in enumerate(whole.ids):
        if not np.isnan(whole.values[row]).any():
            yield Placed(name, of_nominal, tuple(whole.values[row].tolist()), bool(whole.feasible[row]))
