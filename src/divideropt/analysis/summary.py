"""A run's log summed up in one pass, part by part, so that a long log costs no memory."""

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
import pyarrow as pa

from divideropt.analysis.breaches import Breaches, all_breaches, breaches_of
from divideropt.analysis.failures import Failures, all_failures, failures_of
from divideropt.analysis.fronts import nondominated
from divideropt.analysis.indicators import best_attainment
from divideropt.models import Outcome
from divideropt.problem import Problem, Told
from divideropt.store import TableSchema

UNREPEATABLE = (Outcome.TIMED_OUT, Outcome.CRASHED)
"""Outcomes a clock or a machine makes: a run that has one may come out otherwise from scratch."""


@dataclass(frozen=True)
class Best:
    """The design with the least max λ_i of (3.24).

    Attributes:
        row: Its row of the log.
        value: That value.
        design: The row, as a table.
    """

    row: int
    value: float
    design: pa.Table


@dataclass(frozen=True)
class Summary:
    """What a log says.

    Attributes:
        told: What an optimiser was told, violations summed up in one column.
        outcomes: How many simulations ended how; only those that occurred.
        examples: A sentence of the first simulation that ended so.
        best: The best by goal attainment; None where no design is feasible or an objective has no goal.
        front: The feasible non-dominated rows in the order of evaluation, the first of equals, without `batch`.
        failures: Where in the box simulations failed, of its own evaluations.
        breaches: Which bounds the others of these break.
        shared: How many of the first are those of the run from which this one branched, and are counted there.
        own: How many of the rest ended how.
    """

    told: Told
    outcomes: Mapping[str, int]
    examples: Mapping[str, str]
    best: Best | None
    front: pa.Table
    failures: Failures
    breaches: Breaches
    shared: int
    own: Mapping[str, int]

    @property
    def evaluations(self) -> int:
        """Number of rows."""
        return len(self.told.F)


def repeatable(outcomes: Mapping[str, int]) -> bool:
    """Whether a run whose simulations ended so comes out the same from scratch."""
    return not any(outcome in outcomes for outcome in UNREPEATABLE)


def summarise(log: Iterable[pa.Table], problem: Problem, schema: TableSchema, shared: int = 0) -> Summary:
    """Sum up a log.

    Args:
        log: Its parts, in their order.
        problem: What is optimised.
        schema: The log's columns.
        shared: How many of its first rows are another run's, and are counted there.
    """
    told = [Told(np.empty((0, len(problem.objectives))), np.empty((0, 1)))]
    nothing = schema.evaluations(schema.arrow.empty_table())
    failures, breaches = failures_of(nothing, problem.space), breaches_of(problem.tell(nothing))
    outcomes: Counter[str] = Counter()
    others: Counter[str] = Counter()
    examples: dict[str, str] = {}
    best, front, values, rows = None, schema.arrow.empty_table(), told[0].F, 0
    for part in log:
        evaluations = schema.evaluations(part)
        for verdict, count in Counter(evaluations.verdicts).items():
            outcomes[str(verdict.outcome)] += count
            examples.setdefault(str(verdict.outcome), verdict.text)
        fresh = problem.tell(evaluations)
        begin = min(max(0, shared - rows), part.num_rows)
        others.update(str(verdict.outcome) for verdict in evaluations.verdicts[:begin])
        own = evaluations.part(begin, part.num_rows)
        failures = all_failures([failures, failures_of(own, problem.space)])
        breaches = all_breaches([breaches, breaches_of(Told(fresh.F[begin:], fresh.G[begin:]))])
        found = best_attainment(fresh, problem)
        if found is not None and (best is None or found[1] < best.value):
            best = Best(rows + found[0], found[1], part.take(pa.array([found[0]])))
        feasible = np.flatnonzero(fresh.feasible)
        feasible = feasible[nondominated(fresh.F[feasible])]
        values = np.concatenate([values, fresh.F[feasible]])
        kept = nondominated(values)
        front = pa.concat_tables([front, part.take(pa.array(feasible))]).filter(pa.array(kept)).combine_chunks()
        values = values[kept]
        told.append(Told(fresh.F, fresh.violation[:, None]))
        rows += part.num_rows
    together = Told(np.concatenate([t.F for t in told]), np.concatenate([t.G for t in told]))
    own_outcomes = outcomes - others
    designs = front.drop_columns(["batch"])
    return Summary(together, outcomes, examples, best, designs, failures, breaches, shared, own_outcomes)
