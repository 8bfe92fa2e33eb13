"""How far the pilot stage can be believed: its grooves' flow against what a laminar, loss-free groove assumes.

Assumption 5 of section 2.3 is laminar flow in the grooves without losses at their entrance and exit.
"""

import math

from divideropt.models.divider.groove_kernels import groove_inlets
from divideropt.models.divider.response import Response

LARGEST_REYNOLDS = 2000.0
"""Laminar flow in a duct below about this."""

LARGEST_VELOCITY_RATIO = 1.0
"""The pressure that drives a groove could not give a loss-free jet more than this."""


def groove_quantities(response: Response) -> dict[str, float]:
    """Measure the grooves at the worst equilibrium and groove.

    Args:
        response: One design's response.

    Returns:
        `groove_reynolds` (over the hydraulic diameter b/√3), `groove_velocity_ratio` (to √(2(Ps - Pa)/ρ)),
        `pilot_share` (of the source flow) and `within_validity` (1 or 0); nothing where there is no equilibrium.
    """
    p, groove = response.parameters, response.valve.groove
    reynolds, ratios, shares = [], [], []
    for phase in response.phases:
        if phase.rest is None:
            continue
        state, d = phase.rest.state, phase.design[0]
        flows = groove_inlets(state, d)
        shares.append(2 * sum(flows) / d.source_flow)
        for flow, chamber in zip(flows, state[1:3], strict=True):
            velocity = abs(flow) / groove.area
            drop = max(float(state[0] - chamber), 0.0)
            jet = math.sqrt(2 * drop / p["density"])
            reynolds.append(velocity * groove.hydraulic_diameter / p["kinematic_viscosity"])
            ratios.append(velocity / jet if jet > 0.0 else math.inf)
    if not shares:
        return {}
    valid = max(reynolds) <= LARGEST_REYNOLDS and max(ratios) <= LARGEST_VELOCITY_RATIO
    return {
        "groove_reynolds": max(reynolds),
        "groove_velocity_ratio": max(ratios),
        "pilot_share": max(shares),
        "within_validity": float(valid),
    }
