"""A store to what its report says: frozen, in the platform's units, without a word of how it is drawn."""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import pyarrow as pa

from divideropt.analysis import (
    Comparison,
    Contender,
    Convergence,
    Summary,
    Verified,
    compare,
    convergence,
    marked,
)
from divideropt.analysis.breaches import all_breaches
from divideropt.analysis.failures import all_failures
from divideropt.analysis.summary import Best
from divideropt.campaign.branches import active_runs, stored_runs, summaries
from divideropt.campaign.ending import kept_ending
from divideropt.campaign.load import stored_campaign
from divideropt.campaign.neighbourhood import with_residuals
from divideropt.campaign.plan import Run, build_problem, reference_of
from divideropt.models.base import FloatArray
from divideropt.problem import Problem
from divideropt.report.choosing import Choosing, choosing_of
from divideropt.report.convergence import Track, tracks_of
from divideropt.report.cost import Cost, read_cost
from divideropt.report.drawn import rows_drawn
from divideropt.report.facts import (
    ObjectiveFacts,
    VariableFacts,
    bounds_of,
    constraints_of,
    objectives_of,
    variables_of,
)
from divideropt.report.failing import Failing, failing_of
from divideropt.report.front import Design, Leaning, designs_of, leanings
from divideropt.report.headline import Headline, headline_of
from divideropt.report.provenance import Provenance, read_provenance
from divideropt.report.responses import Responses, read_responses
from divideropt.report.runs import RunFacts, read_run
from divideropt.report.scenarios import UnderScenarios, read_scenarios, worth_a_table
from divideropt.report.setting import setting_of
from divideropt.report.sheets import Sheets, read_sheets
from divideropt.report.sketches import Sketches, read_sketches
from divideropt.report.standing import front_of, state_of
from divideropt.report.study_summary import StudySummary, study_summary
from divideropt.report.tried import Tried, read_tried
from divideropt.store import Store, TableSchema

COMPANION_NOTE = (
    "The companion without scenarios and uncertainty, which the campaign asks for (`nominal: true`), has not ended: "
    "what these cost is not known yet."
)

Reader = Callable[[pa.Table], tuple[Design, ...]]
"""Evaluations to designs."""


@dataclass(frozen=True)
class ReportData:
    """All that a report says.

    Attributes:
        name: The campaign's name.
        campaign: The campaign as resolved, YAML.
        setting: What made the figures, as pairs of a heading and a sentence.
        variables: The variables.
        objectives: The objectives.
        constraints: The constraints, a sentence each.
        runs: The runs, in the campaign's order.
        headline: What came out, goal by goal.
        tracks: How the runs came on.
        failing: What failed, and where.
        front: The combined front, the best by goal attainment first.
        kkt: How near to stationary its designs are.
        tolerance: Largest deviation of an objective that still counts as the same [%].
        drawn: Rows of the front that the figures draw.
        tried: Evaluations of all runs, which the front is drawn against.
        best: The best of each strategy by goal attainment; empty where there are no goals.
        comparison: The strategies compared; None where there is one only, or nothing feasible.
        choosing: Designs of the front that are worth a look; None without a front.
        leanings: The bounds that the front leans on.
        responses: The step responses; None for a model that has none.
        scenarios: The best designs under each scenario; None where there is one, or no front.
        cost: The companion's front beside this; None where there is none, or nothing to compare yet.
        notes: Sentences on the state of the store.
        provenance: What computed it, and how to repeat it.
        studies: The campaign's sensitivity studies in short.
        sketches: What draws the designs to scale; None for a model that offers no sketch.
        sheets: Dimension sheets of designs whose response there is; None where there are none.
    """

    name: str
    campaign: str
    setting: tuple[tuple[str, str], ...]
    variables: tuple[VariableFacts, ...]
    objectives: tuple[ObjectiveFacts, ...]
    constraints: tuple[str, ...]
    runs: tuple[RunFacts, ...]
    headline: Headline
    tracks: tuple[Track, ...]
    failing: Failing
    front: tuple[Design, ...]
    kkt: Convergence
    tolerance: float
    drawn: tuple[int, ...]
    tried: Tried
    best: tuple[Design, ...]
    comparison: Comparison | None
    choosing: Choosing | None
    leanings: tuple[Leaning, ...]
    responses: Responses | None
    scenarios: UnderScenarios | None
    cost: Cost | None
    notes: tuple[str, ...]
    provenance: Provenance
    studies: tuple[StudySummary, ...] = ()
    sketches: Sketches | None = None
    sheets: Sheets | None = None

    @property
    def strategies(self) -> tuple[str, ...]:
        """The strategies, in the campaign's order."""
        return tuple(dict.fromkeys(run.strategy for run in self.runs))

    @property
    def branches(self) -> tuple[str, ...]:
        """The runs that went on from another's log."""
        return tuple(run.name for run in self.runs if "-branch-" in run.name)

    @property
    def agreeing(self) -> int:
        """How many designs of the front came out the same when they were simulated again."""
        return sum(design.verified is Verified.YES for design in self.front)

    @property
    def deviating(self) -> tuple[Design, ...]:
        """Those that did not."""
        return tuple(design for design in self.front if design.verified is Verified.DEVIATES)

    @property
    def beyond_validity(self) -> int:
        """How many designs of the front are where the model does not vouch for itself."""
        return sum(design.valid is False for design in self.front)


def read_report(store: Store, logs: Mapping[str, Summary] | None = None) -> ReportData:
    """Read a store, finished or not.

    Args:
        store: The store.
        logs: Each run's log, summed up, where the caller knows; read if not given.

    Returns:
        What its report says.

    Raises:
        UsageError: There is no store in the folder.
        FileMistakes: The campaign in it cannot be read.
        StoreError: A log or a front is damaged or of a later version.
    """
    campaign = stored_campaign(store)
    text = store.read_campaign()
    problem, runs = build_problem(campaign), stored_runs(campaign, store)
    schema = TableSchema.of(problem)
    if logs is None:
        logs = summaries(campaign, store, problem, schema)
    logs = {run.name: logs[run.name] for run in runs}  # in this order, whoever read them
    strategies = {run.name: run.strategy for run in runs}
    reference = reference_of(campaign)
    endings = {run.name: kept_ending(store, run, logs[run.name].evaluations) for run in runs}
    active = active_runs(campaign, store)
    shortest = _shortest(active, logs)
    facts = tuple(
        read_run(run, logs[run.name], problem.objectives, reference, endings[run.name], shortest.get(run.strategy, 0))
        for run in runs
    )
    table, notes = front_of(store, logs, problem, schema)
    known = store.verification(schema).table()
    table = with_residuals({"combined": table}, campaign, problem, store)["combined"]
    table = marked(table, known, problem, schema, campaign.verification.share)
    front = designs_of(table, problem, schema, strategies)
    cost = read_cost(campaign, store) if campaign.nominal else None
    waiting = (COMPANION_NOTE,) if campaign.nominal and cost is None else ()
    best = _best(facts, logs, lambda rows: designs_of(rows, problem, schema, strategies))
    variables, objectives = variables_of(problem), objectives_of(problem, front, reference)
    failures = all_failures([log.failures for log in logs.values()])
    breaches = all_breaches([log.breaches for log in logs.values()])
    data = ReportData(
        campaign.name,
        text,
        setting_of(campaign),
        variables,
        objectives,
        constraints_of(problem),
        facts,
        headline_of(front, best, objectives),
        tracks_of([found for run, found in zip(runs, facts, strict=True) if run in active], objectives),
        failing_of(failures, breaches, variables, bounds_of(problem)),
        front,
        convergence(table),
        campaign.verification.tolerance,
        rows_drawn(front),
        read_tried(logs),
        best,
        _comparison(facts, logs, problem, reference, {run.name for run in active}),
        choosing_of(front, problem.objectives, reference),
        leanings(front, problem.space),
        read_responses(problem, front, best),
        _with_companion(read_scenarios(problem, table, worth_a_table(front, problem)), cost),
        cost,
        state_of(facts, store) + notes + waiting,
        read_provenance(store, campaign),
        study_summary(store),
    )
    return _with_dimensions(data, problem)


def _with_dimensions(data: ReportData, problem: Problem) -> ReportData:
    """Add what draws the designs, and sheets of those whose response there is."""
    known = {design.design_id: design for design in (*data.front, *data.best)}
    simulated = data.responses.designs if data.responses else ()
    sheets = read_sheets(problem, [known[response.name] for response in simulated if response.name in known])
    return replace(data, sketches=read_sketches(problem), sheets=sheets)


def _shortest(runs: Sequence[Run], logs: Mapping[str, Summary]) -> dict[str, int]:
    """Evaluations of the shortest run of each strategy that has any."""
    found: dict[str, int] = {}
    for run in runs:
        count = logs[run.name].evaluations
        if count:
            found[run.strategy] = min(count, found.get(run.strategy, count))
    return found


def _with_companion(under: UnderScenarios | None, cost: Cost | None) -> UnderScenarios | None:
    """Put the best of the companion's front beside those of the campaign's, scenario by scenario."""
    return under if under is None or cost is None else replace(under, designs=(*under.designs, *cost.under))


def _comparison(
    facts: Sequence[RunFacts],
    logs: Mapping[str, Summary],
    problem: Problem,
    reference: FloatArray | None,
    active: Collection[str],
) -> Comparison | None:
    """Compare the strategies after as many evaluations as every run has; a run that branched by its last branch."""
    contenders = [Contender(run.strategy, run.name, logs[run.name].told) for run in facts if run.name in active]
    if len({c.group for c in contenders if c.evaluations}) < 2:
        return None
    return compare(contenders, problem.objectives, reference)


def _best(facts: Sequence[RunFacts], logs: Mapping[str, Summary], read: Reader) -> tuple[Design, ...]:
    """The best of each strategy by goal attainment, in the campaign's order; of its first run that has it."""
    found: dict[str, Best] = {}
    for run in facts:
        best = logs[run.name].best
        if best is not None and (run.strategy not in found or best.value < found[run.strategy].value):
            found[run.strategy] = best
    return tuple(read(best.design)[0] for best in found.values())
