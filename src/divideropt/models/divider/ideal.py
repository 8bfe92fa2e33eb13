"""The ideal valve of section 2.2: no leakage, no flow forces, no friction."""

import math


def flow_ratio(spool_position: float, area_ratio: float) -> float:
    """Return QL1/QL2 of the ideal valve, (2.6).

    Args:
        spool_position: φ/φ0, strictly between 0 and 1.
        area_ratio: Ao1/Ao2, with equal discharge coefficients.
    """
    return area_ratio * math.sqrt(1.0 / spool_position - 1.0)


def desired_flows(spool_position: float, area_ratio: float, source_flow: float) -> tuple[float, float]:
    """Return QL1d and QL2d [m^3/s]: the ideal ratio (2.6) of the whole source flow, (2.7)."""
    ratio = flow_ratio(spool_position, area_ratio)
    first = source_flow * ratio / (ratio + 1.0)
    return first, source_flow - first
