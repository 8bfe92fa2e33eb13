"""The divider as a model to optimise: parameters in, quantities and verdicts out."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from divideropt.models.base import FloatArray, Parameter, Quantity, Verdict
from divideropt.models.divider.formulations import FORMULATIONS, Formulation
from divideropt.models.divider.metrics import measure
from divideropt.models.divider.parameters import PARAMETERS
from divideropt.models.divider.quantities import quantities_of
from divideropt.models.divider.response import Response, respond
from divideropt.models.divider.scenario import Scenario
from divideropt.models.divider.tolerances import resolving_friction, solver_settings
from divideropt.ode import SolverSettings

REFERENCE_METHOD, OTHER_REFERENCE_METHOD = "Radau", "LSODA"
REFERENCE_RTOL = 1e-10
REFERENCE_MAX_STEPS = 200_000
"""A hundred times what a design that settles needs at that tolerance."""


@dataclass(frozen=True)
class Divider:
    """The adjustable-ratio flow divider.

    Attributes:
        formulation: A name of `FORMULATIONS`.
        scenario: What happens to every design.
        settings: How to integrate.
        groove_loss: Whether the pilot grooves lose `groove_loss_factor` velocity heads at entrance and exit.
    """

    formulation: str = "conservative"
    scenario: Scenario = field(default_factory=Scenario)
    settings: SolverSettings = field(default_factory=solver_settings)
    groove_loss: bool = False

    @cached_property
    def reading(self) -> Formulation:
        """The formulation, with its options."""
        return replace(FORMULATIONS[self.formulation], groove_loss=self.groove_loss)

    @property
    def parameters(self) -> Mapping[str, Parameter]:
        """Every parameter, in the order of a design's columns."""
        return PARAMETERS

    @cached_property
    def quantities(self) -> Mapping[str, Quantity]:
        """Every quantity, in the order of a row."""
        return quantities_of(self.scenario.measured_events)

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
        return np.array(rows).reshape(len(designs), len(self.quantities)), verdicts

    def reference(self) -> "Divider":
        """Return the same valve and scenario, integrated by a second solver at a relative tolerance of 1e-10.

        It is SciPy's Radau, or its LSODA where Radau is the first.
        """
        method = REFERENCE_METHOD if self.settings.method != REFERENCE_METHOD else OTHER_REFERENCE_METHOD
        return replace(self, settings=solver_settings(method, REFERENCE_RTOL, max_steps=REFERENCE_MAX_STEPS))

    def respond(self, parameters: Mapping[str, float], reading: Formulation | None = None) -> Response:
        """Simulate one design and keep its response.

        Args:
            parameters: Every parameter by name, SI.
            reading: Another formulation than `reading`, to see what an option does.
        """
        settings = resolving_friction(self.settings) if parameters["coulomb_friction"] > 0.0 else self.settings
        return respond(parameters, reading or self.reading, self.scenario, settings)
