"""The pages: statements, trends, contradictions, and how many of them each formulation supports; the cases."""

import platform
from collections import Counter
from collections.abc import Iterator, Sequence
from importlib.metadata import version

from claims import criteria
from claims.author import nearness
from claims.cases_page import cases_page
from claims.contradictions import contradictions
from claims.experiment_section import experiment_section
from claims.findings import findings
from claims.judgement import Answer, Judged, named
from claims.runs import VARIANTS, Runs
from claims.sensitivity_section import author_section, sensitivity_section
from claims.tables import table

COMMAND = "python docs/make_claims.py"
"""What writes the pages."""


CLAIMS, CASES = "claims.md", "claims_cases.md"
"""Names of the two pages."""


def write_pages() -> dict[str, str]:
    """Run everything and return the pages, as Markdown, by name."""
    runs = {str(variant): Runs(variant) for variant in VARIANTS}
    sensitivity: list[Judged] = []
    trends: list[Judged] = []
    section_a = list(sensitivity_section(runs, sensitivity))
    section_b = list(experiment_section(trends))
    author = runs["listing, cold"]
    lines = [
        *_opening(sensitivity, trends),
        *_summary(sensitivity, trends),
        *_words(),
        *section_a,
        *author_section(nearness(author)),
        *section_b,
        *_section_c(contradictions(author.base())),
        *_closing(),
    ]
    return {CLAIMS: "\n".join(lines) + "\n", CASES: "\n".join(cases_page(_closing())) + "\n"}


def _opening(sensitivity: Sequence[Judged], trends: Sequence[Judged]) -> Iterator[str]:
    yield "# The thesis’s claims, judged by our own runs"
    yield ""
    yield (
        "Every statement of section 3.4 and every experimental trend of Chapter 4 of the thesis (Wiens 2004), and "
        "whether each formulation of the model shows it. Every number here comes from runs made when the page was "
        "written, but those quoted from the thesis. The criteria are ours, since the thesis gives none. They were "
        "written down before our runs, though not before we knew the author’s own sweeps (`tests/reference`). Since "
        "the first runs were changed: what counts as flat; the case of 3 N; that "
        f"{named(sensitivity, 'if the pressure drop is too small').label} looks at the smallest drop that is ok. And "
        "since a review of the first page: that it looks at each flow, not at the gap between the two; that "
        f"{named(sensitivity, 'A tighter clearance allows').label} judges the leakage over the lands, not what "
        f"reaches no load; that {trends[-1].label} takes the drops that come out, not those stated; and three "
        "statements more, and a caption and an axis less."
    )
    yield ""


def _summary(sensitivity: Sequence[Judged], trends: Sequence[Judged]) -> Iterator[str]:
    yield "## How many statements each formulation supports"
    yield ""
    yield "Section 3.4, the standard test from the settled start; the last row is the author’s code as he started it:"
    yield ""
    yield from _counts(sensitivity)
    yield ""
    yield "Chapter 4, the prototype in the rig as assumed, over all cases of assumptions:"
    yield ""
    yield from _counts([one for one in trends if one.label.startswith("B")])
    yield ""
    yield "Section 3.2, on the drop whose effect Table 4.1 measures, over the same cases:"
    yield ""
    yield from _counts([one for one in trends if not one.label.startswith("B")])
    yield ""
    yield from findings([*sensitivity, *trends])
    yield (
        "How to read it. The `listing` is the code that drew the thesis’s figures, so that its yes is expected and "
        "its no the surprise. A no of `conservative` beside a yes of the `listing` is a finding that rests on what "
        "the two do differently, the slips above all. A yes to Chapter 4 says that order and direction agree, not "
        "that the model was validated."
    )
    yield ""
    yield (
        "Where the start decides. The author started from an empty valve, let the load step after 0.6 s and read the "
        "final values 0.4 s later, settled or not. That changes the answer of the listing for: "
        f"{', '.join(_moved(sensitivity))}."
    )
    yield ""


def _moved(sensitivity: Sequence[Judged]) -> Iterator[str]:
    for one in sensitivity:
        settled, cold = (one.found[name].answer for name in ("listing", "listing, cold"))
        if settled is not cold:
            yield f"{one.label} ({settled}, cold: {cold})"


def _counts(judged: Sequence[Judged]) -> Iterator[str]:
    rows = []
    for name in judged[0].found:
        count = Counter(one.found[name].answer for one in judged)
        rows.append([name, *(str(count[answer]) for answer in Answer), str(len(judged))])
    yield from table(["", *Answer, "statements"], rows)


def _words() -> Iterator[str]:
    yield "## What the words mean"
    yield ""
    yield (
        f"- *strong*: over its range the parameter moves the quantity by at least {100 * criteria.STRONG:.0f} % of "
        f"the base set’s value; *small*: by at most {100 * criteria.SMALL:.0f} %; between them, in part."
    )
    yield (
        f"- *rises*, *falls*: of the magnitude, throughout, a step back of {100 * criteria.NOISE:.0f} % of the "
        f"curve’s range forgiven; in part if its ends do, or if it does over {100 * criteria.HALF:.0f} % of the "
        f"range; neither if it is flat, all its values within {100 * criteria.FLAT:.0f} % of the largest."
    )
    yield (
        f"- *zero*: an error of at most {criteria.ZERO_ERROR} % of the source flow. A number that the thesis rounds "
        "is met by what rounds to it."
    )
    yield (
        "- Where several things are asked at once, *in part* means that some are shown. Of a curve, designs whose "
        f"outcome is not `ok` are left out and counted; if less than {100 * criteria.ENOUGH:.0f} % are ok, it is not "
        "judged. A single design that is asked for, and designs that are asked whether they are stable, are judged "
        "as they are, with their outcome."
    )
    yield ""


def _section_c(paragraphs: Sequence[str]) -> Iterator[str]:
    yield "## C. What contradicts itself in Chapters 3 and 4 and Appendix E"
    yield ""
    for number, paragraph in enumerate(paragraphs, 1):
        yield f"{number}. {paragraph}"
    yield ""


def _closing() -> Iterator[str]:
    yield "## How this page was made"
    yield ""
    yield f"    {COMMAND}"
    yield ""
    packages = ", ".join(f"{name} {version(name)}" for name in ("divideropt", "numpy", "scipy", "numba"))
    yield (
        f"Written by the code in `docs/claims/`, with {packages} on Python {platform.python_version()}. The same "
        "versions write the same bytes; others may differ in a last digit."
    )
