"""What the figures of the whole model are drawn from."""

from dataclasses import dataclass

import numpy as np

from divideropt.models.base import FloatArray
from divideropt.models.divider import FORMULATIONS, Scenario, parameter_set
from modelpages.runs import Run, run

CLEARANCES = np.linspace(1e-6, 20e-6, 20)
"""The range of Figure 3.11 [m]."""

POSITIONS = np.linspace(0.25, 0.75, 41)
"""φ/φ0, the near-linear part of Figure 2.6."""


@dataclass(frozen=True)
class Sweep:
    """Runs along one variable.

    Attributes:
        places: The variable, shape (n,).
        runs: One a place.
    """

    places: FloatArray
    runs: tuple[Run, ...]

    def of(self, name: str) -> FloatArray:
        """Return a quantity, shape (n,)."""
        return np.array([found[name] for found in self.runs])

    @property
    def fluid_from_nowhere(self) -> FloatArray:
        """Return QL1 + QL2 + end-seal leakage - Qs [m^3/s], shape (n,)."""
        return np.array([found.fluid_from_nowhere for found in self.runs])


def clearance_sweep(formulation: str) -> Sweep:
    """Run the standard test on the base set with each clearance."""
    base = parameter_set("thesis_base")
    runs = [run(base | {"radial_clearance": c}, FORMULATIONS[formulation]) for c in CLEARANCES.tolist()]
    return Sweep(CLEARANCES, tuple(runs))


def rotation_sweep(formulation: str) -> Sweep:
    """Run the standard test on the base set with the spool turned."""
    base = parameter_set("thesis_base")
    scenarios = [Scenario(spool_position=position) for position in POSITIONS.tolist()]
    return Sweep(POSITIONS, tuple(run(base, FORMULATIONS[formulation], scenario) for scenario in scenarios))
