"""The rig's numbers follow from each other as Appendix E says, but where it slips."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from divideropt.models.divider import rig


def printed(value, digits):
    """A number as it would be printed with so many significant digits."""
    return float(f"{value:.{digits - 1}e}")


def test_flow_standard_is_as_printed():
    volume_error = rig.POURED_VOLUME - rig.RECORDED_VOLUME
    assert volume_error == pytest.approx(0.14e-3)
    error = rig.average_flow_error(15.6e-3, rig.CALIBRATION_TIME, volume_error, time_error=0.0)
    assert printed(error, 2) == 2.3e-6
    assert {e.standard for e in rig.FLOW_ERRORS.values()} == {2.3e-6}


@pytest.mark.parametrize("name", rig.FLOW_ERRORS)
def test_flow_totals_are_as_printed(name):
    assert printed(rig.FLOW_ERRORS[name].total(), 2) == rig.FLOW_ERROR_TOTALS[name]


@pytest.mark.parametrize("name", rig.PRESSURE_ERRORS)
def test_pressure_totals_are_as_printed(name):
    assert round(rig.PRESSURE_ERRORS[name].total(), -3) == rig.PRESSURE_ERROR_TOTALS[name]


def test_deadweight_tester_is_a_thousandth():
    assert {e.standard for e in rig.PRESSURE_ERRORS.values()} == {printed(0.001 * rig.PRESSURE_ERROR_AT, 2)}


def test_random_error_of_the_second_flow_is_not_the_share_printed():
    first, second = (100 * rig.FLOW_ERRORS[name].random / rig.FLOW_ERROR_AT for name in ("QL1", "QL2"))
    assert round(first, 1) == 6.5
    assert round(second, 1) == 9.2  # E.4.1 prints 10.8
    with_share = math.hypot(rig.FLOW_ERRORS["QL2"].bias(), 0.108 * rig.FLOW_ERROR_AT)
    assert printed(with_share, 2) != rig.FLOW_ERROR_TOTALS["QL2"]


def test_random_error_of_the_first_flow_is_so_within_rounding():
    assert printed(rig.half_width_90(1.1e-5), 2) == 1.8e-5  # E.4.1 prints 1.7e-5
    assert printed(rig.half_width_90(1.05e-5), 2) == 1.7e-5  # which a deviation printed as 1.1e-5 allows


def test_mean_of_600_readings_is_within_a_thousandth():
    meter = rig.FLOW_CALIBRATIONS["QL1"]
    deviation = rig.standard_deviation_of_mean(0.02, 600)
    voltage = meter.voltage(rig.FLOW_ERROR_AT)
    assert meter.flow(voltage + deviation) / rig.FLOW_ERROR_AT - 1 < 1e-3


def test_calibration_curves():
    assert rig.PRESSURE_CALIBRATIONS["Pa1"].pressure(2.0) == pytest.approx(3.50233e6)
    assert rig.FLOW_CALIBRATIONS["QL2"].flow(1.0) == 3.06e-4
    assert rig.FLOW_CALIBRATIONS["QL2"].flow(0.0) == 0.0


@given(st.floats(1e-6, 1e-3))
def test_flow_meter_inverts(flow):
    for meter in rig.FLOW_CALIBRATIONS.values():
        assert meter.flow(meter.voltage(flow)) == pytest.approx(flow, rel=1e-12)


def test_average_flow_error_bounds_the_worst_case():
    volume, time, volume_error, time_error = 15.6e-3, 60.0, 1e-7, 1e-3
    flow = rig.average_flow(volume, time)
    worst = rig.average_flow(volume + volume_error, time - time_error) - flow
    assert rig.average_flow_error(volume, time, volume_error, time_error) == pytest.approx(worst, rel=1e-4)


def test_deviation_from_a_curve_with_equal_weights_is_the_sample_deviation():
    measured = np.array([1.0, 2.5, 2.8, 4.4, 4.9])
    fitted = np.full(5, measured.mean())
    found = rig.deviation_from_curve(measured, fitted, np.full(5, 0.3))
    assert found == pytest.approx(np.std(measured, ddof=1), rel=1e-14)


def test_deviation_from_a_curve_heeds_the_weights():
    off = rig.deviation_from_curve(np.array([1.0, 5.0]), np.array([0.0, 5.0]), np.array([1e6, 1.0]))
    assert off == pytest.approx(math.sqrt(2) * 1e-6, rel=1e-6)


def test_averaging_reduces_the_random_part_alone():
    errors = rig.FLOW_ERRORS["QL1"]
    assert errors.total(10**12) == pytest.approx(errors.bias(), rel=1e-6)
    assert errors.total(100) == pytest.approx(math.hypot(errors.bias(), errors.random / 10))


def test_tables_hold_one_thing_and_change_the_other():
    assert {row.load_difference for row in rig.TABLE_4_1} == {1.63e6}
    assert {row.fixed_drop for row in rig.TABLE_4_2} == {534e3}
    assert [row.steady_error for row in rig.TABLE_4_1] == [1.23, 0.87, 0.73]
    assert [row.dynamic_error for row in rig.TABLE_4_2] == [-0.348e-3, -0.430e-3, -0.425e-3]
