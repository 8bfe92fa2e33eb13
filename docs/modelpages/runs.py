"""One simulation of the standard test, as every table and figure of the pages takes it."""

from collections.abc import Mapping
from dataclasses import dataclass

from divideropt.models.base import Outcome
from divideropt.models.divider import QUANTITIES, Scenario, solver_settings
from divideropt.models.divider.formulations import Formulation
from divideropt.models.divider.metrics import measure
from divideropt.models.divider.response import Response, respond

EXACT = solver_settings("Radau", 1e-8)
"""Six more digits than the tables print."""


@dataclass(frozen=True)
class Run:
    """One response and what was measured on it.

    Attributes:
        response: The response.
        quantities: By name, SI and percent.
        outcome: How it ended.
    """

    response: Response
    quantities: Mapping[str, float]
    outcome: Outcome

    def __getitem__(self, name: str) -> float:
        """One quantity."""
        return self.quantities[name]

    @property
    def fluid_from_nowhere(self) -> float:
        """QL1 + QL2 + end-seal leakage - Qs at the last equilibrium [m^3/s]; NaN where there is none."""
        last = self.response.phases[-1]
        if last.rest is None:
            return float("nan")
        d, state = last.design[0], last.rest.state
        seals = d.seal_leakage * (state[3] + state[4])
        return float(last.load_flows(state).sum() + seals - d.source_flow)


def run(parameters: Mapping[str, float], formulation: Formulation, scenario: Scenario | None = None) -> Run:
    """Simulate one design.

    Args:
        parameters: Every parameter by name, SI.
        formulation: Which reading of the valve.
        scenario: What happens to it, in one event; the standard test, settled, if not given.
    """
    scenario = Scenario() if scenario is None else scenario
    return measured(respond(parameters, formulation, scenario, EXACT))


def measured(response: Response) -> Run:
    """Measure a response."""
    row, verdict = measure(response)
    return Run(response, dict(zip(QUANTITIES, row.tolist(), strict=True)), verdict.outcome)
