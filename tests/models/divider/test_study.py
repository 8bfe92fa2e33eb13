"""The author's study: whether its ranges are those of the parameters, and hold his base set where he kept to it."""

from divideropt.models.divider import PARAMETERS
from divideropt.models.divider.study import LISTING_NAMES, THESIS_RANGES


def test_every_range_is_a_parameter_s_and_within_its_domain() -> None:
    assert len(THESIS_RANGES) == 10
    for name, (low, high) in THESIS_RANGES.items():
        assert low < high, name
        assert PARAMETERS[name].domain.contains(low), name
        assert PARAMETERS[name].domain.contains(high), name


def test_the_base_set_is_within_every_range() -> None:
    for name, (low, high) in THESIS_RANGES.items():
        assert low <= PARAMETERS[name].default <= high, name


def test_the_sweeps_of_his_code_span_them(reference) -> None:
    rows = reference("listing_sensitivity")
    for column, name in LISTING_NAMES.items():
        values = rows[rows["param"] == column]["value"]
        assert (values.min(), values.max()) == THESIS_RANGES[name], name
