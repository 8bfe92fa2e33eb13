"""The divider's results by name: the metrics of section 3.1 and what a design's geometry makes."""

from collections.abc import Mapping
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
    Quantity("open_drop", "Pa", "", "drop at the design flow with the ports fully open, both holes counted", 1e6),
    Quantity("spool_mass", "kg", "m, (3.14)", "of the spool", 0.1),
    Quantity("stroke", "m", "2 x_max", "of the spool, stop to stop", 1e-3),
    Quantity("spool_length", "m", "L_T", "of the spool", 0.1),
)

QUANTITIES: Mapping[str, Quantity] = MappingProxyType({q.name: q for q in _TABLE})
"""Every quantity by name, in the order of a row of results."""
