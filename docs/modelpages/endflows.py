"""The factor 6 that (2.34)-(2.37) lost under the root, and the minus that (2.37) lost, against the appendix."""

import math
from collections.abc import Mapping
from dataclasses import replace

from divideropt.models.divider import FORMULATIONS, Scenario
from divideropt.models.divider.coefficients import Valve
from divideropt.models.divider.equilibrium import find_equilibrium, initial_guess
from divideropt.models.divider.pilot import pilot_sides
from divideropt.models.divider.record import Design
from modelpages.options import PARAMETERS
from modelpages.tables import fixed, power, table

LOST = math.sqrt(6)
"""By which the printed end flows are too large."""

AS_PRINTED = (
    (1.0, 1.0, "as (A.29), (A.30), (A.46)"),
    (LOST, 1.0, "factor of (2.34)–(2.37)"),
    (1.0, -1.0, "sign of (2.37)"),
    (LOST, -1.0, "both"),
)
"""Factor of all end flows, sign of Qc2i, and what they are called."""


def end_flows_table() -> str:
    """Tabulate the equilibrium after the step, `text`, with the end flows as derived and as printed."""
    rows = []
    for name, label in (("base", "`thesis_base`"), ("prototype", "`thesis_prototype`")):
        for factor, sign, words in AS_PRINTED:
            rows.append([f"{label}, {words}", *_equilibrium(PARAMETERS[name], factor, sign)])
    header = [
        "",
        "steady-state error [%]",
        "source pressure [MPa]",
        "fluid from nowhere [m³/s]",
        "share of the source flow [%]",
    ]
    return table(header, rows, numbers_from=1)


def with_end_flows(parameters: Mapping[str, float], factor: float, sign: float) -> Design:
    """Return the record of `text` after the step, with the grooves' end flows changed.

    Args:
        parameters: Every parameter by name, SI.
        factor: What all of them are multiplied by.
        sign: What Qc2i is multiplied by besides, 1 or -1.
    """
    reading, inputs = FORMULATIONS["text"], Scenario().spans()[-1].inputs
    design = Valve.of(parameters, reading).under(inputs)
    sides = pilot_sides(parameters, inputs.spool_position, reading)
    first, second = (
        replace(s, inlet=factor * of_inlet * s.inlet, outlet=factor * s.outlet).net()
        for s, of_inlet in zip(sides, (1.0, sign), strict=True)
    )
    design[0].pilot_1, design[0].pilot_2 = first, second
    return design


def _equilibrium(parameters: Mapping[str, float], factor: float, sign: float) -> list[str]:
    design = with_end_flows(parameters, factor, sign)
    rest = find_equilibrium(design, initial_guess(design))
    if rest is None:
        return ["no equilibrium", "–", "–", "–"]
    d, y = design[0], rest.state
    flows = [d.load_1 * math.sqrt(y[7]), d.load_2 * math.sqrt(y[8])]
    half = d.source_flow / 2
    error = 100 * sum(abs(flow - half) for flow in flows) / d.source_flow
    made = sum(flows) - d.source_flow
    return [fixed(error, 3), fixed(y[0] / 1e6, 3), power(made, 1), fixed(100 * made / d.source_flow, 4)]
