"""The divider as a model to optimise: parameters in, quantities and verdicts out."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from divideropt.models.base import FloatArray, Parameter, Quantity, Verdict
from divideropt.models.divider.formulations import FORMULATIONS
from divideropt.models.divider.metrics import measure
from divideropt.models.divider.parameters import PARAMETERS
from divideropt.models.divider.quantities import QUANTITIES
from divideropt.models.divider.response import Response, respond
from divideropt.models.divider.scenario import Scenario
from divideropt.models.divider.tolerances import solver_settings
from divideropt.ode import SolverSettings


@dataclass(frozen=True)
class Divider:
    """The adjustable-ratio flow divider.

    Attributes:
        formulation: A name of `FORMULATIONS`.
        scenario: What happens to every design.
        settings: How to integrate.
    """

    formulation: str = "conservative"
    scenario: Scenario = field(default_factory=Scenario)
    settings: SolverSettings = field(default_factory=solver_settings)

    @property
    def parameters(self) -> Mapping[str, Parameter]:
        """Every parameter, in the order of a design's columns."""
        return PARAMETERS

    @property
    def quantities(self) -> Mapping[str, Quantity]:
        """Every quantity, in the order of a row."""
        return QUANTITIES

    def evaluate(self, designs: FloatArray) -> tuple[FloatArray, Sequence[Verdict]]:
        """Simulate a batch.

        Args:
            designs: Shape (n, d), columns as in `parameters`, SI.

        Returns:
            The quantities, shape (n, m), and a verdict a design.
        """
        rows, verdicts = [], []
        for design in designs:
            row, verdict = measure(self.respond(dict(zip(PARAMETERS, design.tolist(), strict=True))))
            rows.append(row)
            verdicts.append(verdict)
        return np.array(rows).reshape(len(designs), len(QUANTITIES)), verdicts

    def respond(self, parameters: Mapping[str, float]) -> Response:
        """Simulate one design and keep its response; parameters by name, SI."""
        return respond(parameters, FORMULATIONS[self.formulation], self.scenario, self.settings)
