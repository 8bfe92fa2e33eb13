"""The second page: the numbers of every case of assumptions, too long for the first."""

from collections.abc import Iterator, Sequence

from claims.experiment import CASES
from claims.tables import table
from claims.trends import realised_exponent, run_tests
from divideropt.models.divider import FORMULATIONS, rig


def cases_page(closing: Iterator[str]) -> Iterator[str]:
    """Return the lines of the page.

    Args:
        closing: Its last lines, on how it was made.
    """
    yield "# The tests of Chapter 4 in the model, case by case"
    yield ""
    yield (
        "What [the page of claims](claims.md#b-chapter-4-the-experiment) judges its trends by: the prototype in the "
        f"rig under {len(CASES)} sets of assumptions, the first and each of its assumptions changed by itself. "
        "Signed errors (3.5) and dynamic errors (3.10), in millilitres, at the three rows of each table, and the "
        "power of the realised drop with which the error goes over Table 4.1. Measured: "
        f"{_measured(rig.TABLE_4_1)} (Table 4.1), {_measured(rig.TABLE_4_2)} (Table 4.2)."
    )
    yield ""
    for name in FORMULATIONS:
        yield f"## `{name}`"
        yield ""
        yield from _table_of(name)
        yield ""
    yield from closing


def _table_of(formulation: str) -> Iterator[str]:
    rows = []
    for case in CASES:
        tests = run_tests(formulation, case)
        bad = sorted({p.outcome.value for p in (*tests.drops, *tests.loads)} - {"ok"})
        cells = [
            cell
            for points in (tests.drops, tests.loads)
            for cell in (
                ", ".join(f"{p.error:.2f}" for p in points),
                ", ".join(f"{1e6 * p.dynamic:.2f}" for p in points),
            )
        ]
        name = case.name + (f" ({', '.join(bad)})" if bad else "")
        drops = ", ".join(f"{1e-3 * p.drop:.0f}" for p in tests.drops)
        rows.append([name, *cells, drops, f"{realised_exponent(tests):.2f}"])
    header = ["", "Table 4.1: error [%]", "dynamic [mL]", "Table 4.2: error [%]", "dynamic [mL]"]
    yield from table([*header, "Table 4.1: drop realised [kPa]", "power"], rows)


def _measured(rows: Sequence[rig.MeasuredRow]) -> str:
    errors = ", ".join(f"{row.steady_error:g}" for row in rows)
    volumes = ", ".join(f"{1e6 * row.dynamic_error:.0f}" for row in rows)
    return f"{errors} % and {volumes} mL"
