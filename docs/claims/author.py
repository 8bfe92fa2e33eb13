"""How near our `listing`, started cold, comes to the sweeps of the author's own code."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from claims.runs import Runs
from divideropt.models.base import FloatArray, Outcome
from divideropt.models.divider.study import LISTING_NAMES

FILE = Path(__file__).parents[2] / "tests" / "reference" / "listing_sensitivity.csv"
"""The author's code, run in GNU Octave; `tests/reference/README.md` says how."""

SOLVED = 2
"""The status of a design that his solver completed."""


@dataclass(frozen=True)
class Nearness:
    """How near we come along one parameter.

    Attributes:
        parameter: Its name.
        designs: Designs of his sweep.
        compared: Those that his solver and ours both completed.
        off: For `flow_difference`, `source_pressure`, `dynamic_error` and `settling_time`: median and largest
            difference over the largest magnitude of the sweep.
    """

    parameter: str
    designs: int
    compared: int
    off: Mapping[str, tuple[float, float]]


def nearness(runs: Runs, limit: int | None = None) -> list[Nearness]:
    """Repeat his sweeps.

    Args:
        runs: Of the listing, started cold.
        limit: How many designs of each sweep, evenly spaced; all where not given.
    """
    theirs = pd.read_csv(FILE)
    found = []
    for column, name in LISTING_NAMES.items():
        rows = theirs[theirs["param"] == column]
        if limit is not None:
            rows = rows.iloc[np.linspace(0, len(rows) - 1, limit).astype(int)]
        found.append(_compared(runs, name, rows))
    return found


def _compared(runs: Runs, name: str, rows: pd.DataFrame) -> Nearness:
    ours = runs.designs([{name: value} for value in rows["value"].tolist()])
    completed = np.array([outcome is not Outcome.NOT_COMPLETED for _, outcome in ours])
    solved = (rows["istate"].to_numpy() == SOLVED) & completed & np.isfinite(rows["sserr"].to_numpy())
    off = {}
    for column, quantity in (
        ("sserr", "flow_difference"),
        ("ssPs", "source_pressure"),
        ("dynerr", "dynamic_error"),
        ("tset", "settling_time"),
    ):
        his = rows[column].to_numpy()[solved]
        mine = np.array([row[quantity] for row, _ in ours])[solved]
        off[quantity] = _off(mine, his)
    return Nearness(name, len(rows), int(solved.sum()), off)


def _off(mine: FloatArray, his: FloatArray) -> tuple[float, float]:
    difference = np.abs(mine - his) / np.abs(his).max()
    return float(np.median(difference)), float(difference.max())
