"""The closed form of `pilot.md`, of a valve without leakage, rim force and friction, against the whole model."""

import math
from collections.abc import Mapping
from dataclasses import replace

from divideropt.models.divider import FORMULATIONS, parameter_set
from divideropt.models.divider.coefficient_kernels import GROOVE_FACTOR
from divideropt.models.divider.coefficients import Valve
from divideropt.models.divider.equilibrium import find_equilibrium, initial_guess
from divideropt.models.divider.ideal import flow_ratio
from divideropt.models.divider.scenario import Inputs
from modelpages.tables import fixed, power, table

CLEARANCE = 1e-8
"""Of the valve that does not leak [m]."""

POSITIONS = (0.3, 0.4, 0.5, 0.6, 0.7)
WIDTHS = (1e-3, 1.35e-3)
"""Of the groove [m]."""

ROUNDING = 1e-11
"""Relative deviations below it are not told from rounding."""

FORMULATION = replace(FORMULATIONS["conservative"], end_seals=False)


def closed_form_table() -> str:
    """Tabulate drop ratio and flow ratio, closed and of the whole model."""
    rows = []
    for width in WIDTHS:
        p = parameters(width)
        for position in POSITIONS:
            drops, flows = whole_model(p, position)
            expected = closed_flow_ratio(p, position, drops)
            rows.append(
                [
                    f"{width * 1e3:g}",
                    f"{position:g}",
                    fixed((1 - position) / position, 5),
                    _deviation(drops[0] / drops[1] * position / (1 - position)),
                    fixed(expected, 5),
                    _deviation(flows[0] / flows[1] / expected),
                    fixed(100 * (expected / flow_ratio(position, 1.0) - 1), 2),
                ]
            )
    header = [
        "b [mm]",
        "φ/φ₀",
        "Δ₁/Δ₂ by (P19)",
        "the model, relative deviation",
        "QL₁/QL₂ by (P20)",
        "the model, relative deviation",
        "(P20) over (2.6), less 1 [%]",
    ]
    return table(header, rows, numbers_from=0)


def parameters(width: float) -> dict[str, float]:
    """Return the base set without leakage, rim and friction, with a groove width [m]."""
    off = {"radial_clearance": CLEARANCE, "rim_thickness": 0.0, "coulomb_friction": 0.0}
    return parameter_set("thesis_base") | off | {"groove_width": width}


def whole_model(p: Mapping[str, float], position: float) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return Ps - Pa1 and Ps - Pa2 [Pa], and QL1 and QL2 [m^3/s], at rest with loads 15 and 10 MPa."""
    design = Valve.of(p, FORMULATION).under(Inputs(1e-3, position, (15e6, 10e6)))
    rest = find_equilibrium(design, initial_guess(design))
    if rest is None:
        raise ValueError(f"the valve has no equilibrium at φ/φ0 = {position}; take a position nearer to 0.5")
    y, d = rest.state, design[0]
    return (y[0] - y[1], y[0] - y[2]), (d.load_1 * math.sqrt(y[7]), d.load_2 * math.sqrt(y[8]))


def closed_flow_ratio(p: Mapping[str, float], position: float, drops: tuple[float, float]) -> float:
    """Return QL1/QL2 by (P20), with the second drop as found and the first from (P19)."""
    geometry = Valve.of(p, FORMULATION).geometry
    orifice = p["fixed_discharge"] * geometry.fixed_area_1 * math.sqrt(2 / p["density"])
    groove = p["groove_width"] ** 4 / (GROOVE_FACTOR * geometry.viscosity * p["spool_radius"] * p["groove_angle"])
    second = drops[1]
    first = second * (1 - position) / position
    one, other = (orifice * math.sqrt(drop) + 2 * groove * drop for drop in (first, second))
    return one / other


def _deviation(quotient: float) -> str:
    """Write how far a quotient is from 1."""
    return f"below {power(ROUNDING, 0)}" if abs(quotient - 1) < ROUNDING else power(quotient - 1, 0)
