"""The response of one design to its scenario: from the initial state, over the events, to the end."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from divideropt.models.base import FloatArray
from divideropt.models.divider.coefficients import Valve
from divideropt.models.divider.equilibrium import (
    Equilibrium,
    find_equilibrium,
    initial_guess,
    rest_on_rigid_stop,
    without_friction,
)
from divideropt.models.divider.formulations import Formulation, Stop
from divideropt.models.divider.geometry import Geometry
from divideropt.models.divider.kernels import flows_of, jacobian, rates, zero_state
from divideropt.models.divider.record import Design
from divideropt.models.divider.run_kernels import run
from divideropt.models.divider.scenario import Scenario, Span
from divideropt.models.divider.states import STATES
from divideropt.ode import ROSENBROCK, Event, SolverSettings, SolverStatus, Trajectory, integrate
from divideropt.ode.rosenbrock import Workspace

RESCUER = "Radau"
"""LSODA and BDF take tiny steps where a fast mode is hardly damped, since their formulas of higher order would blow
it up; this one does not."""

RESCUE_STEPS = 500
"""Ten times what it needs then; a design that chatters is given up."""


@dataclass(frozen=True)
class Phase:
    """The response over one span of the scenario.

    Attributes:
        span: When, and under which inputs.
        design: `COEFFICIENTS` in force, shape (1,).
        trajectory: The states; None where no time passes, or where the simulation did not get there.
        end: State at the end of the phase, shape (9,); None where the simulation did not get there.
        rest: Equilibrium under these inputs, sought from the last state simulated; None if there is none, or if the
            inputs move.
    """

    span: Span
    design: Design
    trajectory: Trajectory | None
    end: FloatArray | None
    rest: Equilibrium | None

    def load_flows(self, states: FloatArray, times: FloatArray | None = None) -> FloatArray:
        """Return QL1 and QL2 [m^3/s] through the load orifices, (3.3), (3.4).

        Args:
            states: Shape (…, 9).
            times: When [s], shape (…); the end of the phase where not given. It matters where the inputs move.

        Returns:
            Shape (…, 2).
        """
        when = np.full(states.shape[:-1], self.span.end) if times is None else times
        flat = np.ascontiguousarray(states).reshape(-1, states.shape[-1])  # one shape, compiled once
        flows = flows_of(flat, np.ascontiguousarray(when).ravel(), self.design)
        return np.asarray(flows).reshape(*states.shape[:-1], 2)


@dataclass(frozen=True)
class Response:
    """One design's response.

    Attributes:
        scenario: What happened to it.
        valve: The design.
        phases: One for each span of the scenario, in the order of time.
    """

    scenario: Scenario
    valve: Valve
    phases: tuple[Phase, ...]

    @property
    def parameters(self) -> Mapping[str, float]:
        """Every parameter by name, SI."""
        return self.valve.parameters

    @property
    def geometry(self) -> Geometry:
        """What they make."""
        return self.valve.geometry

    @property
    def rests_at_root(self) -> bool:
        """Whether a final state is an equilibrium to be solved for, and not wherever the response ends."""
        return self.scenario.settled and self.parameters["coulomb_friction"] == 0.0

    def friction_band(self, phase: Phase) -> tuple[FloatArray, FloatArray] | None:
        """Find the rests near a phase's end at which Coulomb friction holds to one side and to the other.

        Returns:
            Two states, each of shape (9,); None without friction, or where one is not found.
        """
        friction = self.parameters["coulomb_friction"]
        if friction == 0.0 or phase.end is None or phase.span.moving:
            return None
        rests = [find_equilibrium(without_friction(phase.design, f), phase.end) for f in (-friction, friction)]
        low, high = rests
        return None if low is None or high is None else (low.state, high.state)


def respond(
    parameters: Mapping[str, float],
    formulation: Formulation,
    scenario: Scenario,
    settings: SolverSettings,
) -> Response:
    """Simulate one design.

    Args:
        parameters: Every parameter by name, SI.
        formulation: Which reading of the valve.
        scenario: What happens to it.
        settings: How to integrate.

    Returns:
        The response, as far as it came.
    """
    valve = Valve.of(parameters, formulation)
    phases: list[Phase] = []
    for span in scenario.spans():
        design = valve.over(span, scenario.source_flow)
        if not phases and scenario.settled:
            phases.append(_at_rest(span, design))
            continue
        start = phases[-1].end if phases else zero_state()
        if start is None:
            phases.append(_not_reached(span, design, phases[-1]))
        else:
            phases.append(_integrate(span, design, start, settings))
    return Response(scenario, valve, tuple(phases))


def _at_rest(span: Span, design: Design) -> Phase:
    guess = initial_guess(design)
    rest = find_equilibrium(design, guess) or rest_on_rigid_stop(design, guess)
    return Phase(span, design, None, None if rest is None else rest.state, rest)


def _not_reached(span: Span, design: Design, earlier: Phase) -> Phase:
    guess = initial_guess(design) if earlier.rest is None else earlier.rest.state
    return Phase(span, design, None, None, None if span.moving else find_equilibrium(design, guess))


def _integrate(span: Span, design: Design, start: FloatArray, settings: SolverSettings) -> Phase:
    times = (span.begin, span.end)
    if design["stop"][0] == Stop.FROZEN:
        trajectory = _integrate_to_frozen_stop(design, times, start, settings)
    else:
        trajectory = _run(design, times, start, settings)
    end = trajectory.final if trajectory.status is SolverStatus.FINISHED else None
    rest = None if span.moving else find_equilibrium(design, trajectory.final)
    return Phase(span, design, trajectory, end, rest)


def _integrate_to_frozen_stop(
    design: Design, span: tuple[float, float], start: FloatArray, settings: SolverSettings
) -> Trajectory:
    """Integrate over a stop that freezes the spool: a solver would halve its steps for ever before the jump."""
    position, stop = STATES.index("x"), float(design[0].stop_position)
    if abs(start[position]) > stop:
        return _run(design, span, start, settings)
    free = design.copy()
    free[0].stop = Stop.NONE
    moving = _run(free, span, start, settings, lambda y: abs(y[position]) - stop)
    if moving.status is not SolverStatus.EVENT or moving.edges[-1] >= span[1]:
        return moving
    jammed = moving.final.copy()
    jammed[position] = math.copysign(math.nextafter(stop, math.inf), jammed[position])
    return moving.then(_run(design, (float(moving.edges[-1]), span[1]), jammed, settings))


def _run(
    design: Design,
    span: tuple[float, float],
    start: FloatArray,
    settings: SolverSettings,
    event: Event | None = None,
) -> Trajectory:
    """Integrate; where a multistep method's budget ends, let an implicit Runge-Kutta method try."""
    if settings.method == ROSENBROCK:
        return _run_compiled(design, span, start, settings, event)

    def attempt(with_settings: SolverSettings) -> Trajectory:
        return integrate(
            lambda t, y: rates(t, y, design), lambda t, y: jacobian(t, y, design), span, start, with_settings, event
        )

    first = attempt(settings)
    if first.status is not SolverStatus.STEP_BUDGET or settings.method == RESCUER:
        return first
    rescued = attempt(replace(settings, method=RESCUER, max_steps=min(settings.max_steps, RESCUE_STEPS)))
    return rescued if rescued.status in (SolverStatus.FINISHED, SolverStatus.EVENT) else first


def _run_compiled(
    design: Design, span: tuple[float, float], start: FloatArray, settings: SolverSettings, event: Event | None
) -> Trajectory:
    """Integrate by the Rosenbrock method, its loop and the right-hand side compiled together."""
    work = Workspace(len(start), settings.max_steps)
    work.state[:] = start
    bound = math.inf if event is None else float(design[0].stop_position)
    ending = run(
        design, *span, settings.max_steps, work.s, work.k, work.state, work.u, work.U,
        settings.rtol, np.array(settings.atol), bound, work.edges, work.values,
    )  # fmt: skip
    return work.trajectory(ending, start, event)
