"""The response of one design to its scenario: from the initial state, over the step, to the end."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from divideropt.models.base import FloatArray
from divideropt.models.divider.equilibrium import (
    Equilibrium,
    find_equilibrium,
    initial_guess,
    rest_on_rigid_stop,
)
from divideropt.models.divider.formulations import Formulation, Stop
from divideropt.models.divider.geometry import Geometry, derive_geometry
from divideropt.models.divider.kernels import STATES, jacobian, rates, signed_root, zero_state
from divideropt.models.divider.pilot import pilot_sides
from divideropt.models.divider.scenario import Scenario, coefficients
from divideropt.ode import Event, SolverSettings, SolverStatus, Trajectory, integrate


@dataclass(frozen=True)
class Phase:
    """The response between two events.

    Attributes:
        design: `COEFFICIENTS` in force, shape (1,).
        trajectory: The states; None where no time passes, or where the simulation did not get there.
        end: State at the end of the phase, shape (9,); None where the simulation did not get there.
        rest: Equilibrium under these inputs, sought from the last state simulated; None if there is none.
    """

    design: NDArray[np.record]
    trajectory: Trajectory | None
    end: FloatArray | None
    rest: Equilibrium | None

    def load_flows(self, states: FloatArray) -> FloatArray:
        """Return QL1 and QL2 [m^3/s] through the load orifices, (3.3), (3.4).

        Args:
            states: Shape (…, 9).

        Returns:
            Shape (…, 2).
        """
        d = self.design[0]
        pressures = np.maximum(states[..., 7:9], 0.0)
        roots = signed_root(np.ascontiguousarray(pressures).ravel(), d.orifice_law)  # one shape, compiled once
        return np.asarray(roots.reshape(pressures.shape) * np.array([d.load_1, d.load_2]))


@dataclass(frozen=True)
class Response:
    """One design's response.

    Attributes:
        scenario: What happened to it.
        parameters: Every parameter by name, SI.
        geometry: What they make.
        phases: One between each two events, in the order of time.
    """

    scenario: Scenario
    parameters: Mapping[str, float]
    geometry: Geometry
    phases: tuple[Phase, ...]


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
    geometry = derive_geometry(parameters, holes=formulation.arc_holes, stem=formulation.stem)
    phases: list[Phase] = []
    for inputs, begin, end in scenario.phases():
        sides = pilot_sides(parameters, geometry.viscosity, inputs.spool_position, formulation)
        design = coefficients(parameters, geometry, sides, inputs, formulation)
        if not phases and scenario.settled:
            phases.append(_at_rest(design))
            continue
        start = phases[-1].end if phases else zero_state()
        if start is None:
            phases.append(_not_reached(design, phases[-1]))
        else:
            phases.append(_integrate(design, (begin, end), start, settings))
    return Response(scenario, parameters, geometry, tuple(phases))


def _at_rest(design: NDArray[np.record]) -> Phase:
    guess = initial_guess(design)
    rest = find_equilibrium(design, guess) or rest_on_rigid_stop(design, guess)
    return Phase(design, None, None if rest is None else rest.state, rest)


def _not_reached(design: NDArray[np.record], earlier: Phase) -> Phase:
    guess = initial_guess(design) if earlier.rest is None else earlier.rest.state
    return Phase(design, None, None, find_equilibrium(design, guess))


def _integrate(
    design: NDArray[np.record], span: tuple[float, float], start: FloatArray, settings: SolverSettings
) -> Phase:
    if design[0].stop == Stop.FROZEN:
        trajectory = _integrate_to_frozen_stop(design, span, start, settings)
    else:
        trajectory = _run(design, span, start, settings)
    end = trajectory.final if trajectory.status is SolverStatus.FINISHED else None
    return Phase(design, trajectory, end, find_equilibrium(design, trajectory.final))


def _integrate_to_frozen_stop(
    design: NDArray[np.record], span: tuple[float, float], start: FloatArray, settings: SolverSettings
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
    design: NDArray[np.record],
    span: tuple[float, float],
    start: FloatArray,
    settings: SolverSettings,
    event: Event | None = None,
) -> Trajectory:
    return integrate(
        lambda t, y: rates(t, y, design), lambda t, y: jacobian(t, y, design), span, start, settings, event
    )
