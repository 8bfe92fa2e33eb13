"""The report's tables of strategies compared and of designs to choose."""

from collections.abc import Sequence

from divideropt.analysis import INDICATORS, effect_size
from divideropt.report.comparison import p_text, quartile_text
from divideropt.report.data import ReportData
from divideropt.report.tables import Cell, Heading, Row, Table


def choosing_table(data: ReportData) -> Table:
    """List the designs worth a look: why, objectives, pseudo-weights."""
    if data.choosing is None:
        return Table((), ())
    axes = [facts.axis for facts in data.objectives]
    headings = [Heading("design", numeric=False), Heading("why", numeric=False)]
    headings += [
        Heading(axis.words, " ".join(part for part in (axis.symbol, axis.bracket) if part), axis.description)
        for axis in axes
    ]
    headings.append(Heading("pseudo-weights", "in the same order"))
    told = any(candidate.design.valid is not None for candidate in data.choosing.candidates)
    headings += [Heading("within", "validity", numeric=False)] if told else []
    rows = []
    for candidate in data.choosing.candidates:
        design = candidate.design
        cells = [Cell(design.design_id), Cell(", ".join(candidate.reasons))]
        met = zip(axes, design.objectives, design.met, strict=True)
        cells += [Cell(axis.text(value), met=goal) for axis, value, goal in met]
        cells.append(Cell(" ".join(f"{weight:.2f}" for weight in candidate.weights)))
        cells += [Cell({True: "yes", False: "no", None: "–"}[design.valid])] if told else []
        rows.append(Row(design.design_id, tuple(cells)))
    return Table(tuple(headings), tuple(rows))


def lacking(data: ReportData) -> str:
    """Say what the design nearest to the goals lacks of each; "" where nothing."""
    if data.choosing is None:
        return ""
    lacks = zip((facts.axis for facts in data.objectives), data.choosing.lacks, strict=True)
    return ", ".join(f"{axis.words} by {axis.text(lack)} {axis.shown.unit}".rstrip() for axis, lack in lacks if lack)


def strategies_table(data: ReportData) -> Table:
    """List what the runs of each strategy reached, a row a figure; empty where nothing is compared."""
    comparison = data.comparison
    if comparison is None:
        return Table((), ())
    groups = comparison.groups
    headings = (
        Heading("figure", numeric=False),
        *(Heading(name) for name in groups),
        Heading("what it is", numeric=False),
    )
    rows = [_figure("runs", [str(len(scores)) for scores in groups.values()], "seeds")]
    for name, indicator in INDICATORS.items():
        if any(score.values[name] is not None for score in comparison.scores):
            reached = [quartile_text(name, scores) for scores in groups.values()]
            rows.append(_figure(indicator.title, reached, indicator.meaning))
    shares = [str(sum(score.shared for score in scores)) for scores in groups.values()]
    rows.append(_figure("on the front of all", shares, "designs, after as many evaluations"))
    return Table(headings, tuple(rows))


def rank_table(data: ReportData) -> Table:
    """List the tests that could be made; empty where none could."""
    headings = (
        Heading("figure", numeric=False),
        Heading("strategy", numeric=False),
        Heading("against", numeric=False),
        Heading("better in"),
        Heading("effect", numeric=False),
        Heading("p"),
        Heading("p corrected"),
    )
    rows = []
    for tests in data.comparison.tests if data.comparison else ():
        for pair, corrected in zip(tests.pairs, tests.corrected, strict=True):
            if pair.effect is not None:
                words = [INDICATORS[tests.indicator].title, pair.first, pair.second, f"{100 * pair.effect:.0f} %"]
                words += [effect_size(pair.effect), p_text(pair.p), p_text(corrected)]
                rows.append(Row("", tuple(Cell(word) for word in words)))
    return Table(headings, tuple(rows))


def _figure(title: str, values: Sequence[str], meaning: str) -> Row:
    return Row("", tuple(Cell(text) for text in (title, *values, meaning)))
