"""Morris's elementary effects of every quantity of a study, with what was done about its failed designs."""

from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from divideropt.analysis.elementary import RESAMPLES, SEED, effects_of, summary_of, ways_of
from divideropt.analysis.failures import Failures, failures_of, working
from divideropt.analysis.pick_freeze import size_of
from divideropt.analysis.sobol import COLUMNS
from divideropt.analysis.treatments import Treatment, Undefined, quantity_columns, treated
from divideropt.models.base import FloatArray
from divideropt.problem import DesignSpace, Evaluations, Problem


@dataclass(frozen=True)
class MorrisStudy:
    """What a Morris sample says.

    Attributes:
        effects: A row a number, with the columns of a table of indices: `kind` mu, mu_star or sigma, in the
            quantity's unit for a way of one range of the variable; `low` and `high` the 95 % interval of mu_star, NaN
            of others; `samples` the trajectories; `used` the part of a variable's steps that gave an effect.
        undefined: The quantities that have none under a treatment.
        failures: Where designs failed.
        trajectories: Number of trajectories.
        left_over: Designs at the end that make no whole trajectory.
    """

    effects: pd.DataFrame
    undefined: tuple[Undefined, ...]
    failures: Failures
    trajectories: int
    left_over: int


def morris_study(evaluations: Evaluations, problem: Problem) -> MorrisStudy:
    """Estimate the elementary effects of every quantity and of the outcome being ok.

    A step from or to a design that does not count gives no effect.

    Args:
        evaluations: In the order of `SALib.sample.morris`; an unfinished last trajectory is left out.
        problem: What was simulated; of signed quantities the magnitude is analysed.

    Raises:
        ValueError: The designs are no trajectories, or less than one.
    """
    length = len(problem.space) + 1
    trajectories = len(evaluations) // length
    left_over = len(evaluations) - trajectories * length
    evaluations = evaluations.part(0, trajectories * length)
    ways = ways_of(evaluations.designs, problem.space)
    ok = working(evaluations)
    rows: list[pd.DataFrame] = []
    undefined: list[Undefined] = []
    done: set[str] = set()
    for name, values in quantity_columns(problem, evaluations.quantities, ok):
        if name in done:
            continue
        done.add(name)
        for item in treated(name, values, ok, None):
            if item.constant:
                reason = "it is constant" if item.kept.any() else "it is defined in no design that counts"
                undefined.append(Undefined(name, item.treatment, reason))
                continue
            size = size_of(item.values[item.kept])
            scaled = replace(item, values=item.values / size)
            found = effects_of(scaled, ways)
            if item.kept.all():
                summary = size * _by_salib(evaluations.designs, scaled.values, problem.space, ways)
            else:
                summary = size * np.array([summary_of(column[np.isfinite(column)]) for column in found.T])
            rows.append(_rows(name, item.treatment, summary, np.isfinite(found).mean(axis=0), problem, trajectories))
    table = pd.concat(rows, ignore_index=True) if rows else pd.DataFrame(columns=list(COLUMNS))
    failures = failures_of(evaluations, problem.space)
    return MorrisStudy(table, tuple(undefined), failures, trajectories, left_over)


def _by_salib(designs: FloatArray, values: FloatArray, space: DesignSpace, ways: FloatArray) -> FloatArray:
    """The same by SALib, which knows whole samples; shape (d, 4)."""
    from SALib.analyze.morris import analyze  # noqa: PLC0415 (slow to import)

    step = float(np.abs(ways).max())
    levels = round(2 * step / (2 * step - 1))  # SALib's step is levels / (2 (levels - 1)) of a range
    description = {
        "num_vars": len(space),
        "names": list(space.names),
        "bounds": np.column_stack([space.lower, space.upper]).tolist(),
    }
    found = analyze(description, designs, values, num_levels=levels, num_resamples=RESAMPLES, seed=SEED)
    return np.column_stack([np.asarray(found[k], float) for k in ("mu", "mu_star", "sigma", "mu_star_conf")])


def _rows(
    name: str, treatment: Treatment, summary: FloatArray, used: FloatArray, problem: Problem, trajectories: int
) -> pd.DataFrame:
    kinds = ("mu", "mu_star", "sigma")
    tables = []
    for place, kind in enumerate(kinds):
        half = summary[:, 3] if kind == "mu_star" else np.full(len(summary), np.nan)
        tables.append(
            pd.DataFrame(
                {
                    "quantity": name,
                    "variable": problem.space.names,
                    "with": None,
                    "kind": kind,
                    "value": summary[:, place],
                    "low": summary[:, place] - half,
                    "high": summary[:, place] + half,
                    "samples": trajectories,
                    "treatment": str(treatment),
                    "used": used,
                }
            ).astype({"with": object})
        )
    table = pd.concat(tables)
    known: pd.DataFrame = table[np.isfinite(table["value"])]
    return known
