"""The ideal valve of section 2.2: no leakage, no flow forces, no friction, and a pilot flow too small to count."""

import math
from typing import overload

import numpy as np

from divideropt.models.base import FloatArray
from divideropt.ode.compiled import compiled


@overload
def flow_ratio(spool_position: float, area_ratio: float) -> float: ...
@overload
def flow_ratio(spool_position: FloatArray, area_ratio: float) -> FloatArray: ...
def flow_ratio(spool_position: float | FloatArray, area_ratio: float) -> float | FloatArray:
    """Return QL1/QL2 of the ideal valve, (2.6).

    Args:
        spool_position: φ/φ0, strictly between 0 and 1; one, or an array of any shape.
        area_ratio: Ao1/Ao2, with equal discharge coefficients.

    Returns:
        The ratio, in the shape of `spool_position`.
    """
    if isinstance(spool_position, np.ndarray):
        return np.asarray(area_ratio * np.sqrt(1.0 / spool_position - 1.0))
    return area_ratio * math.sqrt(1.0 / spool_position - 1.0)


@overload
def flow_fraction(spool_position: float, area_ratio: float) -> float: ...
@overload
def flow_fraction(spool_position: FloatArray, area_ratio: float) -> FloatArray: ...
def flow_fraction(spool_position: float | FloatArray, area_ratio: float) -> float | FloatArray:
    """Return QL1/Qs of the ideal valve, (2.7): the share of the source flow that goes to load 1.

    Args:
        spool_position: φ/φ0, strictly between 0 and 1; one, or an array of any shape.
        area_ratio: Ao1/Ao2, with equal discharge coefficients.

    Returns:
        The fraction, in the shape of `spool_position`.
    """
    ratio = flow_ratio(spool_position, area_ratio)
    return ratio / (ratio + 1.0)


@compiled
def desired_flows(spool_position, area_ratio, source_flow):  # type: ignore[no-untyped-def]
    """Return QL1d and QL2d [m^3/s]: the ideal ratio (2.6) of the whole source flow, (2.7); compiled.

    Args:
        spool_position: φ/φ0, strictly between 0 and 1.
        area_ratio: Ao1/Ao2, with equal discharge coefficients.
        source_flow: Qs [m^3/s].
    """
    ratio = area_ratio * math.sqrt(1.0 / spool_position - 1.0)
    first = source_flow * (ratio / (ratio + 1.0))
    return first, source_flow - first
