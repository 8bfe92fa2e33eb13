"""Other integrators of the valve, and how near they come: the same start, the same second, the same metrics.

Each gives the states at the nodes of our own steps, between which the metrics are polynomials; so each is asked for
some two hundred states, no more. What it gives is measured as our own responses are, and that is not timed.
"""

import importlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any, cast

import numba
import numpy as np
from loops import Integration
from scipy.integrate import odeint, solve_ivp

from divideropt.models.base import FloatArray
from divideropt.models.divider import PARAMETERS, Divider, groove_kernels, kernels
from divideropt.models.divider.kernels import jacobian, motion, rates
from divideropt.models.divider.metrics import measure
from divideropt.models.divider.record import COEFFICIENTS, Design, blank
from divideropt.models.divider.response import Response
from divideropt.models.divider.states import N_STATES
from divideropt.models.divider.tolerances import DEFAULT_SCALES
from divideropt.ode import SolverStatus, Trajectory
from divideropt.ode.base import NODES
from divideropt.ode.rosenbrock import Workspace

SCALES = np.array(list(DEFAULT_SCALES.values()))
"""Of the states: everyone's absolute tolerance is rtol times these, as ours."""

MAX_STEPS = 100_000
"""Between two states asked for."""

Peer = Callable[["Case", float], FloatArray]
"""A case and a relative tolerance to the states at the case's times."""


@dataclass(frozen=True)
class Case:
    """One design's response to a step.

    Attributes:
        response: As the model has it.
        ours: The model's integration of its last phase.
        design: `COEFFICIENTS` there, shape (1,).
        start: State at its beginning, shape (9,).
        edges: Our steps' edges [s], shape (k + 1,).
        times: The nodes of our steps, each once [s], shape (m,).
    """

    response: Response
    ours: Integration
    design: Design
    start: FloatArray
    edges: FloatArray
    times: FloatArray

    @classmethod
    def all_of(cls, model: Divider, designs: FloatArray) -> list["Case"]:
        """Simulate designs, rows in the order of `PARAMETERS`."""
        work = Workspace(N_STATES, model.settings.max_steps)
        return [cls._of(model, design, work) for design in designs]

    @classmethod
    def _of(cls, model: Divider, design: FloatArray, work: Workspace) -> "Case":
        response = model.respond(dict(zip(PARAMETERS, design.tolist(), strict=True)))
        first, last = response.phases
        assert first.end is not None
        assert last.trajectory is not None
        span, edges = (last.span.begin, last.span.end), last.trajectory.edges
        inner = edges[:-1, None] + np.diff(edges)[:, None] * NODES[:-1]
        ours = Integration(last.design, span, first.end, model.settings, work)
        return cls(response, ours, last.design, first.end, edges, np.append(inner.ravel(), edges[-1]))

    def measured(self, states: FloatArray) -> FloatArray:
        """Return the quantities of a response with these states at the case's times, shape (m, 9)."""
        steps, per_step = len(self.edges) - 1, len(NODES) - 1
        nodes = np.arange(steps)[:, None] * per_step + np.arange(per_step + 1)
        return self.quantities(
            Trajectory(self.edges, np.ascontiguousarray(states[nodes].transpose(0, 2, 1)), SolverStatus.FINISHED)
        )

    def quantities(self, trajectory: Trajectory) -> FloatArray:
        """Return the quantities of a response that goes this way."""
        first, last = self.response.phases
        phases = (first, replace(last, trajectory=trajectory, end=trajectory.final))
        return measure(replace(self.response, phases=phases))[0]


_ODEINT: Any = odeint
_SOLVE_IVP: Any = solve_ivp


def by_odeint(case: Case, rtol: float) -> FloatArray:
    """SciPy's LSODA in its own loop, with the compiled rates and Jacobian."""
    return _odeint(rates, jacobian, case, rtol)


def by_solve_ivp(case: Case, rtol: float, method: str = "LSODA") -> FloatArray:
    """SciPy's steps in a Python loop, with the compiled rates and Jacobian."""
    begin, end = case.times[0], case.times[-1]
    found = _SOLVE_IVP(
        rates, (begin, end), case.start, method, case.times,
        args=(case.design,), jac=jacobian, rtol=rtol, atol=rtol * SCALES,
    )  # fmt: skip
    return np.asarray(found.y.T) if found.success else np.full((len(case.times), N_STATES), np.nan)


def in_python(case: Case, rtol: float) -> FloatArray:
    """The same as `by_odeint` from the kernels' Python source, within `uncompiled`; floats, no numpy scalars."""
    record = case.design[0]
    fields = {name: record[name] for name in COEFFICIENTS.names or ()}
    plain = {name: value.item() for name, value in fields.items() if not value.shape}
    folded = {name: dict(np.ndenumerate(value)) for name, value in fields.items() if value.shape}
    d = SimpleNamespace(**plain, **folded)
    fill = cast(Any, motion).py_func

    def python_rates(t: float, y: FloatArray, _: Design) -> list[float]:
        out = [0.0] * N_STATES
        fill(t, y.tolist(), d, out, None)
        return out

    def python_jacobian(t: float, y: FloatArray, _: Design) -> FloatArray:
        jac = np.zeros((N_STATES, N_STATES))
        fill(t, y.tolist(), d, [0.0] * N_STATES, jac)
        return jac

    return _odeint(python_rates, python_jacobian, case, rtol)


def _odeint(of_rates: Any, of_jacobian: Any, case: Case, rtol: float) -> FloatArray:
    return np.asarray(
        _ODEINT(
            of_rates, case.start, case.times, (case.design,), of_jacobian,
            tfirst=True, rtol=rtol, atol=rtol * SCALES, mxstep=MAX_STEPS,
        )
    )  # fmt: skip


@contextmanager
def uncompiled() -> Iterator[None]:
    """Let the kernels' Python sources call each other's."""
    called = [
        (module, name, f)
        for module in (kernels, groove_kernels)
        for name, f in vars(module).items()
        if hasattr(f, "py_func") and name != "motion"
    ]
    for module, name, f in called:
        setattr(module, name, f.py_func)
    try:
        yield
    finally:
        for module, name, f in called:
            setattr(module, name, f)


def numbalsoda_peer() -> Peer | None:
    """Return numbalsoda's LSODA with the compiled rates, or None where it is not installed.

    It takes one absolute tolerance for all states, so it is given the states over their scales, and no Jacobian.
    """
    try:
        numbalsoda = importlib.import_module("numbalsoda")
    except ImportError:
        return None
    address = _scaled_motion().address

    def peer(case: Case, rtol: float) -> FloatArray:
        given = blank(_GIVEN)
        given["design"], given["scales"] = case.design, SCALES
        states, fine = numbalsoda.lsoda(
            address, case.start / SCALES, case.times, given.view(np.float64), rtol, rtol, MAX_STEPS
        )
        return np.asarray(states * SCALES) if fine else np.full((len(case.times), N_STATES), np.nan)

    return peer


_GIVEN = np.dtype([("design", COEFFICIENTS), ("scales", "f8", (N_STATES,)), ("y", "f8", (N_STATES,))])
"""What the callback reads through its pointer, with room for the states in their units."""


def _scaled_motion() -> Any:
    """Compile dy/dt of the scaled states for numbalsoda: a C function of t, y, dy and a pointer."""
    double, at = numba.types.double, numba.types.CPointer(numba.types.double)
    given_at = numba.types.CPointer(numba.from_dtype(_GIVEN))

    @numba.cfunc(numba.types.void(double, at, at, given_at), error_model="numpy")
    def fill(t, y, dy, pointer):  # type: ignore[no-untyped-def]
        given = numba.carray(pointer, (1,))[0]
        state, out = numba.carray(y, (N_STATES,)), numba.carray(dy, (N_STATES,))
        for i in range(N_STATES):
            given.y[i] = state[i] * given.scales[i]
        motion(t, given.y, given.design, out, None)
        for i in range(N_STATES):
            out[i] /= given.scales[i]

    return fill
