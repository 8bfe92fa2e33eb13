import math
import subprocess
import sys

import pytest
from hypothesis import given
from hypothesis import strategies as st

from divideropt import units
from divideropt.units import LARGEST, LEAST, format_measure, parse_measure, parse_number

# The right-hand sides are the definitions of the units; each must come out as the nearest float.
EXACT = [
    ("6 mm", "m", 0.006),
    ("6mm", "m", 0.006),
    ("  6  mm ", "m", 0.006),
    ("3 um", "m", 3e-6),
    ("3 \N{MICRO SIGN}m", "m", 3e-6),
    ("3 \N{GREEK SMALL LETTER MU}m", "m", 3e-6),
    ("1e-3 m^3/s", "m^3/s", 1e-3),
    ("0.5 mL", "m^3", 5e-7),
    ("60 l/min", "m^3/s", 1e-3),
    ("18 MPa", "Pa", 18e6),
    ("200 bar", "Pa", 2e7),
    ("0.5 %", "%", 0.5),
    ("50 ms", "s", 0.05),
    ("0 1/s", "1/s", 0.0),
    ("2 1/min", "1/s", 2 / 60),
    ("900 kg/m^3", "kg/m^3", 900.0),
    ("0.9 g/cm^3", "kg/m^3", 900.0),
    ("30 mm^2/s", "m^2/s", 30e-6),
    ("-2.5e1 N", "N", -25.0),
    ("+.5 m", "m", 0.5),
    ("5. m", "m", 5.0),
    ("0.886", "", 0.886),
    ("50 %", "", 0.5),
]


@pytest.mark.parametrize(("text", "unit", "value"), EXACT)
def test_reads_a_measure_to_the_nearest_float(text: str, unit: str, value: float) -> None:
    assert parse_measure(text, unit) == value


def test_reads_degrees_as_an_angle() -> None:
    assert parse_measure("90 deg", "rad") == pytest.approx(math.pi / 2, rel=1e-15)


@pytest.mark.parametrize("value", [3, 0.25, "0.25", " 3e2 "])
def test_a_bare_number_is_right_where_there_is_no_dimension(value: object) -> None:
    assert parse_measure(value, "") == float(value)  # type: ignore[arg-type]


@pytest.mark.parametrize("value", [6, 6.0, "6", 0, "0"])
@pytest.mark.parametrize("unit", ["m", "Pa", "%", "1/s"])
def test_a_bare_number_is_wrong_where_a_dimension_is_due(value: object, unit: str) -> None:
    with pytest.raises(ValueError, match=f"has no unit; write {float(value):g} {unit}"):  # type: ignore[arg-type]
        parse_measure(value, unit)


@pytest.mark.parametrize(
    "value", [True, None, [1], {"a": 1}, b"1 m", 1j, "", "m", "6 mm mm", "1,5 mm", "6 m m", "six mm"]
)
def test_what_is_no_measure_is_refused(value: object) -> None:
    with pytest.raises(ValueError, match="is not a number with a unit, such as 1 m"):
        parse_measure(value, "m")


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, "1e999"])
def test_only_finite_numbers_pass(value: object) -> None:
    with pytest.raises(ValueError, match="is not a finite number"):
        parse_measure(value, "")


@pytest.mark.parametrize("value", ["1e999 m", "1e999 mm", "1e305 Tm"])
def test_an_overflow_is_not_finite(value: str) -> None:
    with pytest.raises(ValueError, match="is not a finite number"):
        parse_measure(value, "m")


@pytest.mark.parametrize(
    ("value", "reason"),
    [
        ("3 furlongz", "'furlongz' is not known; here a number with a unit, such as 1 m"),
        ("3 s", "'s' is of another kind; here a number with a unit, such as 1 m"),
        ("3 %", "'%' is of another kind"),
        ("3 m^2", "'m^2' is of another kind"),
    ],
)
def test_an_error_names_the_unit_and_says_what_would_be_right(value: str, reason: str) -> None:
    with pytest.raises(ValueError) as caught:
        parse_measure(value, "m")
    assert reason in str(caught.value)


@pytest.mark.parametrize(
    "value",
    [
        "6^800000 m",  # pint would work it out
        "6 m^800000",
        "6 m**9",
        "2 m + 3 m",
        "(2) m",
        "1 __import__",
        "1 m;m",
        "1 m**9999999",
        "1 m^10",
        "1 " + "(" * 30 + "m" + ")" * 30,
        "\N{ARABIC-INDIC DIGIT ONE} m",
        "1_0e-3 m",
        "1 m\N{SUPERSCRIPT TWO}",
        "1 {m}",
        "1 m.to(s)",
        "1e1000 m",
        "1 \0m",
        "1 m*2",
        "1 " + "m*" * 6 + "m",
        "1" * 100 + " m",
        "1 " + "m" * 100,
    ],
)
def test_nothing_but_a_number_and_a_unit_reaches_pint(value: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def reached(*_: object) -> None:
        raise AssertionError("pint was asked")

    monkeypatch.setattr("divideropt.units._factor", reached)
    with pytest.raises(ValueError, match="is not a number with a unit"):
        parse_measure(value, "m")


@pytest.mark.parametrize("value", [1e50, -1e50, 1e-50, "0.01e52 m", "1e-47 mm", 0.0, "0 m"])
def test_the_largest_and_the_least_magnitude_pass(value: object) -> None:
    unit = "m" if isinstance(value, str) else ""
    assert abs(parse_measure(value, unit)) in (0.0, 1e-50, 1e50)


@pytest.mark.parametrize(
    ("value", "words"),
    [
        ("1.7e308 m", "1.7e+308 m is too large to be computed with; the largest magnitude is 1e+50 m"),
        ("-1e51 m", "-1e+51 m is too large"),
        ("1e48 km", "1e+51 m is too large"),
        ("1e-310 m", "1e-310 m is too small to be computed with; the least magnitude is 1e-50 m, or 0"),
        ("-1e-48 mm", "-1e-51 m is too small"),
    ],
)
def test_what_sums_and_squares_would_lose_is_refused(value: str, words: str) -> None:
    with pytest.raises(ValueError) as caught:
        parse_measure(value, "m")
    assert str(caught.value).startswith(words)
    assert str(caught.value).endswith("check the exponent and the unit")


def test_a_plain_number_may_be_small_but_not_too_large() -> None:
    assert parse_number("1e-310") == 1e-310
    with pytest.raises(ValueError, match="1e\\+60 is too large"):
        parse_number("1e60")


MAGNITUDE = st.floats(min_value=LEAST, max_value=LARGEST)


@given(
    st.one_of(st.just(0.0), MAGNITUDE, MAGNITUDE.map(lambda value: -value)),
    st.sampled_from(["m", "Pa", "%", "", "1/s", "m^3/s", "m^3", "kg/m^3", "s"]),
)
def test_a_written_measure_reads_back_as_the_same_bits(value: float, unit: str) -> None:
    again = parse_measure(format_measure(value, unit), unit)
    assert again == value
    assert math.copysign(1.0, again) == math.copysign(1.0, value)


def test_a_measure_without_dimension_is_written_bare() -> None:
    assert format_measure(0.25, "") == "0.25"
    assert format_measure(0.006, "m") == "0.006 m"


@given(
    st.text(alphabet="0123456789.e+-mkPsaµ%/^* 1dBCKrg", max_size=12),
    st.sampled_from(["m", "Pa", "%", "", "1/s"]),
)
def test_any_text_is_a_finite_number_or_a_value_error(text: str, unit: str) -> None:
    try:
        value = parse_measure(text, unit)
    except ValueError as error:
        assert str(error)
    else:
        assert math.isfinite(value)


@pytest.mark.parametrize("text", ["1 dB", "20 Np", "1 dBm^2", "1 dBm", "1 1/dBW", "1 degC"])
@pytest.mark.parametrize("unit", ["", "m", "1/s"])
def test_a_logarithmic_or_offset_unit_is_a_value_error(text: str, unit: str) -> None:
    with pytest.raises(ValueError, match="of another kind; here a number"):
        parse_measure(text, unit)


PRODUCTS = [
    "m^3/s",
    "mL/ms",
    "1/s",
    "kg/m^3",
    "g/cm^3",
    "mm^2/s",
    "N/m",
    "N*s/m",
    "1/ms^2",
    "m^-1*bar",
    "L/min",
    "1/min",
    "mL*min^-2",
]


@pytest.mark.parametrize("wanted", ["m", "Pa", "m^3", "m^3/s", "1/s", "kg", "kg/m^3", "m^2/s", "s", "N", "%", ""])
def test_what_needs_no_pint_is_what_pint_says(wanted: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def factors() -> dict[str, object]:
        units._factor.cache_clear()
        return {given: factor_or_none(given, wanted) for given in [*units._KNOWN, *PRODUCTS]}

    ours = factors()
    monkeypatch.setattr(units, "_ten", lambda unit: None)
    assert factors() == ours
    assert any(ours.values())


def factor_or_none(given: str, wanted: str) -> object:
    try:
        return units._factor(given, wanted)
    except ValueError:
        return None


def test_the_usual_units_need_no_pint() -> None:
    code = (
        "import sys; from divideropt.units import parse_measure as p; "
        "p('3 um', 'm'); p('1 mL', 'm^3'); assert 'pint' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
