"""Where Chapters 3 and 4 and Appendix E contradict themselves, with the arithmetic that shows it."""

import math
from collections.abc import Mapping, Sequence

from claims.resolution import steady_bias, steady_step, volume_step
from divideropt.models.divider import rig

FIRST_TEST_ERROR = 1.23
"""Steady-state error of section 4.3 [%]."""


def contradictions(base: Mapping[str, float]) -> list[str]:
    """Return one paragraph each, in the order of the thesis.

    Args:
        base: Every quantity of the base set, of the author's listing as he started it.
    """
    return [*_chapter_3(base), *_first_test(), *_tables(), *_appendix()]


def of_figure_3_1(base: Mapping[str, float]) -> str:
    """Say why Figure 3.1 is not of the printed test; `base` as in `contradictions`."""
    flows = " and ".join(f"{1e6 * base[name]:.0f}×10⁻⁶ m³/s" for name in ("load_flow_1", "load_flow_2"))
    return (
        "**Figure 3.1 is of another test.** Its vertical axis has its last tick at 400×10⁻⁶ m³/s, and section 3.1 "
        "says it shows a source flow of 10⁻³ m³/s with Appendix B’s parameters: the two flows should then add up to "
        f"nearly that, some 500×10⁻⁶ m³/s each, which is above the axis. Ours, by the listing, end at {flows}."
    )


def _chapter_3(base: Mapping[str, float]) -> Sequence[str]:
    return (
        of_figure_3_1(base),
        "**What the pilot flow bypasses.** Section 3.4 (groove width) says that it bypasses “the variable orifice”. "
        "By the thesis’s own equations it goes from the source to the flow chambers, between fixed and variable "
        "orifice: it bypasses the fixed one.",
        "**The fixed orifice’s area.** Section 3.5: “by increasing the fixed orifice area, valve accuracy can be "
        "increased, but at the cost of reduced efficiency”. Sections 3.4 and 4.5 and Table 4.1 say the opposite: a "
        "larger area is a smaller drop, and a larger error.",
    )


def _first_test() -> Sequence[str]:
    flow, second = rig.SOURCE_FLOW, rig.TABLE_4_1[1].steady_error
    return (
        "**The direction of the step.** Section 3.1 raises the load of branch 1; in section 4.3 “the pressure in "
        "branch number 1 dropped”. Yet the measured signs (steady error positive, dynamic error negative) are those "
        "of a rise: see the row on signs above. Exchanged branches, or exchanged signs, would explain it; the thesis "
        "has neither.",
        "**The total flow of section 4.3** is printed as 4.89 m³/s. With 10⁻⁴ it is "
        f"{100 * (1 - 4.89e-4 / flow):.1f} % below the mean of the tables.",
        "**1.23 % twice.** Section 4.3 has this error at 427 kPa and 1640 kPa; Table 4.1 has it at 154 kPa, and 0.87 "
        "% at 430 kPa. The dynamic error of section 4.3 (−0.55 L) is that of the table’s second row (−0.549 L), so "
        f"one of them is a slip, or a single test lay {FIRST_TEST_ERROR - second:.2f} % off the average: section 4.3 "
        "is one response, Table 4.1 “the average of a number of tests”.",
        "**4.99 and 4.96.** The text above Table 4.1 says Qs ≈ 4.99×10⁻⁴ m³/s, the table 4.96×10⁻⁴: "
        f"{100 * (4.99e-4 / flow - 1):.1f} %.",
    )


def _tables() -> Sequence[str]:
    error, volume = _interpolated(534e3)
    second = rig.TABLE_4_2[1]
    steady_off, volume_off = abs(error - second.steady_error), abs(volume - second.dynamic_error)
    return (
        "**A negative error.** Section 3.1 proposes (3.6), a sum of magnitudes, as the error; Table 4.2 has −0.070 "
        "%. Its errors must be (3.5), in which the sign says which branch has more.",
        "**“As low as 0.07%”** (section 4.8) is that −0.070 %: a curve that crosses zero between its rows, read "
        f"with a bias of ±{steady_bias():.1f} %. It says nothing of the valve’s accuracy.",
        "**The tables beside each other.** Read at 534 kPa between its rows (in the logarithm of the drop), Table "
        f"4.1 gives {error:.2f} % and {1e3 * volume:.2f} L; Table 4.2 has {second.steady_error} % and "
        f"{1e3 * second.dynamic_error:.2f} L at nearly the same load difference. The errors differ by "
        f"{steady_off:.2f} %, less than the rig tells apart ({steady_step():.2f} %); the dynamic errors by "
        f"{1e3 * volume_off:.2f} L, more than the meters’ gain explains ({1e3 * volume_step(volume):.2f} L).",
        "**Litres.** See the arithmetic above: more than the valve, its lines and the model have room for.",
    )


def _appendix() -> Sequence[str]:
    first, second = rig.FLOW_ERRORS["QL1"], rig.FLOW_ERRORS["QL2"]
    share = 100 * second.random / rig.FLOW_ERROR_AT
    as_share = 0.108 * rig.FLOW_ERROR_AT
    total = math.hypot(second.bias(), as_share)
    meter = rig.FLOW_CALIBRATIONS["QL1"]
    reading = meter.voltage(rig.FLOW_ERROR_AT)
    spread = meter.exponent * rig.standard_deviation_of_mean(0.02, 600) / reading
    return (
        f"**10.8 %.** E.4.1 gives Q2’s random error as {second.random:.1e} m³/s and 10.8 % of 2.60×10⁻⁴ m³/s. The "
        f"former is {share:.1f} % of it; 10.8 % would be {as_share:.1e} and make the total {total:.1e}, not the "
        f"{rig.FLOW_ERROR_TOTALS['QL2']:.1e} printed.",
        f"**1.7×10⁻⁵.** A standard deviation of 1.1×10⁻⁵ m³/s makes {rig.half_width_90(1.1e-5):.2e} at 90 %, printed "
        f"as {first.random:.1e}: right only if the former is rounded up from below 1.07×10⁻⁵.",
        f"**“Well under 0.1%”.** 600 readings with a deviation of 0.02 V leave {100 * spread:.3f} % of the flow at "
        f"2.60×10⁻⁴ m³/s (one standard deviation; {100 * rig.half_width_90(spread):.2f} % with 90 % confidence): "
        "under, not well under.",
        "**(E.5) divides by N − 1** where a curve with two fitted coefficients leaves N − 2.",
        f"**An offset of {1e-3 * rig.PRESSURE_CALIBRATIONS['Ps'].offset:.0f} kPa** for Ps in Table E.1, though the "
        "amplifiers were zeroed at zero pressure before each record.",
        "**The totals hold.** 2.3×10⁻⁶ m³/s from 0.14 L in 60 s, 1.8 and 2.6×10⁻⁵ m³/s, 120, 21, 24 and 114 kPa "
        "follow from their parts (`tests/models/divider/test_rig.py`).",
    )


def _interpolated(drop: float) -> tuple[float, float]:
    """Read Table 4.1 at a drop [Pa] between its last two rows: error [%] and dynamic error [m^3]."""
    _, low, high = rig.TABLE_4_1
    way = math.log(drop / low.fixed_drop) / math.log(high.fixed_drop / low.fixed_drop)
    error = low.steady_error + way * (high.steady_error - low.steady_error)
    return error, low.dynamic_error + way * (high.dynamic_error - low.dynamic_error)
