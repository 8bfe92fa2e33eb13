"""The divider as a model to optimise: parameters in, quantities and verdicts out."""

import os
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from functools import cache, cached_property, partial

import numpy as np

from divideropt.models.base import FloatArray, Parameter, Quantity, Verdict
from divideropt.models.dimensions import Dimension, Sketch
from divideropt.models.divider.batch import simulate_batch
from divideropt.models.divider.coefficients import options_record, rules_record, span_records
from divideropt.models.divider.course import empty_course
from divideropt.models.divider.dimensions import DIMENSIONS, measured, remade
from divideropt.models.divider.formulations import FORMULATIONS, Formulation
from divideropt.models.divider.metrics import Findings, measure
from divideropt.models.divider.parameters import PARAMETERS
from divideropt.models.divider.quantities import quantities_of
from divideropt.models.divider.record import COEFFICIENTS, Records, blank, parameter_rows
from divideropt.models.divider.response import Response, respond
from divideropt.models.divider.result_record import NOT_FOLLOWED, SOUND
from divideropt.models.divider.run_kernels import RELAXATION_STEPS
from divideropt.models.divider.scenario import Scenario
from divideropt.models.divider.sketch import divider_sketch
from divideropt.models.divider.states import N_STATES
from divideropt.models.divider.tolerances import resolving_friction, solver_settings
from divideropt.models.divider.verdicts import OK, verdict_of
from divideropt.ode import ROSENBROCK, SolverSettings
from divideropt.ode.rosenbrock import Workspace

REFERENCE_METHOD, OTHER_REFERENCE_METHOD = "Radau", "LSODA"
REFERENCE_RTOL = 1e-10
REFERENCE_MAX_STEPS = 200_000
"""A hundred times what a design that settles needs at that tolerance."""

SMALLEST_SHARE = 4
"""Designs of a batch that are worth a thread's attention."""


@dataclass(frozen=True)
class Divider:
    """The adjustable-ratio flow divider.

    Attributes:
        formulation: A name of `FORMULATIONS`.
        scenario: What happens to every design.
        settings: How to integrate.
        groove_loss: Whether the pilot grooves lose `groove_loss_factor` velocity heads at entrance and exit.
        threads: How many share a batch; the results do not depend on it.
    """

    formulation: str = "conservative"
    scenario: Scenario = field(default_factory=Scenario)
    settings: SolverSettings = field(default_factory=solver_settings)
    groove_loss: bool = False
    threads: int = 1

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
        if self.settings.method != ROSENBROCK:
            return self._one_by_one(designs)
        found = self._batch(designs)
        quantities = found.quantities()
        verdicts = [OK] * len(quantities)
        for i in np.flatnonzero(found.judgements["finding"] != SOUND):
            if found.judgements["finding"][i] == NOT_FOLLOWED:
                quantities[i], verdicts[i] = measure(self.respond(_by_name(designs[i])))
            else:
                verdicts[i] = verdict_of(found.judgements[i], self.scenario)
        return quantities, verdicts

    def _batch(self, designs: FloatArray) -> Findings:
        """Send designs through the compiled loop, `threads` shares at a time."""
        rows = parameter_rows(designs)
        found = Findings(self.scenario, len(rows))
        threads = min(self.threads, len(rows) // SMALLEST_SHARE)
        if threads <= 1:
            self._simulate(rows, found, 0, len(rows))
            return found
        edges = [len(rows) * i // threads for i in range(threads + 1)]
        others = _pool(threads - 1).map(partial(self._simulate, rows, found), edges[1:-1], edges[2:])
        self._simulate(rows, found, 0, edges[1])
        list(others)
        return found

    def _simulate(self, rows: Records, found: Findings, low: int, high: int) -> None:
        """Send a share of the designs through the compiled loop."""
        options, rules, spans, settings = self._compiled_form
        work, room = Workspace(N_STATES, 0), settings[-1] * len(spans) + RELAXATION_STEPS
        simulate_batch(
            rows, options, empty_course(rules, spans, room), blank(COEFFICIENTS), settings,
            (work.s, work.k, work.state, work.u, work.U), (found.whole, found.by_event, found.judgements), low, high,
        )  # fmt: skip

    @cached_property
    def _compiled_form(self) -> tuple[Records, Records, Records, tuple[float, FloatArray, FloatArray, int]]:
        """Formulation, scenario and settings as the compiled loop reads them."""
        free, sticky = self.settings, resolving_friction(self.settings)
        settings = (free.rtol, np.array(free.atol), np.array(sticky.atol), free.max_steps)
        return (
            options_record(self.reading),
            rules_record(self.scenario),
            span_records(self.scenario.spans()),
            settings,
        )

    def _one_by_one(self, designs: FloatArray) -> tuple[FloatArray, Sequence[Verdict]]:
        """Simulate with a solver that is not compiled with the valve."""
        measured = [measure(self.respond(_by_name(design))) for design in designs]
        quantities = np.array([row for row, _ in measured]).reshape(len(designs), len(self.quantities))
        return quantities, [verdict for _, verdict in measured]

    def on_threads(self, threads: int) -> "Divider | None":
        """Return the same model, its batches shared by threads; None for a solver that holds the interpreter."""
        return replace(self, threads=threads) if self.settings.method == ROSENBROCK else None

    def reference(self) -> "Divider":
        """Return the same valve and scenario, integrated by a second solver at a relative tolerance of 1e-10.

        It is SciPy's Radau, or its LSODA where Radau is the first.
        """
        method = REFERENCE_METHOD if self.settings.method != REFERENCE_METHOD else OTHER_REFERENCE_METHOD
        return replace(self, settings=solver_settings(method, REFERENCE_RTOL, max_steps=REFERENCE_MAX_STEPS))

    @property
    def dimensions(self) -> Mapping[str, Dimension]:
        """Every dimension, in the order of a row of `measured`."""
        return DIMENSIONS

    @cached_property
    def sketch(self) -> Sketch:
        """The drawing for any design."""
        return divider_sketch()

    def measured(self, designs: FloatArray) -> FloatArray:
        """Return the dimensions of designs, shape (n, number of dimensions), SI."""
        return measured(designs, self.reading)

    def remade(self, design: Mapping[str, float], dimensions: Mapping[str, float]) -> Mapping[str, float]:
        """Return the parameters of a design some of whose dimensions are others, by name, SI."""
        return remade(design, dimensions)

    def respond(self, parameters: Mapping[str, float], reading: Formulation | None = None) -> Response:
        """Simulate one design and keep its response.

        Args:
            parameters: Every parameter by name, SI.
            reading: Another formulation than `reading`, to see what an option does.
        """
        settings = resolving_friction(self.settings) if parameters["coulomb_friction"] > 0.0 else self.settings
        return respond(parameters, reading or self.reading, self.scenario, settings)


def _by_name(design: FloatArray) -> dict[str, float]:
    return dict(zip(PARAMETERS, design.tolist(), strict=True))


@cache
def _pool(threads: int) -> ThreadPoolExecutor:
    """Return threads that help; they are kept, since to start them takes as long as some designs."""
    return ThreadPoolExecutor(threads, thread_name_prefix="divider")


os.register_at_fork(after_in_child=_pool.cache_clear)  # threads do not come along
