"""Kinematic viscosity of an oil by its temperature."""

from dataclasses import dataclass

import numpy as np

from divideropt.models.base import FloatArray

ZERO_CELSIUS = 273.15
"""In kelvin."""

_SQUARE_MM = 1e6
_SHIFT = 0.7
"""What the law adds to a viscosity in mm²/s."""


@dataclass(frozen=True)
class Walther:
    """ASTM D341, which is Walther's law through two points: log log(ν + 0.7) = A - B log T, ν in mm²/s, T in kelvin.

    D341 has further terms below 2 mm²/s, where no hydraulic oil works; they are left out.

    Attributes:
        cold: Temperature [°C] and viscosity [m²/s] of one point.
        warm: Those of the other, which is warmer and thinner.
    """

    cold: tuple[float, float]
    warm: tuple[float, float]

    def viscosity(self, temperature: FloatArray) -> FloatArray:
        """Return the viscosity.

        Args:
            temperature: Any shape, above absolute zero [°C].

        Returns:
            The same shape [m²/s].
        """
        (t1, v1), (t2, v2) = self.cold, self.warm
        y1, y2 = _twice_logged(v1), _twice_logged(v2)
        x1, x2 = np.log10(t1 + ZERO_CELSIUS), np.log10(t2 + ZERO_CELSIUS)
        x = np.log10(np.asarray(temperature) + ZERO_CELSIUS)
        y = y1 + (y2 - y1) * (x - x1) / (x2 - x1)
        return np.asarray((10.0**10.0**y - _SHIFT) / _SQUARE_MM)


THESIS_OIL = Walther((25.0, 66e-6), (60.0, 15e-6))
"""The range of the thesis's oil: 66 mm²/s at 25 °C and 15 mm²/s at 60 °C (section 3.4)."""


def _twice_logged(viscosity: float) -> float:
    return float(np.log10(np.log10(viscosity * _SQUARE_MM + _SHIFT)))
