"""The report's sections on strategies and on choosing a design."""

import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from browsing import NO_WEBGL, quiet
from divideropt.analysis import Score, knee_points, nondominated
from divideropt.models import Quantity
from divideropt.problem import Objective
from divideropt.report.choosing import choosing_of
from divideropt.report.comparison import quartiles
from divideropt.report.comparison_figure import comparison_figure
from divideropt.report.data import read_report
from divideropt.report.decision_tables import choosing_table, lacking, rank_table, strategies_table
from divideropt.report.page import render_report

TWO = """strategies:
  nsga2: {population: 8, generations: 4, seeds: [1, 2, 3]}
  complex: {evaluations: 24, seeds: [4, 5]}"""
GOALS = "{goal: 0.5}"


@pytest.fixture(name="compared")
def _compared(spheres):
    """A report of two strategies with several seeds."""
    store = spheres(2, goal=GOALS, strategies=TWO)
    return read_report(store)


def cells(table):
    return [[cell.text for cell in row.cells] for row in table.rows]


def test_strategies_are_compared_after_as_many_evaluations(compared):
    assert compared.comparison.evaluations == 24
    table = strategies_table(compared)
    assert [heading.words for heading in table.headings] == ["figure", "nsga2", "complex", "what it is"]
    rows = {row[0]: row[1:3] for row in cells(table)}
    assert rows["runs"] == ["3", "2"]
    values = [s.values["hypervolume"] for s in compared.comparison.scores[:3]]
    assert rows["hypervolume"][0].startswith(f"{np.median(values):.4f} (")
    assert sum(map(int, rows["on the front of all"])) == sum(s.shared for s in compared.comparison.scores)
    tests = cells(rank_table(compared))
    assert [row[0] for row in tests] == ["hypervolume", "IGD+", "ε", "best max λ", "mean gap", "worst gap"]
    text = render_report(compared)
    assert "After 24 evaluations of each run" in text
    assert "corrected for the 6 comparisons" in text


def test_one_run_each_is_compared_without_a_test(data):
    assert cells(strategies_table(data))[0] == ["runs", "1", "1", "seeds"]
    assert rank_table(data).rows == ()
    text = render_report(data)
    assert "Strategies compared" in text
    assert "so there is no rank test: give them more seeds" in text


def test_one_strategy_is_not_compared(spheres):
    text = render_report(read_report(spheres(2)))
    assert "Strategies compared" not in text
    assert "#strategies" not in text


def test_the_candidates_are_of_the_front_and_the_goals_say_what_they_lack(data):
    """The divider's goals are out of reach; the nearest misses them by as much as the page says."""
    names = {design.design_id for design in data.front}
    candidates = data.choosing.candidates
    assert {c.design.design_id for c in candidates} <= names
    assert [reason for c in candidates for reason in c.reasons if "goals" in reason] == ["nearest to the goals"]
    nearest = next(c.design for c in candidates if "nearest to the goals" in c.reasons)
    goals = np.array([facts.goal for facts in data.objectives])
    F = np.array([design.objectives for design in data.front])
    assert max((nearest.objectives - goals) / goals) == pytest.approx(((F - goals) / goals).max(axis=1).min())
    assert data.choosing.lacks == pytest.approx(np.maximum(nearest.objectives - goals, 0.0))
    assert f"the nearest misses {lacking(data)}." in render_report(data)
    assert re.search(r"source pressure by [0-9.]+ MPa", lacking(data))


def test_a_front_that_meets_the_goals_says_how_often(compared):
    F = np.array([design.objectives for design in compared.front])
    assert nondominated(F).all()
    assert compared.choosing.meeting == (F <= 0.5).all(axis=1).sum() > 0
    assert compared.choosing.considered == len(F)
    assert lacking(compared) == ""
    text = render_report(compared)
    assert f"{compared.choosing.meeting} designs meet every goal." in text
    assert "Farthest within the goals" in text
    knees = [c.design.objectives for c in compared.choosing.candidates if c.reasons[0].startswith("knee")]
    assert knees == [tuple(F[row]) for row in knee_points(F)[:5]]
    assert compared.choosing.knees == len(knees)


def test_the_tail_beyond_the_reference_point_does_not_count(compared):
    first, *others = compared.front
    front = (*others, replace(first, design_id="nsga2-1/9", objectives=(0.0, 9.0)))
    objectives = tuple(Objective(Quantity(name, "", "", "", 1.0)) for name in "ab")
    assert choosing_of(front, objectives[:1], None) is None, "one objective leaves no choice"
    found = choosing_of(front, objectives, np.array([3.0, 3.0]))
    assert found.considered == len(others)
    assert not found.goals
    assert not found.wished


def test_without_goals_the_page_speaks_of_none(spheres):
    text = render_report(read_report(spheres(2)))
    assert "Choosing a design" in text
    assert "every goal" not in text[text.index('id="choosing"') : text.index('id="selected"')]
    assert "Best by achievement" not in text


def test_a_candidate_is_selected_by_its_row(compared, opened):
    found = opened(render_report(compared), NO_WEBGL)
    rows = found.page.locator("#choosing-table tbody tr")
    assert rows.count() == len(choosing_table(compared).rows) > 0
    rows.last.click()
    assert compared.choosing.candidates[-1].design.design_id in found.title()
    assert found.page.locator("#strategies table").count() == 2
    quiet(found)


def test_each_run_is_a_point_of_each_panel(compared, opened):
    found = opened(render_report(compared), NO_WEBGL)
    assert found.count("#indicators .cartesianlayer > .subplot") == 6
    assert found.count("#indicators path.point") == 6 * 5
    assert found.count("#indicators path.js-line") == 6 * 2


def test_what_is_infinite_is_not_drawn(compared):
    first, *others = compared.comparison.scores
    worse = replace(first, values={**first.values, "worst_gap": float("inf")})
    figure = comparison_figure(replace(compared.comparison, scores=(worse, *others)))
    drawn = [value for trace in figure.data if trace.mode == "markers" for value in trace.y]
    assert drawn.count(None) == 1
    text = render_report(replace(compared, comparison=replace(compared.comparison, scores=(worse, *others))))
    assert "∞)" in text


@given(st.lists(st.floats(-1e3, 1e3), min_size=1, max_size=9), st.integers(0, 4))
def test_quartiles_are_numpys_and_know_the_infinite(values, infinite):
    values = values + [np.inf] * infinite
    scores = [Score("g", "g-1", 1, 1, {"epsilon": value}) for value in values]
    found = quartiles("epsilon", scores)
    if not infinite:
        assert found == pytest.approx(np.percentile(values, [25, 50, 75]), abs=1e-9)
    ranked = sorted(values)
    for share, value in zip((0.25, 0.5, 0.75), found, strict=True):
        place = share * (len(values) - 1)
        assert np.isinf(value) == np.isinf(ranked[int(np.ceil(place))])
    assert quartiles("epsilon", []) is None


def test_hostile_names_stay_text(compared):
    link = "</td><script>window.hacked=1</script>"
    scores = tuple(replace(score, group=link + score.group) for score in compared.comparison.scores)
    candidates = tuple(replace(c, reasons=(link,)) for c in compared.choosing.candidates)
    text = render_report(
        replace(
            compared,
            comparison=replace(compared.comparison, scores=scores),
            choosing=replace(compared.choosing, candidates=candidates),
        )
    )
    assert "<script>window.hacked" not in text
    assert "&lt;script&gt;window.hacked" in text
