"""The section on what robustness costs: its numbers against the tables on disk, its figures in a browser."""

import shutil
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from browsing import NO_WEBGL, quiet
from divideropt.analysis import hypervolume
from divideropt.campaign.companion import run_campaign
from divideropt.campaign.load import parse_campaign
from divideropt.models.divider import QUANTITIES
from divideropt.report import write_report
from divideropt.report.cost_tables import bests_table, reasons_table, volumes_table
from divideropt.report.data import COMPANION_NOTE, read_report
from divideropt.report.page import render_report
from divideropt.store import Store
from pagechecks import axes_without_words, blank_figures, findings

TEXT = """\
name: cost
model:
  kind: divider
  scenarios: {turned: {spool_position: 0.35}}
variables:
  spool_radius: [6 mm, 16 mm]
  groove_width: [0.6 mm, 2 mm]
  total_pressure_drop: [2 MPa, 10 MPa]
  centred_opening: [0.1, 0.9]
objectives:
  steady_state_error: {goal: 0.5 %, weight: 3, worst_of: [scenario, turned]}
  dynamic_error: {goal: 0.5 mL, worst_of: [scenario, turned]}
  source_pressure: {goal: 18 MPa}
constraints:
  source_pressure: {max: 30 MPa, worst_of: [scenario, turned]}
reference_point: {steady_state_error: 10 %, dynamic_error: 10 mL, source_pressure: 30 MPa}
strategies: {nsga2: {population: 12, generations: 6, seeds: [1]}}
nominal: true
verification: {sample: 0}
optimality: {points: 0}
parallel: {workers: 1, backend: sequential}
"""
PLAIN = ["steady_state_error", "dynamic_error", "source_pressure"]
WHOLE = ["worst.steady_state_error", "worst.dynamic_error", "source_pressure"]
GOALS, WEIGHTS = np.array([0.5, 0.5e-6, 18e6]), np.array([3.0, 1.0, 1.0])
CORNER = np.array([10.0, 10e-6, 30e6])


@pytest.fixture(scope="module", name="folder")
def _folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("cost") / "store"
    with Path("/dev/null").open("w", encoding="utf-8") as nowhere:
        run_campaign(parse_campaign(TEXT), folder, 1, nowhere, "again")
    return folder


@pytest.fixture(scope="module", name="data")
def _data(folder):
    return read_report(Store(folder))


def table(*parts) -> pd.DataFrame:
    return pd.read_parquet(Path(*parts)).set_index("design_id")


def attainment(rows: pd.DataFrame, columns: list[str]) -> pd.Series:
    return (((rows[columns].abs() - GOALS) / GOALS) * WEIGHTS).max(axis=1)


def test_the_best_by_the_goals_of_either_front_is_judged_by_both_problems(folder, data):
    fronts = {
        True: (table(folder, "nominal", "fronts", "combined.parquet"), table(folder, "beside")),
        False: (table(folder, "nominal", "beside"), table(folder, "fronts", "combined.parquet")),
    }
    for of_nominal, (alone, whole) in fronts.items():
        best = next(b for b in data.cost.bests if b.nominal is of_nominal and "goal_attainment" in b.reasons)
        values = attainment(alone, PLAIN) if of_nominal else attainment(whole, WHOLE)
        assert best.design_id == values.idxmin()
        row = alone.loc[best.design_id]
        assert best.alone.objectives == pytest.approx(row[PLAIN].abs().tolist(), rel=1e-15)
        assert best.alone.attainment == pytest.approx(attainment(alone, PLAIN)[best.design_id], rel=1e-12)
        assert best.alone.met == tuple((row[PLAIN].abs() <= GOALS).tolist())
        row = whole.loc[best.design_id]
        if row.outcome == "ok":
            assert best.whole.objectives == pytest.approx(row[WHOLE].abs().tolist(), rel=1e-15)
        for name, column in zip(PLAIN, PLAIN if of_nominal else WHOLE, strict=True):
            least = next(b for b in data.cost.bests if b.nominal is of_nominal and name in b.reasons)
            assert least.design_id == (alone if of_nominal else whole)[column].abs().idxmin()


def test_it_counts_what_does_not_stand_the_whole_campaign(folder, data):
    known = table(folder, "beside")
    ok = known.outcome == "ok"
    above = ok & (known["worst.source_pressure"] > 30e6)
    cost = data.cost
    assert (cost.known, cost.points, cost.size) == (len(known),) * 3
    assert cost.feasible == (ok & ~above).sum()
    counted = {reason.words: reason.count for reason in cost.reasons}
    assert counted.get("worst source pressure above 30 MPa", 0) == above.sum()
    assert sum(counted.values()) == len(known) - cost.feasible
    assert len(reasons_table(data).rows) == len(counted) > 0
    placed = [place for place in cost.placed if place.nominal]
    assert [place.design_id for place in placed] == known.index[ok].tolist()
    assert sum(place.feasible for place in placed) == cost.feasible


def test_the_hypervolumes_are_of_the_feasible_designs_in_each_problem(folder, data):
    known, front = table(folder, "beside"), table(folder, "fronts", "combined.parquet")
    stands = known[(known.outcome == "ok") & (known["worst.source_pressure"] <= 30e6)]
    (alone, whole), (_, own) = data.cost.volumes
    nominal = table(folder, "nominal", "fronts", "combined.parquet")
    assert alone == pytest.approx(hypervolume(nominal[PLAIN].abs().to_numpy(), CORNER), rel=1e-12)
    assert whole == pytest.approx(hypervolume(stands[WHOLE].abs().to_numpy(), CORNER), rel=1e-12)
    assert own == pytest.approx(hypervolume(front[WHOLE].abs().to_numpy(), CORNER), rel=1e-12)
    assert [cell.text for cell in volumes_table(data).rows[0].cells[1:]] == [f"{alone:.4f}", f"{whole:.4f}"]


def test_the_table_has_a_row_for_each_judge(data):
    shown = bests_table(data)
    assert len(shown.rows) == 2 * len(data.cost.bests)
    assert [row.cells[3].text for row in shown.rows[:2]] == ["nominal", "whole campaign"]
    titles = {heading.words: heading.title for heading in shown.headings}
    assert titles["steady state error"].startswith("nominal: steady state error of the design as it is")
    assert titles["steady state error"].endswith("whole campaign: worst steady state error")
    assert titles["source pressure"] == QUANTITIES["source_pressure"].description  # the same to both
    for row in shown.rows:
        assert len(row.cells) == len(shown.headings)


def test_the_companions_best_stands_scenario_by_scenario(folder, data):
    best = next(b for b in data.cost.bests if b.nominal)
    shown = data.scenarios.designs[-1]
    assert (shown.design_id, shown.label) == (f"nominal/{best.design_id}", "nominal front, best in goal attainment")
    row = table(folder, "beside").loc[best.design_id]
    values = next(r.values for r in shown.rows if r.quantity.name == "steady_state_error")
    assert values == pytest.approx(tuple(row[["steady_state_error", "turned.steady_state_error"]]), nan_ok=True)


def test_the_page_draws_both_fronts_and_asks_for_nothing(data, opened):
    text = render_report(data)
    assert axes_without_words(text) == []
    found = opened(text, NO_WEBGL)
    quiet(found)
    assert found.count("#cost .plot") == 3
    drawn = len({place.design_id for place in data.cost.placed if not place.nominal})
    assert found.count("#cost-0-1 .scatterlayer .trace:nth-child(1) path.point") == drawn
    assert found.page.locator("#cost-0-1 .xtitle").text_content().endswith("[%]")
    rows = found.page.locator("#cost-bests tbody tr[data-id]")
    rows.last.click()
    assert found.page.locator("#cost-bests tr[aria-current]").count() == 2
    assert rows.last.get_attribute("data-id") in found.title()
    assert blank_figures(found.page, "#cost .plot") == []
    assert findings(found) == []


def test_before_the_companion_has_ended_the_report_says_so(folder, tmp_path):
    store = tmp_path / "store"
    shutil.copytree(folder, store)
    shutil.rmtree(store / "beside")
    data = read_report(Store(store))
    assert data.cost is None
    assert COMPANION_NOTE in data.notes
    shutil.rmtree(store / "nominal")
    text = write_report(Store(store)).read_text(encoding="utf-8")
    assert "has not ended" in text
    assert 'id="cost"' not in text


def test_a_campaign_without_a_companion_has_no_such_section(store):
    data = read_report(store)
    assert data.cost is None
    assert COMPANION_NOTE not in data.notes
    assert 'id="cost"' not in render_report(data)
