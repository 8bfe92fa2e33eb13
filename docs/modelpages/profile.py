"""The pressure along a pilot groove: by the corrected equation, and by (A.12) with and without its own mean."""

from collections.abc import Callable

import numpy as np

from divideropt.models.base import FloatArray
from divideropt.models.divider.formulations import Pilot


def groove_pressure(
    pilot: Pilot, angles: FloatArray, tap: float, end: float, length: float, pressures: tuple[float, float, float]
) -> FloatArray:
    """Return the pressure along a groove, (P4) and (P5).

    Args:
        pilot: Which solution.
        angles: Places s from the supply, shape (n,) [rad].
        tap: Angle of the tap φ [rad].
        end: Angle of the groove φ0 [rad].
        length: √c [rad].
        pressures: Ps, Pb, Pa [Pa].

    Returns:
        Shape (n,) [Pa].
    """
    supply, tapped, outlet = pressures
    mean = 0.0 if pilot is Pilot.HOMOGENEOUS else (tapped + outlet) / 2
    sine: Callable[[FloatArray], FloatArray] = np.sinh if pilot is Pilot.HYPERBOLIC else np.sin

    def between(first: float, last: float, left: float, right: float) -> FloatArray:
        ends = (left - mean) * sine((last - angles) / length) + (right - mean) * sine((angles - first) / length)
        return np.asarray(mean + ends / sine(np.array((last - first) / length)))

    return np.where(angles <= tap, between(0.0, tap, supply, tapped), between(tap, end, tapped, outlet))
