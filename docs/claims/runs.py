"""Runs of the base set for section 3.4, one parameter at a time, over the author's own ranges."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from divideropt.models.base import FloatArray, Outcome
from divideropt.models.divider import (
    FORMULATIONS,
    PARAMETERS,
    QUANTITIES,
    Divider,
    Scenario,
    load_step,
    parameter_set,
    solver_settings,
)
from divideropt.models.divider.response import Response, respond
from divideropt.models.divider.study import THESIS_POINTS, THESIS_RANGES
from divideropt.problem.simulation import one_thread

AUTHOR_STEP_TIME = 0.6
"""When the load steps in changeall.m, after a cold start [s]."""

RTOL = 1e-6
"""Tolerance of the integration (LSODA): a hundredth of the default, so that no verdict hangs on it."""

SETTINGS = solver_settings("LSODA", RTOL)
"""Those of every run."""


@dataclass(frozen=True)
class Variant:
    """A formulation and how its runs start.

    Attributes:
        formulation: A name of `FORMULATIONS`.
        settled: Whether runs start at the equilibrium before the step; else cold, as the author's did.
    """

    formulation: str
    settled: bool = True

    def __str__(self) -> str:
        """Its name in the page."""
        return self.formulation if self.settled else f"{self.formulation}, cold"


VARIANTS = (Variant("conservative"), Variant("text"), Variant("listing"), Variant("listing", settled=False))
"""What every statement is judged by: the three formulations, and the author's code as he started it."""


@dataclass(frozen=True)
class Sweep:
    """Results along one parameter.

    Attributes:
        values: Of the parameter, SI, shape (n,).
        results: Every quantity by name, shape (n,), NaN where it is not defined.
        ok: Where the outcome is ok, shape (n,).
        failures: How many designs ended otherwise, by outcome, in words; empty if none did.
    """

    values: FloatArray
    results: Mapping[str, FloatArray]
    ok: NDArray[np.bool_]
    failures: str

    def __getitem__(self, quantity: str) -> FloatArray:
        """Return a quantity of the designs that are ok, shape (sum of `ok`,)."""
        return self.results[quantity][self.ok]

    @property
    def places(self) -> FloatArray:
        """Where the designs that are ok lie, shape (sum of `ok`,)."""
        return self.values[self.ok]


class Runs:
    """The runs of one variant, each sweep made once."""

    def __init__(self, variant: Variant) -> None:
        """Make nothing yet."""
        self.variant = variant
        self._sweeps: dict[tuple[str, tuple[float, ...], float], Sweep] = {}

    def sweep(self, parameter: str, values: Sequence[float] | None = None, accumulation_time: float = 0.2) -> Sweep:
        """Vary one parameter of the base set in the standard test.

        Args:
            parameter: Its name.
            values: SI; 100 over the author's range where not given.
            accumulation_time: t_cum [s].
        """
        chosen = tuple(np.linspace(*THESIS_RANGES[parameter], THESIS_POINTS).tolist() if values is None else values)
        key = (parameter, chosen, accumulation_time)
        if key not in self._sweeps:
            designs = [{parameter: value} for value in chosen]
            self._sweeps[key] = _swept(chosen, self.designs(designs, accumulation_time))
        return self._sweeps[key]

    def base(self) -> Mapping[str, float]:
        """Return every quantity of the base set itself."""
        default = PARAMETERS["spool_radius"].default
        return {name: float(column[0]) for name, column in self.sweep("spool_radius", (default,)).results.items()}

    def designs(
        self, changes: Sequence[dict[str, float]], accumulation_time: float = 0.2
    ) -> list[tuple[Mapping[str, float], Outcome]]:
        """Run the base set with each of some changes; return quantities by name and the outcome of each."""
        designs = [parameter_set("thesis_base") | change for change in changes]
        return simulate(self.variant.formulation, self._test(accumulation_time), designs)

    def response(self, change: Mapping[str, float]) -> Response:
        """Return the response of the base set with a change, for what no quantity says."""
        design = parameter_set("thesis_base") | dict(change)
        with one_thread():
            return respond(design, FORMULATIONS[self.variant.formulation], self._test(0.2), SETTINGS)

    def _test(self, accumulation_time: float) -> Scenario:
        settled = self.variant.settled
        step = load_step(1, 15e6, at=0.0 if settled else AUTHOR_STEP_TIME)
        return Scenario(events=(step,), settled=settled, accumulation_time=accumulation_time)


def simulate(
    formulation: str, scenario: Scenario, designs: Sequence[Mapping[str, float]]
) -> list[tuple[Mapping[str, float], Outcome]]:
    """Simulate designs, every parameter given by name, SI; return quantities by name and the outcome of each."""
    model = Divider(formulation, scenario, SETTINGS)
    with one_thread():  # with another number of threads some narrow groove ends otherwise
        rows, verdicts = model.evaluate(np.array([[design[name] for name in PARAMETERS] for design in designs]))
    named = [dict(zip(QUANTITIES, row.tolist(), strict=True)) for row in rows]
    return [(row, verdict.outcome) for row, verdict in zip(named, verdicts, strict=True)]


def _swept(values: Sequence[float], runs: Sequence[tuple[Mapping[str, float], Outcome]]) -> Sweep:
    outcomes = [outcome for _, outcome in runs]
    failures = Counter(outcome.value for outcome in outcomes if outcome is not Outcome.OK)
    return Sweep(
        values=np.array(values),
        results={name: np.array([row[name] for row, _ in runs]) for name in QUANTITIES},
        ok=np.array([outcome is Outcome.OK for outcome in outcomes]),
        failures=", ".join(f"{count} {name}" for name, count in sorted(failures.items())),
    )
