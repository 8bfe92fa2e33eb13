"""Designs under each scenario: read from the tables, tabulated, and drawn in the page."""

from dataclasses import replace

import numpy as np
import pyarrow as pa
import pytest

from browsing import NO_WEBGL, quiet
from divideropt.campaign.load import stored_campaign
from divideropt.campaign.plan import build_problem
from divideropt.models import Outcome
from divideropt.report.data import read_report
from divideropt.report.page import render_report
from divideropt.report.scenario_tables import scenario_tables
from divideropt.report.scenarios import read_scenarios, worth_a_table
from divideropt.store import TableSchema

OILS = """
name: oils
model:
  kind: divider
  set: {radial_clearance: 3 um}
  scenarios:
    cold_oil: {set: {kinematic_viscosity: 66 mm^2/s}}
    turned: {spool_position: 0.4, events: [{load: 2, to: 12 MPa}, {load: 1, to: 12 MPa, at: 1 s}]}
variables:
  spool_radius: [10 mm, 16 mm]
  total_pressure_drop: [6 MPa, 10 MPa]
objectives:
  steady_state_error: {goal: 0.5 %, worst_of: all}
  turned.event_1.settling_time: {goal: 0.1 s}
constraints: {stability_margin: {min: 0 1/s, worst_of: all}}
strategies: {nsga2: {population: 12, generations: 2, seeds: [1]}}
verification: {sample: 0}
optimality: {points: 0}
parallel: {backend: sequential}
"""


@pytest.fixture(scope="module")
def oils(run_campaign, tmp_path_factory):
    return run_campaign(OILS, tmp_path_factory.mktemp("oils") / "oils")


@pytest.fixture(scope="module")
def problem(oils):
    return build_problem(stored_campaign(oils))


@pytest.fixture(scope="module")
def front(oils, problem) -> pa.Table:
    return oils.read_front("combined", TableSchema.of(problem))


@pytest.fixture(scope="module")
def report_data(oils):
    return read_report(oils)


def test_the_best_designs_are_shown_with_what_the_table_holds(report_data, front) -> None:
    under = report_data.scenarios
    assert under.scenarios == ("scenario", "cold_oil", "turned")
    assert under.designs[0].design_id == report_data.front[0].design_id
    assert under.designs[0].label.startswith("best by max λ")
    shown = ", ".join(design.label for design in under.designs)
    assert "least worst steady state error" in shown
    assert "least turned event 1 settling time" in shown
    for design in under.designs:
        row = front.filter(pa.array([name == design.design_id for name in front["design_id"].to_pylist()]))
        rows = {r.quantity.name: r for r in design.rows}
        assert list(rows)[:2] == ["steady_state_error", "event_1.settling_time"]
        expected = [
            row[name][0].as_py() for name in ("dynamic_error", "cold_oil.dynamic_error", "turned.dynamic_error")
        ]
        assert list(rows["dynamic_error"].values) == expected
        assert rows["dynamic_error"].worst == int(np.argmax(np.abs(expected)))
        margins = rows["stability_margin"]
        assert margins.values[margins.worst] == min(margins.values) == row["least.stability_margin"][0].as_py()
        errors = rows["steady_state_error"]
        assert abs(errors.values[errors.worst]) == abs(row["worst.steady_state_error"][0].as_py())
        assert np.isnan(rows["event_1.settling_time"].values[:2]).all()  # they have one event only
        assert rows["event_1.settling_time"].values[2] == row["turned.event_1.settling_time"][0].as_py()
        assert design.outcomes == (Outcome.OK,) * 3


def test_tables_mark_the_worst_and_say_units(report_data) -> None:
    words = dict(report_data.setting)
    assert words["Scenario cold_oil"].endswith("with kinematic viscosity 66 mm²/s")
    tables = scenario_tables(report_data.scenarios, words)
    for shown, design in zip(tables, report_data.scenarios.designs, strict=True):
        assert (shown.label, shown.design_id) == (design.label, design.design_id)
        headings = [heading.words for heading in shown.table.headings]
        assert headings == ["quantity", "worst", "scenario", "cold oil", "turned"]
        assert shown.table.headings[3].title == words["Scenario cold_oil"]
        cells = {row.cells[0].text: row.cells for row in shown.table.rows}
        settling = cells["settling time [ms]"]
        (worst,) = [cell for cell in settling if cell.worst]
        assert settling[1].text == worst.text
        assert [cell.text for cell in cells["outcome"][1:]] == ["ok"] * 4
        assert [cell.text for cell in cells["event 1.settling time [ms]"][2:4]] == ["–", "–"]


def test_one_scenario_needs_no_table(data, store) -> None:
    plain = build_problem(stored_campaign(store))
    assert data.scenarios is None
    assert read_scenarios(plain, pa.table({"design_id": ["a"]}), [("best", "a")]) is None
    assert scenario_tables(None, {}) == ()
    assert 'id="scenarios"' not in render_report(data)


def test_any_evaluations_can_be_tabulated(problem) -> None:
    """Those of a companion front, say, some of which fail where they were not optimised."""
    schema = TableSchema.of(problem)
    designs = np.array([[16e-3, 9e6], [10e-3, 6e6]])
    evaluations = problem.simulate(designs)
    failed = replace(evaluations.verdicts[1], outcome=Outcome.UNSETTLED, text="in scenario cold_oil: not yet")
    evaluations = replace(evaluations, verdicts=[evaluations.verdicts[0], failed])
    table = schema.result_rows(["plain-1/0", "plain-1/1"], ["plain-1"] * 2, evaluations)
    under = read_scenarios(problem, table, [("one", "plain-1/1"), ("lost", "plain-1/7"), ("other", "plain-1/0")])
    assert [(design.label, design.design_id) for design in under.designs] == [
        ("one", "plain-1/1"),
        ("other", "plain-1/0"),
    ]
    assert under.designs[0].outcomes == (Outcome.OK, Outcome.UNSETTLED, None)
    last = scenario_tables(under, {})[0].table.rows[-1]
    assert [cell.text for cell in last.cells] == ["outcome", "unsettled", "ok", "unsettled", "not known"]
    assert worth_a_table((), problem) == []


def test_the_page_has_a_table_a_design_that_scrolls(opened, report_data) -> None:
    page = opened(render_report(report_data), NO_WEBGL)
    count = len(report_data.scenarios.designs)
    assert page.count("#scenarios table") == count
    assert page.count("#scenarios td.worst") >= 6 * count
    pinned = page.page.eval_on_selector("#scenarios td", "cell => getComputedStyle(cell).position")
    assert pinned == "sticky"
    assert page.count("nav a[href='#scenarios']") == 1
    quiet(page)
