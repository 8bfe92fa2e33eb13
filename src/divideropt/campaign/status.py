"""What a store holds and lacks: the work of `divideropt status`."""

from dataclasses import dataclass, replace

from divideropt.analysis import (
    Convergence,
    combined_front,
    convergence,
    hypervolume_history,
    marked,
    repeatable,
    tally,
)
from divideropt.campaign.beside import both_sides
from divideropt.campaign.branches import stored_runs, summaries
from divideropt.campaign.config import Campaign
from divideropt.campaign.ending import kept_ending
from divideropt.campaign.load import stored_campaign
from divideropt.campaign.mishaps import Mishaps
from divideropt.campaign.neighbourhood import with_residuals
from divideropt.campaign.plan import build_problem, reference_of
from divideropt.errors import DamagedFileError
from divideropt.store import Store, TableSchema


@dataclass(frozen=True)
class RunStatus:
    """One run.

    Attributes:
        run: Its name.
        evaluations: Evaluations in the log.
        shared: How many of the first are those of the run from which this one branched.
        budget: Most evaluations it asks for; a strategy may end earlier.
        feasible: How many of them are feasible.
        outcomes: How many ended how.
        best: Least max λ_i, None without a feasible design or without goals.
        best_design: The `design_id` that has it.
        hypervolume: Of the feasible designs, None without a reference point.
        repeatable: Whether it comes out the same from scratch: no simulation timed out or crashed.
        failure: Why it was given up, None if it was not.
        reason: Why it ended, in a word: budget, goals, stagnation, exhausted or branched; None before it has.
        ending: Why it ended, in a sentence.
    """

    run: str
    evaluations: int
    shared: int
    budget: int
    feasible: int
    outcomes: dict[str, int]
    best: float | None
    best_design: str | None
    hypervolume: float | None
    repeatable: bool
    failure: str | None
    reason: str | None
    ending: str | None


@dataclass(frozen=True)
class BesideStatus:
    """How a companion's front fares in the problem of its campaign.

    Attributes:
        points: Designs that stand for it.
        known: How many of them were simulated there.
        feasible: How many of these are feasible.
    """

    points: int
    known: int
    feasible: int


@dataclass(frozen=True)
class StoreStatus:
    """A store.

    Attributes:
        campaign: The campaign's name.
        runs: Each run, in the campaign's order.
        front: Designs on the combined front, None before it is written.
        verified: How many of them came out the same when they were simulated again by the model's reference.
        deviating: How many did not.
        kkt: How near to stationary its designs are, None before it is written.
        damage: What is wrong with the stored front, where that was made again from the logs; None where nothing is.
        asks_nominal: Whether the campaign asks for a companion.
        nominal: The companion's store, None before it is there.
        beside: How its front fares in the whole campaign, None before there is one.
    """

    campaign: str
    runs: tuple[RunStatus, ...]
    front: int | None
    verified: int | None
    deviating: int | None
    kkt: Convergence | None
    damage: str | None
    asks_nominal: bool = False
    nominal: "StoreStatus | None" = None
    beside: BesideStatus | None = None


def read_status(store: Store) -> StoreStatus:
    """Read a store, at rest or at work.

    Raises:
        UsageError: There is no store.
        StoreError: It is damaged.
    """
    campaign = stored_campaign(store)
    problem = build_problem(campaign)
    schema, reference = TableSchema.of(problem), reference_of(campaign)
    planned = stored_runs(campaign, store)
    logs = summaries(campaign, store, problem, schema)
    runs = []
    for run in planned:
        found, ending = logs[run.name], kept_ending(store, run, logs[run.name].evaluations)
        volumes = [] if reference is None else hypervolume_history(found.told, reference, [found.evaluations])
        runs.append(
            RunStatus(
                run=run.name,
                evaluations=found.evaluations,
                shared=found.shared,
                budget=run.budget,
                feasible=int(found.told.feasible.sum()),
                outcomes=dict(sorted(found.outcomes.items())),
                best=None if found.best is None else found.best.value,
                best_design=None if found.best is None else found.best.design["design_id"][0].as_py(),
                hypervolume=volumes[0] if volumes else None,
                repeatable=repeatable(found.outcomes),
                failure=Mishaps(store.status_folder, run.name).failure,
                reason=None if ending is None else str(ending.reason),
                ending=None if ending is None else ending.text,
            )
        )
    damage = None
    try:
        front = store.read_front("combined", schema)
    except DamagedFileError as error:
        damage = str(error)
        combined = combined_front([logs[name].front for name in sorted(logs)], problem, schema)
        known = store.verification(schema).table()
        combined = with_residuals({"combined": combined}, campaign, problem, store)["combined"]
        front = marked(combined, known, problem, schema, campaign.verification.share)
    if front is None:
        whole = StoreStatus(campaign.name, tuple(runs), None, None, None, None, None)
    else:
        count, kkt = tally(front, schema), convergence(front)
        whole = StoreStatus(campaign.name, tuple(runs), count.points, count.agree, count.deviate, kkt, damage)
    return _with_companion(whole, campaign, store) if campaign.nominal else whole


def _with_companion(found: StoreStatus, campaign: Campaign, store: Store) -> StoreStatus:
    """Add what the companion's store says."""
    own, nominal = both_sides(campaign, store)
    if not nominal.store.exists:
        return replace(found, asks_nominal=True)
    beside = None
    if nominal.front() is not None:
        points = nominal.points()
        known = own.schema.evaluations(own.known(points, nominal.schema))
        beside = BesideStatus(points.num_rows, len(known), int(own.problem.tell(known).feasible.sum()))
    return replace(found, asks_nominal=True, nominal=read_status(nominal.store), beside=beside)
