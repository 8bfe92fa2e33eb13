"""Strategies compared, and designs to choose, as text, as JSON and as a table."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd

from divideropt.analysis import INDICATORS, Ranking, Score, effect_size
from divideropt.analysis.course import quantile
from divideropt.campaign.compare import Compared
from divideropt.report.display import Axis, axis_of, number

QUARTILES = (0.25, 0.5, 0.75)
"""Quantiles of what runs reached that are shown."""


def comparison_text(compared: Compared) -> str:
    """Word a comparison for people: strategies, tests, designs to choose."""
    parts = [_strategies(compared)]
    if compared.comparison.tests:
        parts.append(_tests(compared.comparison.tests))
    parts.append(_choice(compared))
    return "\n\n".join(parts) + "\n"


def comparison_table(compared: Compared) -> pd.DataFrame:
    """Return a row a run: store, strategy, run, evaluations, designs, every indicator; NaN where not defined."""
    rows = []
    for score in compared.comparison.scores:
        group = compared.groups[score.group]
        values = {name: np.nan if value is None else value for name, value in score.values.items()}
        rows.append(
            {
                "store": str(group.store),
                "strategy": group.strategy,
                "run": score.run,
                "evaluations": compared.comparison.evaluations,
                "front": score.front,
                "shared": score.shared,
                **values,
            }
        )
    return pd.DataFrame(rows)


def comparison_data(compared: Compared) -> dict[str, Any]:
    """Return all that is said as plain data for JSON; null for what is not defined or infinite."""
    comparison = compared.comparison
    strategies = [
        {
            "store": str(group.store),
            "strategy": group.strategy,
            "runs": len(comparison.groups[name]),
            "shared": sum(score.shared for score in comparison.groups[name]),
            **{key: _spread(key, comparison.groups[name]) for key in INDICATORS},
            "surfaces": None
            if group.surfaces is None
            else dict(zip(("median", "worst"), group.surfaces, strict=True)),
        }
        for name, group in compared.groups.items()
    ]
    return {
        "evaluations": comparison.evaluations,
        "strategies": strategies,
        "runs": [_finite(row) for row in comparison_table(compared).to_dict("records")],
        "tests": [row for tests in comparison.tests for row in _test_rows(tests)],
        "front": {
            "designs": compared.designs,
            "within_reference": len(compared.front),
            "knees": [_design(compared, row) for row in compared.choice.knees],
            "meeting_goals": [_design(compared, int(row)) for row in compared.choice.goals.meeting],
            "nearest_goals": None if compared.choice.goals.nearest is None else _nearest(compared),
            "best_by_achievement": None
            if compared.choice.wished is None
            else _design(compared, compared.choice.wished),
        },
        "words": list(compared.words),
    }


def quartiles(name: str, scores: Sequence[Score]) -> tuple[float, float, float] | None:
    """Return lower quartile, median and upper quartile of an indicator over runs; None where it is not defined."""
    values = sorted(value for score in scores if (value := score.values[name]) is not None)
    if not values:
        return None
    lower, median, upper = (float(quantile(np.array([values]).T, share)[0]) for share in QUARTILES)
    return lower, median, upper


def quartile_text(name: str, scores: Sequence[Score]) -> str:
    """Write the median, and the quartiles in brackets where there are several runs."""
    found = quartiles(name, scores)
    if found is None:
        return "–"
    lower, median, upper = (number(value) if np.isfinite(value) else "∞" for value in found)
    return median if len(scores) == 1 else f"{median} ({lower}, {upper})"


def p_text(p: float | None) -> str:
    """Write a p-value with two digits, as nobody reads more."""
    return "–" if p is None else number(p, 2)


def _strategies(compared: Compared) -> str:
    comparison = compared.comparison
    shown = [name for name in INDICATORS if any(score.values[name] is not None for score in comparison.scores)]
    surfaces = any(group.surfaces for group in compared.groups.values())
    rows = [["", "runs", *(INDICATORS[name].title for name in shown), "designs on the front of all"]]
    rows[0] += ["hypervolume half the runs reach", "hypervolume all runs reach"] if surfaces else []
    for name, scores in comparison.groups.items():
        row = [name, str(len(scores)), *(quartile_text(key, scores) for key in shown)]
        row.append(str(sum(score.shared for score in scores)))
        if surfaces:
            found = compared.groups[name].surfaces
            row += ["–", "–"] if found is None else [number(volume) for volume in found]
        rows.append(row)
    rows = [list(column) for column in zip(*rows, strict=True)]
    return f"After {_plural(comparison.evaluations, 'evaluation')} of each run: median (quartiles)\n" + _aligned(rows)


def _tests(all_tests: Sequence[Ranking]) -> str:
    rows = [["indicator", "strategy", "against", "better in", "effect", "p", "p corrected"]]
    for tests in all_tests:
        for pair, corrected in zip(tests.pairs, tests.corrected, strict=True):
            effect = ("–", "–") if pair.effect is None else (f"{100 * pair.effect:.0f} %", effect_size(pair.effect))
            title = INDICATORS[tests.indicator].title
            rows.append([title, pair.first, pair.second, *effect, p_text(pair.p), p_text(corrected)])
    overall = [f"{INDICATORS[t.indicator].title} {p_text(t.overall)}" for t in all_tests if t.overall is not None]
    lines = ["Rank tests of each two strategies: in how many pairs of runs the first is better", _aligned(rows)]
    if overall:
        lines.append("all strategies together (Kruskal-Wallis), p: " + ", ".join(overall))
    return "\n".join(lines)


def _choice(compared: Compared) -> str:
    choice, front = compared.choice, compared.front
    axes = _axes(compared)
    goals = choice.goals
    part = "" if compared.designs == len(front) else f" that are within the reference point, of {compared.designs}"
    lines = [f"Choosing among {_plural(len(front), 'design')} of the best known front{part}"]
    if goals.nearest is not None:
        lines.append(_goal_words(compared))
    if not choice.knees:
        lines.append("the front has no knee")
    if choice.reasons:
        head = ["design", "why", *(f"{axis.words} {axis.bracket}".rstrip() for axis in axes), "pseudo-weights"]
        rows = [head]
        for row, why in choice.reasons.items():
            point = front[row]
            name = _name(compared, row)
            values = [axis.text(value) for axis, value in zip(axes, point.objectives, strict=True)]
            weights = " ".join(f"{weight:.2f}" for weight in choice.weights[row])
            rows.append([name, ", ".join(why), *values, weights])
        lines.append(_aligned(rows, words=2))
    return "\n".join(lines)


def _goal_words(compared: Compared) -> str:
    goals = compared.choice.goals
    if len(goals.meeting):
        return f"{len(goals.meeting)} of them meet every goal"
    lacks = ", ".join(
        f"{axis.words} by {axis.text(lack)} {axis.shown.unit}".rstrip()
        for axis, lack in zip(_axes(compared), goals.lacks, strict=True)
        if lack > 0.0
    )
    return f"none meets every goal; the nearest, {_name(compared, goals.nearest or 0)}, misses {lacks}"


def _axes(compared: Compared) -> list[Axis]:
    columns = zip(*(point.objectives for point in compared.front), strict=True)
    return [
        axis_of(objective.quantity, values)
        for objective, values in zip(compared.problem.objectives, columns, strict=True)
    ]


def _name(compared: Compared, row: int) -> str:
    point = compared.front[row]
    several = len({group.store for group in compared.groups.values()}) > 1
    return f"{point.design_id} in {point.store}" if several else point.design_id


def _aligned(rows: Sequence[Sequence[str]], words: int = 1) -> str:
    """Set a table: so many columns of words to the left, the others to the right."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return "\n".join(
        "  ".join(
            cell.ljust(width) if place < words else cell.rjust(width)
            for place, (cell, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in rows
    )


def _spread(name: str, scores: Sequence[Score]) -> dict[str, float | None] | None:
    found = quartiles(name, scores)
    return None if found is None else _finite(dict(zip(("lower", "median", "upper"), found, strict=True)))


def _test_rows(tests: Ranking) -> list[dict[str, Any]]:
    return [
        {
            "indicator": tests.indicator,
            "first": pair.first,
            "second": pair.second,
            "better": pair.effect,
            "effect": None if pair.effect is None else effect_size(pair.effect),
            "p": pair.p,
            "p_corrected": corrected,
            "p_overall": tests.overall,
        }
        for pair, corrected in zip(tests.pairs, tests.corrected, strict=True)
    ]


def _design(compared: Compared, row: int) -> dict[str, Any]:
    point, problem = compared.front[row], compared.problem
    names = [objective.quantity.name for objective in problem.objectives]
    return {
        "store": str(point.store),
        "design_id": point.design_id,
        "variables": dict(zip(problem.space.names, point.variables, strict=True)),
        "objectives": dict(zip(names, point.objectives, strict=True)),
        "pseudo_weights": dict(zip(names, compared.choice.weights[row].tolist(), strict=True)),
    }


def _nearest(compared: Compared) -> dict[str, Any]:
    goals = compared.choice.goals
    names = [objective.quantity.name for objective in compared.problem.objectives]
    return _design(compared, goals.nearest or 0) | {"lacks": dict(zip(names, goals.lacks.tolist(), strict=True))}


def _plural(count: int, word: str) -> str:
    return f"{count} {word}{'' if count == 1 else 's'}"


def _finite(values: Any) -> dict[str, Any]:
    """Put None for what JSON has no word for."""
    return {k: None if isinstance(v, float) and not np.isfinite(v) else v for k, v in values.items()}
