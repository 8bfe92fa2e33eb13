"""The table of a report's first screen: what was wanted, what came out."""

from divideropt.report.display import number, share
from divideropt.report.headline import Aim, Headline
from divideropt.report.tables import Cell, Heading, Row, Table


def goals_table(headline: Headline) -> Table:
    """List the objectives: how far the front goes, the goal, what the best design reaches, who meets the goal."""
    headings = [Heading("objective", numeric=False), Heading("on the front", title="its least and greatest value")]
    if headline.goals:
        headings.append(Heading("goal"))
    if headline.best is not None:
        headings += [Heading("best design"), Heading("goal missed by", title="and as a share of the goal")]
    if headline.goals:
        headings.append(Heading("met on the front", title="designs of the front that meet the goal"))
    return Table(tuple(headings), tuple(_row(aim, headline) for aim in headline.aims))


def _row(aim: Aim, headline: Headline) -> Row:
    facts, axis = aim.facts, aim.facts.axis
    words = axis.words + (f" {axis.symbol}" if axis.symbol else "")
    cells = [Cell(words), Cell(f"{axis.text(aim.least)} to {axis.text(aim.greatest)} {axis.shown.unit}".rstrip())]
    if headline.goals:
        cells.append(Cell("–" if facts.goal is None else axis.bound(facts.goal)))
    if headline.best is not None and aim.reached is not None:
        cells.append(Cell(f"{axis.text(aim.reached)} {axis.shown.unit}".rstrip(), met=aim.met))
        cells.append(Cell(_lack(aim)))
    if headline.goals:
        cells.append(Cell("–" if aim.meeting is None else f"{aim.meeting} ({share(aim.meeting, headline.designs)})"))
    return Row("", tuple(cells))


def _lack(aim: Aim) -> str:
    goal, axis = aim.facts.goal, aim.facts.axis
    if goal is None or aim.met:
        return "–"
    return (
        f"{number(axis.scaled(aim.lack), 3)} {axis.shown.unit}".rstrip() + f" ({number(100 * aim.lack / goal, 2)} %)"
    )
