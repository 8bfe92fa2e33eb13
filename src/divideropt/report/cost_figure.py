"""Both fronts in the campaign's problem: its own, and its companion's."""

from collections.abc import Iterator
from itertools import combinations

import numpy as np
import plotly.graph_objects as go

from divideropt.report.cost import Placed
from divideropt.report.data import ReportData
from divideropt.report.display import rounded
from divideropt.report.facts import ObjectiveFacts
from divideropt.report.figures import HOVER, MOST_PROJECTIONS, goal_lines, label, layout, ring
from divideropt.report.palette import COLOURS

BEYOND = 1.5
"""How far the axes go beyond what is feasible, in shares of it: infeasible designs may lie anywhere."""

FRONTS = {
    "robust": ("robust front", COLOURS[0], "circle"),
    "nominal": ("nominal front, feasible", COLOURS[1], "diamond"),
    "broken": ("nominal front, not feasible", COLOURS[3], "x"),
}
"""Words, colour and mark of each, by plotly's names."""


def cost_figures(data: ReportData) -> Iterator[tuple[tuple[int, int], go.Figure]]:
    """Draw both fronts on pairs of objectives: the pair, and its figure."""
    for first, second in list(combinations(range(len(data.objectives)), 2))[:MOST_PROJECTIONS]:
        yield (first, second), _figure(data, data.objectives[first], data.objectives[second])


def kind_of(place: Placed) -> str:
    """The front a design is drawn with, a key of `FRONTS`."""
    return ("nominal" if place.feasible else "broken") if place.nominal else "robust"


def _figure(data: ReportData, first: ObjectiveFacts, second: ObjectiveFacts) -> go.Figure:
    placed = data.cost.placed if data.cost else ()
    figure = go.Figure(layout=layout(height=340, margin={"l": 62, "r": 12, "t": 12, "b": 52}))
    for kind, (words, colour, shape) in FRONTS.items():
        of_kind = [place for place in placed if kind_of(place) == kind]
        x, y = (
            np.array([rounded(facts.axis.scaled(place.objectives[facts.index])) for place in of_kind])
            for facts in (first, second)
        )
        ids = [f"nominal/{place.design_id}" if place.nominal else place.design_id for place in of_kind]
        figure.add_scatter(
            x=x,
            y=y,
            name=words,
            mode="markers",
            marker={"color": colour, "symbol": shape, "size": 7, "opacity": 0.8},
            customdata=np.array(ids, dtype=object),
            hovertemplate=HOVER,
        )
    figure.add_scatter(**ring(13), x=[], y=[])
    figure.update_xaxes(title_text=label(first), range=_range(placed, first))
    figure.update_yaxes(title_text=label(second), range=_range(placed, second))
    figure.update_layout(shapes=list(goal_lines(first, second)))
    return figure


def _range(placed: tuple[Placed, ...], facts: ObjectiveFacts) -> list[float] | None:
    """What an axis shows at first: all feasible designs and the goal, and of the others those nearby."""
    values = [facts.axis.scaled(p.objectives[facts.index]) for p in placed if p.feasible]
    values += [] if facts.goal is None else [facts.axis.scaled(facts.goal)]
    if not values:
        return None
    low, high = min(values), max(values)
    wide = (high - low) or abs(high) or 1.0
    everything = [facts.axis.scaled(p.objectives[facts.index]) for p in placed]
    top = min(max([*everything, high]), low + BEYOND * wide)
    return [low - 0.05 * wide, top + 0.05 * wide]
