"""The divider's results by name: the metrics of section 3.1 and what a design's geometry makes."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from types import MappingProxyType

from divideropt.models.base import Quantity

_TABLE = (
    Quantity("steady_state_error", "%", "(3.6)", "steady flow division error, both branches", 1.0),
    Quantity("dynamic_error", "m^3", "E_CUDY, (3.10)", "volume gained by branch 1 until settled", 1e-6, signed=True),
    Quantity("source_pressure", "Pa", "Ps", "steady source pressure after the last event", 1e7),
    Quantity("flow_difference", "%", "(3.5)", "(QL1 - QL2)/Qs at steady state", 1.0, signed=True),
    Quantity("settling_time", "s", "ts", "from the last event until QL1 stays within 2 %", 0.1),
    Quantity("dynamic_error_abs", "m^3", "∫|·| of (3.10)", "the same integral of the magnitude", 1e-6),
    Quantity("dynamic_error_percent", "%", "(3.12)", "dynamic error over Qs t_cum", 1.0, signed=True),
    Quantity("cumulative_error", "m^3", "E_CU, (3.8)", "volume error over t_cum", 1e-6, signed=True),
    Quantity("cumulative_steady_error_percent", "%", "(3.11)", "steady part of it over Qs t_cum", 1.0, signed=True),
    Quantity("friction_band", "%", "", "width in steady-state error of the band of stuck positions", 1.0),
    Quantity("ratio_bias", "%", "", "division error before the step, which rotation removes", 1.0, signed=True),
    Quantity(
        "load_regulation",
        "%",
        "",
        "change of QL1/(QL1 + QL2) over the step, which rotation cannot",
        1.0,
        signed=True,
    ),
    Quantity("pressure_loss", "Pa", "Ps - max(PL1, PL2)", "over the branch with the greater load", 1e6),
    Quantity("peak_pressure", "Pa", "", "largest of Ps, Pa, Pb in the response", 1e7),
    Quantity("load_flow_1", "m^3/s", "QL1", "steady flow to load 1 after the last event", 5e-4),
    Quantity("load_flow_2", "m^3/s", "QL2", "steady flow to load 2 after the last event", 5e-4),
    Quantity("leakage", "m^3/s", "Qs - QL1 - QL2", "source flow that reaches no load", 1e-8),
    Quantity(
        "stability_margin",
        "1/s",
        "",
        "minus the largest real part of the eigenvalues, worst equilibrium",
        10.0,
    ),
    Quantity("stop_clearance", "m", "x_max - max|x|", "left between spool and stop", 1e-3),
    Quantity(
        "groove_reynolds",
        "",
        "v (b/√3)/ν",
        "Reynolds number in the pilot groove, worst equilibrium and groove; laminar below about 2000",
        1000.0,
    ),
    Quantity(
        "groove_velocity_ratio",
        "",
        "v/√(2(Ps - Pa)/ρ)",
        "mean velocity in the pilot groove over that of a loss-free jet, worst; possible only below 1",
        1.0,
    ),
    Quantity(
        "pilot_share", "", "(2 Qc1i + 2 Qc2i)/Qs", "share of the source flow that enters the grooves, worst", 0.1
    ),
    Quantity(
        "within_validity",
        "",
        "Re ≤ 2000, v ≤ jet",
        "whether the pilot stage's assumptions hold: 1 where they do, else 0",
        1.0,
        logical=True,
    ),
    Quantity("open_drop", "Pa", "", "drop at the design flow with the ports fully open, both holes counted", 1e6),
    Quantity("spool_mass", "kg", "m, (3.14)", "of the spool", 0.1),
    Quantity("stroke", "m", "2 x_max", "of the spool, stop to stop", 1e-3),
    Quantity("spool_length", "m", "L_T", "of the spool", 0.1),
)

QUANTITIES: Mapping[str, Quantity] = MappingProxyType({q.name: q for q in _TABLE})
"""Every quantity by name, in the order of a row of results; those of an event are of the last one."""

GEOMETRIC = ("open_drop", "spool_mass", "stroke", "spool_length")
"""The quantities that no scenario changes."""

EVENT_QUANTITIES = (
    "steady_state_error",
    "dynamic_error",
    "source_pressure",
    "flow_difference",
    "settling_time",
    "dynamic_error_abs",
    "dynamic_error_percent",
    "cumulative_error",
    "cumulative_steady_error_percent",
    "friction_band",
    "load_regulation",
    "pressure_loss",
    "load_flow_1",
    "load_flow_2",
    "leakage",
)
"""The quantities that every event of a scenario has."""


def quantities_of(events: Iterable[int]) -> Mapping[str, Quantity]:
    """Return every quantity under a scenario: `QUANTITIES`, `event_1.settling_time` and so on.

    Args:
        events: Numbers of the earlier events that have metrics; the last event's quantities have plain names.
    """
    return {**QUANTITIES, **{q.name: q for number in events for q in _of_event(number)}}


def _of_event(number: int) -> Iterator[Quantity]:
    for name in EVENT_QUANTITIES:
        q = QUANTITIES[name]
        yield replace(q, name=f"event_{number}.{name}", description=f"{q.description}; event {number}")
