"""A plug-in model that costs next to nothing, with the divider's names: what is left of a campaign is the platform's.

A campaign names it as `model: {kind: "zero_cost:ZeroCost"}`; `benchmarks/` must be on PYTHONPATH.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from divideropt.models import Outcome, Parameter, Quantity, Verdict
from divideropt.models.base import FloatArray
from divideropt.models.divider import PARAMETERS, QUANTITIES

VARIABLES = ("spool_radius", "groove_width", "total_pressure_drop", "fixed_drop_ratio", "centred_opening")
BOUNDS = np.array([[6e-3, 16e-3], [0.6e-3, 2e-3], [2e6, 10e6], [0.3, 0.99], [0.1, 0.9]])

_OK = Verdict(Outcome.OK)
_FAILED = Verdict(Outcome.UNSETTLED, "the flows have not settled; the design is in the corner that fails")


class ZeroCost:
    """Three objectives in conflict over five variables (DTLZ2), with the divider's parameters and quantities.

    The front is a smooth surface; a corner of the box fails, and a band is infeasible.
    """

    parameters: Mapping[str, Parameter] = PARAMETERS
    quantities: Mapping[str, Quantity] = QUANTITIES

    def __init__(self) -> None:
        """Find the columns."""
        self._columns = [list(PARAMETERS).index(name) for name in VARIABLES]
        places = {name: i for i, name in enumerate(QUANTITIES)}
        self._objectives = [places[n] for n in ("steady_state_error", "dynamic_error", "source_pressure")]
        self._margin, self._clearance = places["stability_margin"], places["stop_clearance"]
        self._valid = places["within_validity"]

    def evaluate(self, designs: FloatArray) -> tuple[FloatArray, Sequence[Verdict]]:
        """Answer a batch, as `divideropt.models.Model` says."""
        x = (designs[:, self._columns] - BOUNDS[:, 0]) / (BOUNDS[:, 1] - BOUNDS[:, 0])
        away = 1.0 + ((x[:, 2:] - 0.5) ** 2).sum(axis=1)
        a, b = 0.5 * np.pi * x[:, 0], 0.5 * np.pi * x[:, 1]
        quantities = np.repeat(x.mean(axis=1)[:, None], len(QUANTITIES), axis=1)
        values = np.column_stack([np.cos(a) * np.cos(b), np.cos(a) * np.sin(b), np.sin(a)]) * away[:, None]
        quantities[:, self._objectives] = values * [2.0, 2e-6, 1e7] + [0.0, 0.0, 15e6]
        quantities[:, self._margin] = 0.9 - x[:, 2]
        quantities[:, self._clearance] = 1.8 - x[:, 3] - x[:, 4]
        quantities[:, self._valid] = 1.0
        failed = x[:, 2] + x[:, 3] < 0.3
        quantities[failed] = np.nan
        return quantities, [_FAILED if f else _OK for f in failed.tolist()]
