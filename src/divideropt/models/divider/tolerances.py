"""How exactly the divider is integrated where nobody says otherwise, and how large its states are."""

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType

from divideropt.models.divider.states import FRICTION_VELOCITY, STATES
from divideropt.ode import ROSENBROCK, SolverSettings

DEFAULT_METHOD = ROSENBROCK
DEFAULT_RTOL = 1e-4
DEFAULT_MAX_STEPS = 5_000
"""Twenty times what a design needs at the default tolerance; beyond, another method tries, see `response.RESCUER`."""

FRICTION_SHARE = 0.01
"""Absolute tolerance of ẋ, in shares of ẋ_tan, where there is Coulomb friction."""

STATE_UNITS: Mapping[str, str] = MappingProxyType(
    {name: {"xdot": "m/s", "x": "m"}.get(name, "Pa") for name in STATES}
)
"""The unit of each state, in the order of a state vector."""

_SCALES = {"Pa": 1e6, "m/s": 1e-2, "m": 1e-4}
"""A tenth of the load pressures; the spool's speed and way in the standard test, as powers of ten."""

DEFAULT_SCALES: Mapping[str, float] = MappingProxyType({name: _SCALES[unit] for name, unit in STATE_UNITS.items()})
"""The scale of each state, in its unit: where a campaign gives no atol, atol = rtol × scale."""


def resolving_friction(settings: SolverSettings) -> SolverSettings:
    """Tighten the velocity's tolerance so far that Coulomb friction, Fc tanh(ẋ/ẋ_tan), is seen to hold the spool.

    Without it a spool comes to rest in the wrong place of its band: with 10 N at Chapter 2's equations the
    prototype's error ends at 0.82 % instead of 0.01 %.

    Args:
        settings: As given.

    Returns:
        The same with an absolute tolerance of ẋ of at most `FRICTION_SHARE` of ẋ_tan.
    """
    atol = list(settings.atol)
    place = STATES.index("xdot")
    atol[place] = min(atol[place], FRICTION_SHARE * FRICTION_VELOCITY)
    return replace(settings, atol=tuple(atol))


def default_atol(rtol: float) -> tuple[float, ...]:
    """Return rtol × scale, one absolute tolerance a state, in the order of a state vector."""
    return tuple(rtol * scale for scale in DEFAULT_SCALES.values())


def solver_settings(
    method: str = DEFAULT_METHOD,
    rtol: float = DEFAULT_RTOL,
    atol: tuple[float, ...] | None = None,
    max_steps: int = DEFAULT_MAX_STEPS,
) -> SolverSettings:
    """Fill in what is not said.

    Args:
        method: Name of the solver.
        rtol: Relative tolerance.
        atol: Absolute tolerance a state [Pa, m/s, m]; rtol × scale where not given.
        max_steps: Budget of steps between two events.

    Returns:
        The settings, complete.
    """
    return SolverSettings(method, rtol, atol or default_atol(rtol), max_steps)
