"""What chosen designs do under each scenario of a campaign, from the columns of its tables."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pyarrow as pa

from divideropt.campaign.plan import dividers
from divideropt.models import Outcome, Quantity, Verdict
from divideropt.models.base import FloatArray
from divideropt.models.divider.scenarios import column_of, outcomes_by_scenario
from divideropt.problem import Problem
from divideropt.report.front import Design

ALWAYS = (
    "steady_state_error",
    "load_regulation",
    "ratio_bias",
    "dynamic_error",
    "source_pressure",
    "settling_time",
    "stability_margin",
)
"""Quantities that are shown whatever the objectives are."""

SMALL_IS_BAD = ("stability_margin", "stop_clearance")
"""Quantities of which the smallest is the worst; of the others the largest magnitude."""


@dataclass(frozen=True)
class QuantityRow:
    """A quantity of one design.

    Attributes:
        quantity: Which.
        values: Under each scenario, in its unit, NaN where it is not defined.
        worst: The first place where it is the worst; None where it is defined nowhere.
        same: Whether it is the same wherever it is defined, so that none is to be marked.
    """

    quantity: Quantity
    values: tuple[float, ...]
    worst: int | None
    same: bool


@dataclass(frozen=True)
class DesignUnder:
    """A design under every scenario.

    Attributes:
        label: Why it is shown.
        design_id: Which it is.
        rows: Its quantities.
        outcomes: How it ended in each scenario; None where that is not known, after one in which it failed.
    """

    label: str
    design_id: str
    rows: tuple[QuantityRow, ...]
    outcomes: tuple[Outcome | None, ...]


@dataclass(frozen=True)
class UnderScenarios:
    """Some designs under every scenario.

    Attributes:
        scenarios: Names of the scenarios, the campaign's own first.
        designs: The designs.
    """

    scenarios: tuple[str, ...]
    designs: tuple[DesignUnder, ...]


def read_scenarios(problem: Problem, table: pa.Table, chosen: Sequence[tuple[str, str]]) -> UnderScenarios | None:
    """Read what designs do under each scenario.

    Args:
        problem: Of several scenarios or not.
        table: Evaluations of the problem, with `design_id`, every quantity's column and the outcome.
        chosen: Label and `design_id` of each design wanted.

    Returns:
        What the table holds of those that are in it; None where there is one scenario, or no such design.
    """
    models = dividers(problem.model)
    if len(models) < 2:
        return None
    scenarios = tuple(models)
    quantities = _quantities(problem)
    places = {name: row for row, name in enumerate(table["design_id"].to_pylist())}
    rows = [(label, places[name]) for label, name in chosen if name in places]
    designs = tuple(_design(label, table.slice(row, 1), scenarios, quantities) for label, row in rows)
    return UnderScenarios(scenarios, designs) if designs else None


def worth_a_table(front: Sequence[Design], problem: Problem) -> list[tuple[str, str]]:
    """Label the best design of a front by goal attainment and the best of each objective, each design once."""
    found: dict[str, list[str]] = {}
    if front and front[0].attainment is not None:
        found[front[0].design_id] = ["best by max λ"]
    for i, objective in enumerate(problem.objectives if front else ()):
        least = min(front, key=lambda design: design.objectives[i])
        found.setdefault(least.design_id, []).append(
            f"least {objective.quantity.name.replace('_', ' ').replace('.', ' ')}"
        )
    return [(", ".join(labels), name) for name, labels in found.items()]


def _quantities(problem: Problem) -> tuple[Quantity, ...]:
    """The objectives' quantities without the scenario's name, and those that are always shown."""
    known = {name: q for model in dividers(problem.model).values() for name, q in model.quantities.items()}
    names = []
    for objective in problem.objectives:
        name = objective.quantity.name
        while name not in known and "." in name:
            name = name.partition(".")[2]
        names.append(name)
    return tuple(known[name] for name in dict.fromkeys([*names, *ALWAYS]) if name in known)


def _design(label: str, row: pa.Table, scenarios: Sequence[str], quantities: Sequence[Quantity]) -> DesignUnder:
    def value(name: str) -> float:
        found = row[name][0].as_py() if name in row.column_names else None
        return np.nan if found is None else float(found)

    rows = []
    for quantity in quantities:
        values = [value(column_of(scenario, quantity.name)) for scenario in scenarios]
        worst = _worst(np.array(values), quantity.name in SMALL_IS_BAD)
        same = len({v for v in values if not np.isnan(v)}) < 2
        rows.append(QuantityRow(quantity, tuple(values), worst, same))
    verdict = Verdict(Outcome(row["outcome"][0].as_py()), row["outcome_text"][0].as_py())
    design_id = row["design_id"][0].as_py()
    return DesignUnder(label, design_id, tuple(rows), outcomes_by_scenario(verdict, scenarios))


def _worst(values: FloatArray, small_is_bad: bool) -> int | None:
    size = values if small_is_bad else np.abs(values)
    if np.isnan(size).all():
        return None
    return int(np.nanargmin(size) if small_is_bad else np.nanargmax(size))
