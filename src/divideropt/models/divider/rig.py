"""The author's test rig as data and functions: calibration, error propagation and measured trends.

Appendix E of the thesis has the calibration and the errors, Chapter 4 the measurements. Everything is SI; numbers are
those printed. Where what is printed does not follow from the rest of it, a comment says so: nothing is mended here.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from divideropt.models.base import FloatArray

NORMAL_90 = 1.64
"""Half-width of a 90 % interval over the standard deviation of a normal error, E.4.1."""

SAMPLING_RATE = 250.0
"""Samples recorded a second [Hz], section 4.1."""


@dataclass(frozen=True)
class PressureCalibration:
    """A pressure transducer with its amplifier, P = A V + B (section E.2).

    Attributes:
        gain: A [Pa/V].
        offset: B [Pa].
    """

    gain: float
    offset: float

    def pressure(self, voltage: float) -> float:
        """Return the pressure [Pa] that a reading [V] stands for."""
        return self.gain * voltage + self.offset


@dataclass(frozen=True)
class FlowCalibration:
    """A drag-type flow meter with its amplifier, Q = A V^B (section E.2).

    Attributes:
        gain: A [m^3/s], the flow at 1 V.
        exponent: B.
    """

    gain: float
    exponent: float

    def flow(self, voltage: float) -> float:
        """Return the flow [m^3/s] that a reading [V], at least 0, stands for."""
        return float(self.gain * voltage**self.exponent)

    def voltage(self, flow: float) -> float:
        """Return the reading [V] at a flow [m^3/s], at least 0."""
        return float((flow / self.gain) ** (1 / self.exponent))


@dataclass(frozen=True)
class ErrorComponents:
    """The four parts of a reading's error with 90 % confidence (E.4.1, Table E.2), each in the reading's unit.

    Attributes:
        standard: Of what the transducer was calibrated against.
        curve_fit: Of the calibration curve.
        calibration_change: Between a calibration before the tests and one after them.
        random: Of a single reading.
    """

    standard: float
    curve_fit: float
    calibration_change: float
    random: float

    def bias(self) -> float:
        """Return the root sum of squares of the parts that averaging does not reduce."""
        return math.hypot(self.standard, self.curve_fit, self.calibration_change)

    def total(self, readings: int = 1) -> float:
        """Return the root sum of squares of all four, for the mean of some readings with independent noise."""
        return math.hypot(self.bias(), standard_deviation_of_mean(self.random, readings))


@dataclass(frozen=True)
class MeasuredRow:
    """One row of Table 4.1 or 4.2, the average of "a number of tests".

    Attributes:
        fixed_drop: Over a fixed orifice, ΔP_fixed [Pa].
        load_difference: ΔP_L after the step [Pa].
        steady_error: ERR_SS [%], with the printed sign.
        dynamic_error: ERR_CUDY [m^3], with the printed sign.
    """

    fixed_drop: float
    load_difference: float
    steady_error: float
    dynamic_error: float


def average_flow(volume: float, time: float) -> float:
    """Return the flow [m^3/s] that fills a volume [m^3] in a time [s], (E.1)."""
    return volume / time


def average_flow_error(volume: float, time: float, volume_error: float, time_error: float) -> float:
    """Bound the error [m^3/s] of (E.1) by the sum of its parts, (E.2) and (E.3).

    Args:
        volume: ΔV [m^3].
        time: Δt [s].
        volume_error: Of ΔV [m^3].
        time_error: Of Δt [s].
    """
    return abs(volume_error) / time + abs(time_error) * volume / time**2


def standard_deviation_of_mean(deviation: float, readings: int) -> float:
    """Return the standard deviation of a mean of independent readings, (E.4), in the unit of `deviation`."""
    return deviation / math.sqrt(readings)


def deviation_from_curve(measured: FloatArray, fitted: FloatArray, deviations: FloatArray) -> float:
    """Return the weighted standard deviation of data from a curve, (E.5), in the unit of the data.

    (E.5) divides by N - 1 as printed, though a calibration curve has two fitted coefficients and so leaves N - 2.

    Args:
        measured: Q_i, shape (N,), at least two.
        fitted: Q(V_i), shape (N,).
        deviations: Standard deviation σ_i of each measurement, shape (N,), all above 0.
    """
    weights = 1 / deviations**2
    count = len(measured)
    return math.sqrt(float(np.sum(weights * (measured - fitted) ** 2) / (count - 1) / (np.sum(weights) / count)))


def half_width_90(deviation: float) -> float:
    """Return the half-width of the 90 % interval of a normal error, in the unit of its standard deviation."""
    return NORMAL_90 * deviation


PRESSURE_CALIBRATIONS: Mapping[str, PressureCalibration] = MappingProxyType(
    {
        "Pa1": PressureCalibration(1.75e6, 2.33e3),
        "Pa2": PressureCalibration(1.73e6, 2.44e3),
        "Ps": PressureCalibration(1.73e6, -6.40e4),
        "load_difference": PressureCalibration(1.72e6, 6.90e3),
    }
)
"""Table E.1. The amplifiers were zeroed before each record; an offset of -64 kPa for Ps is left unexplained there."""

FLOW_CALIBRATIONS: Mapping[str, FlowCalibration] = MappingProxyType(
    {"QL1": FlowCalibration(3.17e-4, 0.553), "QL2": FlowCalibration(3.06e-4, 0.552)}
)
"""Section E.2, its Q1 and Q2."""

CALIBRATION_TIME = 60.0
"""How long the bucket filled [s], E.4.1."""

POURED_VOLUME, RECORDED_VOLUME = 0.920e-3, 0.780e-3
"""What was poured in, and what the computer recorded [m^3], E.4.1; their difference is the error of the volume."""

FLOW_ERROR_AT = 2.60e-4
"""The flow at which the random errors were recorded [m^3/s], E.4.1."""

PRESSURE_ERROR_AT = 4.83e6
"""The pressure for which Table E.2 holds [Pa]."""

FLOW_ERRORS: Mapping[str, ErrorComponents] = MappingProxyType(
    {
        "QL1": ErrorComponents(2.3e-6, 3.9e-6, 1.7e-6, 1.7e-5),
        # Printed as 10.8 % of 2.60e-4 m^3/s, which would be 2.8e-5; the printed total holds with 2.4e-5, 9.2 %.
        "QL2": ErrorComponents(2.3e-6, 3.7e-6, 7.7e-6, 2.4e-5),
    }
)
"""Flow errors with 90 % confidence [m^3/s], E.4.1."""

FLOW_ERROR_TOTALS: Mapping[str, float] = MappingProxyType({"QL1": 1.8e-5, "QL2": 2.6e-5})
"""The totals it prints for them [m^3/s]."""

PRESSURE_ERRORS: Mapping[str, ErrorComponents] = MappingProxyType(
    {
        "Pa1": ErrorComponents(4.8e3, 2.7e3, 120e3, 7.6e3),
        "Pa2": ErrorComponents(4.8e3, 5.8e3, 14e3, 13.9e3),
        "load_difference": ErrorComponents(4.8e3, 2.9e3, 22e3, 8.5e3),
        "Ps": ErrorComponents(4.8e3, 2.7e3, 114e3, 8.0e3),
    }
)
"""Pressure errors with 90 % confidence [Pa], Table E.2."""

PRESSURE_ERROR_TOTALS: Mapping[str, float] = MappingProxyType(
    {"Pa1": 120e3, "Pa2": 21e3, "load_difference": 24e3, "Ps": 114e3}
)
"""The totals it prints for them [Pa]."""

SOURCE_FLOW = 4.96e-4
"""Mean Qs of the tests of Tables 4.1 and 4.2 and of Figure 4.8 [m^3/s]; the text above Table 4.1 says 4.99e-4."""

TABLE_4_1: tuple[MeasuredRow, ...] = (
    MeasuredRow(154e3, 1.63e6, 1.23, -0.712e-3),
    MeasuredRow(430e3, 1.63e6, 0.87, -0.549e-3),
    MeasuredRow(1459e3, 1.63e6, 0.73, -0.386e-3),
)
"""The effect of the drop over the fixed orifices, at a mean load difference of 1630 kPa."""

TABLE_4_2: tuple[MeasuredRow, ...] = (
    MeasuredRow(534e3, 0.679e6, -0.070, -0.348e-3),
    MeasuredRow(534e3, 1.649e6, 0.734, -0.430e-3),
    MeasuredRow(534e3, 3.350e6, 1.257, -0.425e-3),
)
"""The effect of the load pressure difference, at a mean drop of 534 kPa; (3.6) has no negative values, (3.5) has."""

ROTATION_FIXED_DROP, ROTATION_LOAD_DIFFERENCE = 553e3, 1.649e6
"""Means of the tests of Figure 4.8, the spool rotated [Pa]; the figure's flows are not printed as numbers."""
