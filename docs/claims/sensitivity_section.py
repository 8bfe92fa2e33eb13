"""Section A of the page: every statement of section 3.4, judged by sweeps."""

from collections.abc import Iterable, Iterator, Mapping

from claims.author import Nearness
from claims.drops import RATIO, TOTAL
from claims.grooves import CLEARANCE, WIDTH
from claims.judgement import Chapter, Judged, Statement
from claims.opening import OPENING, RIM
from claims.radius import CHAPTER as RADIUS
from claims.runs import RTOL, Runs
from claims.tables import table
from claims.unknowns import FRICTION, REMAINING, VISCOSITY, remaining_effects
from divideropt.models.divider import FORMULATIONS

CHAPTERS: tuple[Chapter, ...] = (
    RADIUS,
    WIDTH,
    CLEARANCE,
    TOTAL,
    RATIO,
    OPENING,
    RIM,
    FRICTION,
    VISCOSITY,
    REMAINING,
)
"""Section 3.4, in its order."""


def sensitivity_section(runs: Mapping[str, Runs], judged: list[Judged]) -> Iterator[str]:
    """Return the lines of the section, and note what was found of each statement.

    Args:
        runs: Of each variant, by name.
        judged: Gets every statement that counts.
    """
    yield "## A. Section 3.4: the sensitivity study"
    yield ""
    yield (
        "Base set: Appendix B.1. Test: section 3.1, load 1 from 10 to 15 MPa at 10⁻³ m³/s. Ranges and number of "
        f"points are those of `changeall.m` (C.2). Solver: LSODA at a relative tolerance of {RTOL:g}."
    )
    yield ""
    for chapter in CHAPTERS:
        yield f"### {chapter.title}"
        yield ""
        yield f"{chapter.sweep}."
        yield ""
        for statement in chapter.statements:
            yield from _statement(statement, runs, judged)
        if chapter is REMAINING:
            yield from _remaining_table(runs)
        if chapter.note is not None:
            yield chapter.note()
            yield ""


def _statement(statement: Statement, runs: Mapping[str, Runs], judged: list[Judged]) -> Iterator[str]:
    found = {name: statement.judged(run) for name, run in runs.items()}
    if statement.counted:
        label = f"A{len(judged) + 1}"
        judged.append(Judged(label, statement.quotation, found))
        yield f"**{label}.** “{statement.quotation}” ({statement.place})  "
        cells = [[name, str(judgement)] for name, judgement in found.items()]
    else:
        yield f"Beside it: {statement.quotation} ({statement.place})  "
        cells = [[name, f"{judgement.answer}: {judgement.figures}"] for name, judgement in found.items()]
    yield f"*{statement.criterion}*"
    yield ""
    if statement.judge is not None:
        yield from table(["", "answer"], cells)
        yield ""


def _remaining_table(runs: Mapping[str, Runs]) -> Iterator[str]:
    effects = {
        name: {parameter: (quantity, effect) for parameter, quantity, effect in remaining_effects(runs[name])}
        for name in FORMULATIONS
    }
    yield "What each moves most, and by how much of the base set’s value:"
    yield ""
    rows = []
    for parameter in effects["conservative"]:
        cells = [effects[name][parameter] for name in FORMULATIONS]
        rows.append([f"`{parameter}`", *(f"{quantity} {100 * effect:.0f} %" for quantity, effect in cells)])
    yield from table(["", *FORMULATIONS], rows)
    yield ""


def author_section(found: Iterable[Nearness]) -> Iterator[str]:
    """Return the lines on how near our listing comes to the author's."""
    yield "### How near our `listing` comes to the author’s own code"
    yield ""
    yield (
        "His code, run in GNU Octave, swept six of the ten parameters (`tests/reference/listing_sensitivity.csv`). "
        "Ours with the same start, differences over the largest magnitude of the sweep, median and largest. He took "
        "settling time and dynamic error from 2000 samples of the time, which is all of the difference there that we "
        "know of."
    )
    yield ""
    names = ("flow_difference", "source_pressure", "dynamic_error", "settling_time")
    rows = [
        [
            f"`{n.parameter}`",
            f"{n.compared} of {n.designs}",
            *(f"{n.off[q][0]:.0e}, {n.off[q][1]:.0e}" for q in names),
        ]
        for n in found
    ]
    yield from table(["", "compared", *(name.replace("_", " ") for name in names)], rows)
    yield ""
