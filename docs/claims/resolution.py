"""What the author's rig can tell apart: Appendix E's errors, taken on to a flow division error and to a volume."""

import math

from divideropt.models.divider import rig

REPEATS = 3
"""Tests averaged: section 4.4 repeats one three times; of the tables it says "a number of tests"."""

STEADY_SECONDS = 1.0
"""Steady flow averaged in each test [s]: not stated."""

READINGS = int(REPEATS * STEADY_SECONDS * rig.SAMPLING_RATE)
"""Readings behind a row of a table on these assumptions, their noise taken to be independent."""


def steady_bias() -> float:
    """Return the 90 % bias of (QL1 - QL2)/Qs [%] at the tests' source flow; the common standard is counted twice."""
    first, second = rig.FLOW_ERRORS["QL1"], rig.FLOW_ERRORS["QL2"]
    return 100 * math.hypot(first.bias(), second.bias()) / rig.SOURCE_FLOW


def steady_noise(readings: int) -> float:
    """Return the 90 % random error of (QL1 - QL2)/Qs [%], averaged over some readings."""
    single = math.hypot(rig.FLOW_ERRORS["QL1"].random, rig.FLOW_ERRORS["QL2"].random)
    return 100 * rig.standard_deviation_of_mean(single, readings) / rig.SOURCE_FLOW


def steady_step(readings: int = READINGS) -> float:
    """Return the smallest difference [%] between two rows that exceeds their random errors; the bias is the same."""
    return math.sqrt(2) * steady_noise(readings)


def readings_for(difference: float) -> int:
    """Return how many readings a row needs for a difference [%] between two rows to show."""
    return math.ceil((steady_step(1) / difference) ** 2)


def volume_step(volume: float) -> float:
    """Return the smallest difference [m^3] between two rows' dynamic errors that the meters' gain does not explain.

    A constant bias goes out, since (3.10) takes off the final flows as the same meters read them. What the
    calibration may be off in gain, its bias over the flow it holds for, stays. Noise adds little: 3 mL over 2 s.

    Args:
        volume: The larger of the two dynamic errors [m^3].
    """
    gain = max(errors.bias() / rig.FLOW_ERROR_AT for errors in rig.FLOW_ERRORS.values())
    return math.sqrt(2) * gain * abs(volume)
