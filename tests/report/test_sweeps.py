"""The page of sweeps: what is read from a study, and what a browser draws of it."""

import io
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from threadpoolctl import threadpool_info, threadpool_limits

from browsing import Opened, quiet
from divideropt.campaign.load import parse_campaign
from divideropt.campaign.runner import Runner
from divideropt.campaign.study import Asked, study_of
from divideropt.errors import UsageError
from divideropt.models import Outcome, Verdict
from divideropt.models.divider import Divider, Scenario, load_step, parameter_set
from divideropt.models.divider.study import THESIS_RANGES
from divideropt.report import write_sweeps
from divideropt.report.sweep_figures import errors_figure, flows_figure, quantity_figure, step_zoom_figure
from divideropt.report.sweep_tables import effects_table, failed_words, moved, share_words, summary_table
from divideropt.report.sweeps_data import TOTAL, SweepsData, read_sweeps
from divideropt.report.sweeps_page import THESIS_FIGURES, render_sweeps
from divideropt.store import Store
from pagechecks import axes_without_words, blank_figures, findings

POINTS = 9
PARAMETERS = ("groove_width=0.3 mm..2 mm", "spool_radius=8 mm..20 mm")

DIVIDER = """
name: sweeps
model: {kind: divider}
variables: {spool_radius: [6 mm, 16 mm]}
objectives: {steady_state_error: {}, dynamic_error: {}, peak_pressure: {}}
strategies: {nsga2: {population: 4, generations: 1}}
parallel: {backend: sequential}
"""

AUTHORS_TEST = "{start: cold, end: 1 s, step: {load: 1, to: 15 MPa, at: 0.6 s}}"
COLD = DIVIDER.replace("{kind: divider}", f"{{kind: divider, formulation: listing, scenario: {AUTHORS_TEST}}}")

SPHERES = """
name: spheres
model: {kind: "report_spheres:Spheres", options: {objectives: 2}}
variables: {p0: [0, 1], p1: [0, 1], p2: [0, 0.5]}
objectives: {q0: {}, q1: {}}
strategies: {nsga2: {population: 4, generations: 1}}
parallel: {backend: sequential}
"""


def run_study(text: str, folder: Path, parameters: tuple[str, ...] = PARAMETERS) -> Store:
    study = study_of(parse_campaign(text), Asked("oat", parameters, POINTS))
    assert not Runner(study, folder, 1, io.StringIO()).sample()
    return Store(folder)


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Store:
    """Of the divider: narrow grooves do not settle, wide ones are unstable."""
    return run_study(DIVIDER, tmp_path_factory.mktemp("sweeps") / "oat")


@pytest.fixture(scope="module")
def data(study: Store) -> SweepsData:
    return read_sweeps(study)


@pytest.fixture(scope="module")
def page(opened: Callable[..., Opened], data: SweepsData) -> Opened:
    return opened(render_sweeps(data))


@pytest.fixture(scope="module")
def plain_data(tmp_path_factory: pytest.TempPathFactory) -> SweepsData:
    """Of a model that has no responses and never fails."""
    return read_sweeps(run_study(SPHERES, tmp_path_factory.mktemp("plain") / "oat", ()))


def test_every_parameter_has_its_sweep_and_the_total_error(data):
    assert [part.sweep.parameter for part in data.parts] == ["groove_width", "spool_radius"]
    groove = data.parts[0].sweep
    np.testing.assert_allclose(groove.values, np.linspace(0.3e-3, 2e-3, POINTS))
    total = groove.quantities["cumulative_steady_error_percent"] + groove.quantities["dynamic_error_percent"]
    np.testing.assert_array_equal(groove.quantities[TOTAL], total)
    assert (data.evaluations, data.failed) == (2 * POINTS, groove.failed)
    assert 0 < groove.failed < POINTS


def test_responses_are_the_models_own_at_five_values(data):
    part = data.parts[1]
    assert [r.value for r in part.responses] == pytest.approx([8e-3, 11e-3, 14e-3, 17e-3, 20e-3])
    model = Divider()
    for response in part.responses:
        last = model.respond({**parameter_set("thesis_base"), "spool_radius": response.value}).phases[-1]
        flows = last.load_flows(last.trajectory.final[None])[0] * 6e4
        assert [flow[-1] for flow in response.curve.flows] == pytest.approx(flows.tolist(), rel=1e-4)
        row = int(np.argmin(np.abs(part.sweep.values - response.value)))
        assert response.settling == pytest.approx(part.sweep.quantities["settling_time"][row], rel=1e-12)


def test_responses_are_simulated_on_one_thread_as_the_study_was(study, monkeypatch):
    respond, seen = Divider.respond, []

    def curious(self, parameters, reading=None):
        seen.extend(library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas")
        return respond(self, parameters, reading)

    monkeypatch.setattr(Divider, "respond", curious)
    with threadpool_limits(2, user_api="blas"):
        again = read_sweeps(study)
    assert [len(part.responses) for part in again.parts] == [5, 5]
    assert set(seen) <= {1}


def test_a_response_that_ends_badly_says_how_in_the_legend(data):
    (bad,) = [r for r in data.parts[0].responses if r.value == pytest.approx(2e-3)]
    assert bad.settling is None
    assert f"2 mm ({bad.verdict.outcome})" in {trace.name for trace in flows_figure(data.parts[0]).data}


def test_the_zoom_is_on_the_step_and_on_the_designs_that_end_well(data):
    part = data.parts[0]
    figure = step_zoom_figure(part)
    settling = max(r.settling for r in part.responses if r.settling is not None)
    begin, end = figure.layout.xaxis.range
    assert begin < 0.0 < end == pytest.approx(1.5e3 * settling)
    low, high = figure.layout.yaxis.range
    for response in part.responses:
        inside = [begin <= t <= end for t in response.curve.times]
        flows = [q for flow in response.curve.flows for q, i in zip(flow, inside, strict=True) if i]
        if response.verdict.ok:
            assert low < min(flows) and max(flows) < high
    whole = flows_figure(part)
    assert all(len(zoomed.x) < len(full.x) for zoomed, full in zip(figure.data, whole.data, strict=True))


def test_a_cold_start_is_drawn_from_its_beginning(tmp_path):
    data = read_sweeps(run_study(COLD, tmp_path / "oat", ("spool_radius=8 mm..12 mm",)))
    (part,) = data.parts
    for response in part.responses:
        assert response.curve.times[0] == pytest.approx(-600.0, abs=1e-6)
        assert response.curve.flows[0][0] == 0.0
    low, _ = step_zoom_figure(part).layout.yaxis.range
    assert low > 20.0, "[L/min]: the empty valve is not in the zoom"
    scenario = Scenario(events=(load_step(1, 15e6, at=0.6),), settled=False)
    assert data.accumulation_time == scenario.accumulation_time


def test_errors_are_those_of_the_thesis_in_percent(data):
    part = data.parts[1]
    figure = errors_figure(part)
    assert [trace.name for trace in figure.data] == ["steady (3.11)", "dynamic (3.12)", "total"]
    steady, dynamic, total = (np.array(trace.y, dtype=float) for trace in figure.data)
    np.testing.assert_allclose(steady, part.sweep.quantities["flow_difference"], rtol=1e-4)
    np.testing.assert_allclose(dynamic, part.sweep.quantities["dynamic_error"] / (1e-3 * 0.2) * 100, rtol=1e-4)
    np.testing.assert_allclose(total, steady + dynamic, atol=1e-3)
    assert len({(trace.line.color, trace.line.dash) for trace in figure.data}) == 3


def test_failed_designs_are_gaps_with_marks(data):
    part = data.parts[0]
    figure = quantity_figure(part, data.quantities["settling_time"])
    line, circles, crosses = figure.data
    ok = part.sweep.ok
    assert [value is None for value in line.y] == (~ok).tolist()
    assert line.connectgaps is False
    np.testing.assert_allclose(crosses.x, part.sweep.values[~ok] * 1e3, rtol=1e-6)
    assert all(y < min(v for v in line.y if v is not None) for y in crosses.y)
    for text, verdict in zip(crosses.text, [v for v in part.sweep.verdicts if not v.ok], strict=True):
        assert text.startswith(f"{verdict.outcome}: {verdict.text[:10]}")
    values = part.sweep.quantities["settling_time"][~ok] * 1e3
    np.testing.assert_allclose(np.array(circles.y, dtype=float), values, rtol=1e-4)
    low, high = figure.layout.yaxis.range
    assert low < min(crosses.y) < max(v for v in line.y if v is not None) < high, "circles do not stretch the scale"
    bands = [shape for shape in figure.layout.shapes if shape.type == "rect"]
    assert len(bands) == len(part.sweep.failures())
    for value in part.sweep.values[~ok] * 1e3:
        assert any(band.x0 - 1e-9 <= value <= band.x1 + 1e-9 for band in bands)
    for value in part.sweep.values[ok] * 1e3:
        assert not any(band.x0 <= value <= band.x1 for band in bands)


def test_where_all_fail_all_that_is_defined_is_seen(data):
    part = data.parts[0]
    bad = replace(part, sweep=replace(part.sweep, verdicts=[Verdict(Outcome.UNSETTLED, "late")] * POINTS))
    line, circles, _ = quantity_figure(bad, data.quantities["source_pressure"]).data
    assert line.y == (None,) * POINTS
    pressures = part.sweep.quantities["source_pressure"] / 1e6
    np.testing.assert_allclose(np.array(circles.y, dtype=float), pressures, rtol=1e-4)
    low, high = quantity_figure(bad, data.quantities["source_pressure"]).layout.yaxis.range
    assert low < np.nanmin(pressures) and np.nanmax(pressures) < high
    unknown = tuple(replace(e, relative=float("nan")) for e in part.effects)
    assert moved(replace(bad, effects=unknown), data.quantities).startswith("not known")


def test_the_campaigns_own_value_is_dotted(data):
    shapes = quantity_figure(data.parts[1], data.quantities["settling_time"]).layout.shapes
    assert [(s.type, s.x0, s.x1, s.line.dash) for s in shapes] == [("line", 8.0, 8.0, "dot")]


def test_each_axis_has_symbol_and_unit(data):
    figure = quantity_figure(data.parts[1], data.quantities["source_pressure"])
    assert figure.layout.xaxis.title.text == "spool radius r [mm]"
    assert figure.layout.yaxis.title.text == "source pressure Ps [MPa]"
    assert errors_figure(data.parts[1]).layout.yaxis.title.text == "error at t_cum [%]"
    assert "|" not in data.quantities["dynamic_error"].label, "it is drawn with its sign"


def test_the_thesis_draws_and_the_objectives_are_drawn(data):
    assert data.drawn == ("settling_time", "source_pressure", "peak_pressure")
    assert data.chosen == ("steady_state_error", "dynamic_error", "peak_pressure", "settling_time", "source_pressure")


def test_the_summary_says_range_effect_and_failures(data):
    table = summary_table(data)
    groove, radius = table.rows
    sound = data.parts[1].sweep.sound("steady_state_error")
    effect = (sound.max() - sound.min()) / abs(data.base["steady_state_error"])
    assert radius.cells[2].text == f"{sound.min():.3f} … {sound.max():.2f} ({100 * effect:.0f} %)"
    assert radius.cells[1].text == "none"
    assert re.match(r"\d of 9 \(\d+ %\): unsettled (at|from) 0\.3", groove.cells[1].text)
    assert groove.cells[1].text == failed_words(data.parts[0])
    assert "unstable" in failed_words(data.parts[0])


def test_the_table_of_every_quantity_has_zeros_and_the_own_design(data):
    part = data.parts[1]
    rows = {row.cells[0].text: [cell.text for cell in row.cells] for row in effects_table(part, data).rows}
    assert len(rows) == len(data.quantities)
    (at,) = part.sweep.crossings(TOTAL)
    assert rows["total error percent"][-1] == f"{at * 1e3:.4g} mm"
    assert rows["source pressure"][1] == "MPa"
    assert float(rows["source pressure"][4]) == pytest.approx(data.base["source_pressure"] / 1e6, abs=0.01)
    assert rows["spool mass"][5] == share_words((20 / 8) ** 2 - 1)


def test_what_moves_together_is_named_once(data):
    words = moved(data.parts[0], data.quantities)
    assert words.count(";") == 2
    assert sum(name in words for name in ("dynamic error ", "dynamic error percent ")) <= 1


@pytest.mark.parametrize(
    ("share", "words"), [(0.5, "50 %"), (9.99, "999 %"), (10.0, "×10"), (294.48, "×294"), (float("nan"), "–")]
)
def test_shares(share, words):
    assert share_words(share) == words


def test_every_figure_of_the_thesis_is_of_a_parameter_that_it_sweeps():
    assert set(THESIS_RANGES) - set(THESIS_FIGURES) == {"groove_angle"}
    assert set(THESIS_FIGURES) <= set(THESIS_RANGES)


def test_a_model_of_ones_own_has_its_objectives_drawn(plain_data, opened):
    assert (plain_data.errors, plain_data.drawn) == (False, ("q0", "q1"))
    found = opened(render_sweeps(plain_data))
    assert found.count(".sweep .plot") == 3 * 2
    assert found.count(".sweep .plot .scatterlayer path.js-line") == 3 * 2
    assert found.count("#panels .scatterlayer path.js-line") == 3
    assert "Failed" in found.page.locator(".sweep").first.inner_text()
    quiet(found)


def test_a_models_words_are_no_markup(plain_data, opened):
    hostile = "</script><script>window.hacked=1</script><a href='https://example.org/'>x</a>%{x}"
    part = plain_data.parts[0]
    verdicts = [Verdict(Outcome.CRASHED, hostile), *part.sweep.verdicts[1:]]
    axis = replace(part.axis, words=hostile, symbol=hostile, description=hostile)
    worse = replace(part, sweep=replace(part.sweep, verdicts=verdicts), axis=axis)
    quantities = {name: replace(axis, name=name) for name in plain_data.quantities}
    found = opened(render_sweeps(replace(plain_data, parts=(worse, *plain_data.parts[1:]), quantities=quantities)))
    assert found.page.evaluate("window.hacked") is None
    assert found.count("#quantity-0-0 .scatterlayer .trace:last-child path.point") == 1
    quiet(found)


def test_nothing_leaves_the_page(page):
    page.page.wait_for_load_state("networkidle")
    quiet(page)


def test_the_page_is_accessible_its_axes_worded_and_its_figures_drawn(page, data):
    assert axes_without_words(render_sweeps(data)) == []
    assert findings(page) == []
    assert blank_figures(page.page) == []


def test_every_figure_is_drawn_for_every_parameter(page, data):
    for place in range(len(data.parts)):
        for kind, lines in (("flows", 10), ("step", 10), ("errors", 3), ("quantity-0", 1), ("quantity-2", 1)):
            selector = f"#{kind}-{place} .scatterlayer path.js-line"
            assert page.count(selector) == lines, (kind, place)
    assert page.count("#errors-0 .scatterlayer .trace:last-child path.point") == data.parts[0].sweep.failed
    assert page.count("#quantity-0-0 .shapelayer path") == len(data.parts[0].sweep.failures()) + 1


def test_any_quantity_can_be_chosen(page, data):
    before = page.page.locator("#panels .ytitle").first.text_content()
    page.page.select_option("#quantity", "leakage")
    page.page.wait_for_function("document.querySelector('#panels .ytitle').textContent.includes('leakage')")
    assert page.page.locator("#panels .ytitle").first.text_content() == data.quantities["leakage"].label != before
    assert page.count("#quantity option") == len(data.quantities)
    assert page.count("#panels .scatterlayer path.js-line") == len(data.parts)


def test_a_study_that_has_not_ended_says_so(tmp_path):
    study = study_of(parse_campaign(SPHERES), Asked("oat", (), POINTS))
    store = Store(tmp_path / "oat")
    Runner(study, store.folder, 1, io.StringIO()).sample()
    (part,) = (store.folder / "evaluations" / "oat-1").glob("*.parquet")
    part.unlink()
    data = read_sweeps(store)
    assert (data.parts, data.planned, data.base["q0"] != data.base["q0"]) == ((), 3, True)
    assert "0 of 3 sweeps are whole" in render_sweeps(data)


def test_another_store_is_refused(store):
    with pytest.raises(UsageError, match=r"no study of one parameter at a time; make one by `divideropt sensitivity"):
        write_sweeps(store)


def test_the_page_is_written_into_the_store_or_elsewhere(study, tmp_path):
    assert write_sweeps(study) == study.report_path
    out = write_sweeps(study, tmp_path / "page.html")
    assert out.read_bytes() == study.report_path.read_bytes(), "the same study, the same page"
    assert out.stat().st_size < 6e6
