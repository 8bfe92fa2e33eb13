"""What stands out of the page, in short: the answers and numbers found, none written by hand."""

from collections.abc import Iterator, Sequence

from claims.judgement import Judged, named
from claims.trends import assumed, drop_exponent
from divideropt.models.divider import FORMULATIONS, rig

KWANS_RULE = "The error is inversely proportional to the drop"
"""The finding that has a measured number beside it."""

MAIN: tuple[tuple[str, tuple[str, ...]], ...] = (
    ("A tight clearance buys accuracy", ("it too would have a significant effect", "which translates into a lower")),
    ("The two errors cancel at a drop ratio of 0.95", ("cancel each other out at a ratio",)),
    ("The rim does not show in the dynamic response", ("not especially noticeable in the dynamic",)),
    ("The remaining parameters matter little", ("All the remaining parameters",)),
    (KWANS_RULE, ("For a typical divider valve",)),
    ("The signs of the measured errors", ("(signs:",)),
)
"""What the thesis says in short, and how the statements begin that say it."""


def findings(judged: Sequence[Judged]) -> Iterator[str]:
    """Return the lines of the paragraph.

    Args:
        judged: Every statement and trend.
    """
    names = ", ".join(f"`{name}`" for name in FORMULATIONS)
    yield (
        f"The main findings, with the answers of {names}; the numbers are those of `conservative`, and of "
        "`listing` where its answer differs:"
    )
    yield ""
    for title, beginnings in MAIN:
        parts = (_part(named(judged, beginning)) for beginning in beginnings)
        yield f"- *{title}.* {'; '.join(parts)}.{' ' + _power() if title == KWANS_RULE else ''}"
    yield f"- *Litres.* {_litres()}"
    yield ""


def _part(one: Judged) -> str:
    answers = "/".join(str(one.found[name].answer) for name in FORMULATIONS)
    first, last = one.found["conservative"], one.found["listing"]
    figures = first.figures if first.answer is last.answer else f"{first.figures}; `listing`: {last.figures}"
    return f"{one.label} **{answers}** ({figures})"


def _power() -> str:
    power = drop_exponent([row.steady_error for row in rig.TABLE_4_1], [row.fixed_drop for row in rig.TABLE_4_1])
    return f"Measured, it goes with the stated drop to the power {power:.2f}."


def _litres() -> str:
    pairs = list(zip(rig.TABLE_4_1, assumed("conservative").drops, strict=True))
    ratios = [abs(row.dynamic_error / point.dynamic) for row, point in pairs]
    return (
        f"The dynamic errors measured in Table 4.1 are {min(ratios):.0f} to {max(ratios):.0f} times those of "
        "`conservative` as assumed, and are not explained."
    )
