"""The store of a one-at-a-time study to what its page says: frozen, without a word of how it is drawn."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from divideropt.analysis import Effect, Sweep, effects_of, sweeps_of
from divideropt.campaign.load import stored_campaign
from divideropt.campaign.plan import build_problem, dividers, plan_runs
from divideropt.campaign.simulate import crashed
from divideropt.errors import UsageError
from divideropt.models import Parameter, Quantity, Verdict
from divideropt.models.base import FloatArray
from divideropt.models.divider import Divider
from divideropt.models.divider.metrics import measure
from divideropt.models.divider.scenarios import BASE
from divideropt.problem import Evaluations, Problem, one_thread
from divideropt.report.display import Axis, axis_of
from divideropt.report.responses import LEAD, LEAD_POINTS, StepResponse, step_response
from divideropt.report.setting import setting_of
from divideropt.store import Store, TableSchema
from divideropt.strategies import OneAtATime

STEADY, DYNAMIC, TOTAL = "cumulative_steady_error_percent", "dynamic_error_percent", "total_error_percent"
"""The errors of Figures 3.4, 3.8 and so on."""

_TOTAL = Quantity(TOTAL, "%", "(3.11) + (3.12)", "steady and dynamic error together, over Qs t_cum", 1.0, signed=True)

BESIDES = ("settling_time", "source_pressure")
"""What the thesis draws besides load flows and errors."""

IN_ERRORS = ("steady_state_error", "dynamic_error")
"""Objectives that the figure of errors shows already."""

RESPONSES = 5
"""Values of a parameter whose responses are drawn: `numberoflines` of changeall.m."""

RESPONSE_POINTS = 600
"""Points of a phase of a response: enough for a valve that oscillates."""


@dataclass(frozen=True)
class ValueResponse:
    """The response at one value of a parameter.

    Attributes:
        value: The parameter's value, in its unit.
        curve: The load flows; None where the simulation did not get to the end.
        verdict: How it ended.
        settling: The settling time [s]; None where it did not end well.
    """

    value: float
    curve: StepResponse | None
    verdict: Verdict
    settling: float | None


@dataclass(frozen=True)
class SweepFacts:
    """A parameter's part of the page.

    Attributes:
        sweep: What was found.
        axis: How the parameter is shown.
        effects: What it moves, the most first.
        responses: At some of its values; empty for a model that has none.
    """

    sweep: Sweep
    axis: Axis
    effects: tuple[Effect, ...]
    responses: tuple[ValueResponse, ...]


@dataclass(frozen=True)
class SweepsData:
    """All that the page says.

    Attributes:
        name: The campaign's name.
        campaign: The study's campaign as resolved, YAML.
        setting: What made the figures, as pairs of a heading and a sentence.
        parts: One a parameter whose sweep is whole.
        base: Every quantity of the campaign's own design.
        quantities: How each quantity is shown that has a value anywhere; logical ones have no place in it.
        objectives: Names of the objectives.
        errors: Whether the model has the errors that the thesis draws.
        accumulation_time: t_cum of these [s]; None where the model has none.
        planned: How many parameters the study has.
    """

    name: str
    campaign: str
    setting: tuple[tuple[str, str], ...]
    parts: tuple[SweepFacts, ...]
    base: Mapping[str, float]
    quantities: Mapping[str, Axis]
    objectives: tuple[str, ...]
    errors: bool
    accumulation_time: float | None
    planned: int

    @property
    def evaluations(self) -> int:
        """How many designs the whole sweeps have."""
        return sum(len(part.sweep.values) for part in self.parts)

    @property
    def failed(self) -> int:
        """How many of them failed."""
        return sum(part.sweep.failed for part in self.parts)

    @property
    def chosen(self) -> tuple[str, ...]:
        """The quantities of the table on top: the objectives, and what the thesis draws."""
        wanted = (*self.objectives, *(BESIDES if self.errors else ()))
        return tuple(name for name in dict.fromkeys(wanted) if name in self.quantities)

    @property
    def drawn(self) -> tuple[str, ...]:
        """The quantities that have a figure of their own with each parameter."""
        shown = IN_ERRORS if self.errors else ()
        first = BESIDES if self.errors else ()
        wanted = (*first, *(name for name in self.objectives if name not in shown))
        return tuple(name for name in dict.fromkeys(wanted) if name in self.quantities)


def read_sweeps(store: Store) -> SweepsData:
    """Read a study, finished or not.

    Args:
        store: The study's own store.

    Returns:
        What its page says.

    Raises:
        UsageError: There is no store in the folder, or it is of no study one parameter at a time.
        FileMistakes: The campaign in it cannot be read.
        StoreError: The log is damaged or of a later version.
    """
    campaign = stored_campaign(store)
    problem = build_problem(campaign)
    run = next((run for run in plan_runs(campaign) if isinstance(run.options, OneAtATime)), None)
    if run is None:
        raise UsageError(
            f"{store.folder}: no study of one parameter at a time; make one by `divideropt sensitivity CAMPAIGN "
            "--method oat`"
        )
    assert isinstance(run.options, OneAtATime)
    schema = TableSchema.of(problem)
    batches = [schema.evaluations(table) for table in store.log(run.name, schema).read()]
    empty = Evaluations(np.empty((0, len(problem.space))), np.empty((0, len(problem.model.quantities))), [])
    found = sweeps_of(Evaluations.together(batches or [empty]), problem, run.options.points)
    model = dividers(problem.model).get(BASE)
    quantities, sweeps, base = dict(problem.model.quantities), found.sweeps, dict(found.base)
    if model is not None:
        quantities[TOTAL] = _TOTAL
        sweeps = tuple(replace(s, quantities={**s.quantities, TOTAL: _total(s.quantities)}) for s in sweeps)
        base[TOTAL] = base[STEADY] + base[DYNAMIC]
    parameters = {v.parameter.name: v.parameter for v in problem.space.variables}
    return SweepsData(
        campaign.name,
        store.read_campaign(),
        setting_of(campaign),
        tuple(_facts(s, parameters[s.parameter], base, quantities, model, problem) for s in sweeps),
        base,
        dict(_axes(quantities, sweeps)),
        tuple(objective.quantity.name for objective in problem.objectives),
        model is not None,
        None if model is None else model.scenario.accumulation_time,
        len(problem.space),
    )


def signed_axis(quantity: Quantity, values: FloatArray) -> Axis:
    """Choose how a quantity is shown with its sign, which tables hold and objectives do not regard."""
    return axis_of(replace(quantity, signed=False), values)


def _facts(
    sweep: Sweep,
    parameter: Parameter,
    base: Mapping[str, float],
    quantities: Mapping[str, Quantity],
    model: Divider | None,
    problem: Problem,
) -> SweepFacts:
    axis = axis_of(parameter, sweep.values)
    with one_thread():  # as the study was simulated, so that a response ends as its design did
        responses = () if model is None else tuple(_responses(sweep, axis, model, problem.fixed))
    return SweepFacts(sweep, axis, effects_of(sweep, base, quantities), responses)


def _responses(sweep: Sweep, axis: Axis, model: Divider, fixed: Mapping[str, float]) -> list[ValueResponse]:
    """Simulate the responses at evenly spaced values, the first and the last among them."""
    rows = np.unique(np.linspace(0, len(sweep.values) - 1, RESPONSES).round().astype(int))
    return [_response(value, sweep.parameter, axis, model, fixed) for value in sweep.values[rows].tolist()]


def _response(value: float, name: str, axis: Axis, model: Divider, fixed: Mapping[str, float]) -> ValueResponse:
    try:
        with np.errstate(all="ignore"):  # a failed design says so by its outcome
            response = model.respond({**fixed, name: value})
            row, verdict = measure(response)
            lead_points = LEAD_POINTS if model.scenario.settled else RESPONSE_POINTS
            curve = step_response(axis.short(value), response, _lead(model), lead_points, RESPONSE_POINTS)
    except (ArithmeticError, ValueError) as error:  # dimensions that no valve has
        return ValueResponse(value, None, crashed(error), None)
    settling = float(row[list(model.quantities).index("settling_time")])
    return ValueResponse(value, curve, verdict, settling if verdict.ok else None)


def _lead(model: Divider) -> float:
    """What of the time before the first event is drawn: all of it where the valve starts empty."""
    scenario = model.scenario
    begin = scenario.events[0].at
    return LEAD if scenario.settled else begin / (scenario.end_time - begin)


def _total(quantities: Mapping[str, FloatArray]) -> FloatArray:
    return np.asarray(quantities[STEADY] + quantities[DYNAMIC])


def _axes(quantities: Mapping[str, Quantity], sweeps: Sequence[Sweep]) -> list[tuple[str, Axis]]:
    """How quantities are shown: by the designs that ended well, or by all where none did."""
    found = []
    for name, quantity in quantities.items():
        whole = np.concatenate([np.empty(0), *(sweep.quantities[name] for sweep in sweeps)])
        sound = np.concatenate([np.empty(0), *(sweep.sound(name) for sweep in sweeps)])
        if not quantity.logical and np.isfinite(whole).any():
            found.append((name, signed_axis(quantity, sound if np.isfinite(sound).any() else whole)))
    return found
