"""A store to the report's data: counts, the front, the bounds it leans on, responses, and the page's text."""

import shutil
from dataclasses import replace

import numpy as np
import pytest

from divideropt.analysis import Kkt, Optimality, Verified, spread
from divideropt.campaign.load import parse_campaign, stored_campaign
from divideropt.campaign.plan import build_problem
from divideropt.models import Domain, Parameter, Quantity
from divideropt.problem import DesignSpace, Variable
from divideropt.report import Curve, ResponseCurves, response_page, write_report
from divideropt.report.convergence import tracks_of
from divideropt.report.convergence_figure import convergence_figure
from divideropt.report.data import read_report
from divideropt.report.display import axis_of, number, shown_as
from divideropt.report.figures import front_3d, projections, residuals
from divideropt.report.front import Design, leanings
from divideropt.report.page import render_report
from divideropt.report.responses import MOST_POINTS
from divideropt.report.sampling import thin
from divideropt.report.tables import LAST, front_table, residual_cell
from divideropt.store import Store, TableSchema

HOSTILE = "</script><script>window.hacked=1</script>"


def schema_of(store):
    return TableSchema.of(build_problem(stored_campaign(store)))


def _copy(store, folder):
    shutil.copytree(store.folder, folder)
    return Store(folder)


def test_every_run_is_counted(data):
    assert [(run.name, run.seed, run.evaluations, run.budget) for run in data.runs] == [
        ("nsga2-1", 1, 36, 36),
        ("complex-1", 1, 40, 40),
    ]
    for run in data.runs:
        assert sum(run.outcomes.values()) == run.evaluations
        assert run.marks[-1] == run.evaluations
        assert list(run.hypervolumes) == sorted(run.hypervolumes)


def test_the_front_is_the_stored_one_best_first(store, data):
    stored = store.read_front("combined", schema_of(store))
    assert {d.design_id for d in data.front} == set(stored["design_id"].to_pylist())
    attainments = [d.attainment for d in data.front]
    assert attainments == sorted(attainments)
    assert data.notes == ()


def test_objectives_are_magnitudes(store, data):
    signed = dict(
        zip(
            store.read_front("combined", schema_of(store))["design_id"].to_pylist(),
            store.read_front("combined", schema_of(store))["dynamic_error"].to_pylist(),
            strict=True,
        )
    )
    assert any(value < 0 for value in signed.values()), "the test needs a negative one"
    assert all(d.objectives[1] == abs(signed[d.design_id]) for d in data.front)


def test_the_best_of_a_strategy_is_the_least_of_its_runs(data):
    assert [d.strategy for d in data.best] == ["nsga2", "complex"]
    assert [d.attainment for d in data.best] == [run.best[1] for run in data.runs]


def test_responses_are_those_of_the_sets_and_of_the_front(data):
    assert [r.name for r in data.responses.sets] == ["thesis_base", "thesis_prototype", "thesis_optimum"]
    assert {d.design_id for d in data.front} <= {r.name for r in data.responses.designs}
    for response in (*data.responses.sets, *data.responses.designs):
        assert len(response.times) <= MOST_POINTS + 30
        assert list(response.times) == sorted(response.times)
        assert all(len(flow) == len(response.times) for flow in response.flows)
        assert response.times[-1] == 1000.0


def test_a_drawn_response_is_the_simulated_one(store, data):
    model = build_problem(parse_campaign(store.read_campaign())).model
    problem = build_problem(parse_campaign(store.read_campaign()))
    best = next(d for d in data.front if d.design_id == data.responses.designs[0].name)
    parameters = dict(problem.fixed) | dict(zip(problem.space.names, best.variables, strict=True))
    phase = model.respond(parameters).phases[-1]
    times = np.linspace(1e-4, 1.0, 5000)
    exact = phase.load_flows(phase.trajectory.at(times)) * 6e4
    drawn = data.responses.designs[0]
    for exact_flow, flow in zip(exact.T, drawn.flows, strict=True):
        assert np.interp(times * 1e3, drawn.times, flow) == pytest.approx(exact_flow, rel=2e-3)


def test_without_its_front_the_store_is_reported_as_unfinished(store, data, tmp_path):
    copy = _copy(store, tmp_path / "copy")
    shutil.rmtree(copy.folder / "fronts")
    again = read_report(copy)
    assert again.front == data.front
    assert "has not ended" in again.notes[0]


def test_a_front_older_than_the_logs_is_not_shown(store, data, tmp_path):
    copy = _copy(store, tmp_path / "copy")
    copy.write_front("combined", copy.read_front("combined", schema_of(store)).slice(1))
    again = read_report(copy)
    assert again.front == data.front
    assert "older than the logs" in again.notes[0]


def test_a_store_that_has_not_begun(store, tmp_path):
    bare = Store(tmp_path / "bare")
    bare.write_campaign(store.read_campaign())
    text = write_report(bare).read_text("utf-8")
    assert "Not begun yet: nsga2-1, complex-1." in text
    assert "No design is feasible yet." in text


def test_a_store_without_a_feasible_design_says_so(spheres):
    text = write_report(spheres(2, "constraints: {q0: {max: -1}}")).read_text("utf-8")
    assert "No design is feasible." in text
    assert "How the simulations ended" in text
    assert 'id="front-table"' not in text


@pytest.mark.parametrize(("objectives", "pairs"), [(1, 0), (2, 1), (3, 3), (4, 6), (5, 6)])
def test_figures_follow_the_number_of_objectives(spheres, objectives, pairs):
    text = write_report(spheres(objectives)).read_text("utf-8")
    assert text.count('class="plot projection"') == pairs
    assert ('id="front" class="plot"' in text) == (objectives >= 3)
    assert ('id="least"' in text) == (objectives == 1)
    assert 'id="response"' not in text, "a plug-in has no step response"
    assert 'id="best"' not in text, "no goals, no best by goal attainment"


def test_a_design_leans_within_a_thousandth_of_the_range():
    parameter = Parameter("p", "m", "p", "", 0.5, Domain())
    space = DesignSpace((Variable(parameter, 1.0, 2.0), Variable(parameter, 1.0, 2.0)))
    places = [(1.0009, 1.5)] * 10 + [(1.0011, 2.0)] * 20 + [(1.5, 1.5)] * 10
    designs = [Design("r/0", "r", "s", place, (1.0,), None, (None,)) for place in places]
    assert [(item.variable, item.side, item.bound, item.share) for item in leanings(designs, space)] == [
        (1, "upper", 2.0, 0.5),
        (0, "lower", 1.0, 0.25),
    ]
    few = [replace(designs[-1])] * 20 + [designs[0]]
    assert leanings(few, space) == ()
    assert leanings([], space) == ()


def test_the_page_names_the_bounds_it_leans_on(data):
    designs = tuple(replace(d, variables=(16e-3, *d.variables[1:])) for d in data.front)
    problem_space = DesignSpace(
        tuple(Variable(Parameter(v.axis.name, "", "", "", 0.0, Domain()), v.lower, v.upper) for v in data.variables)
    )
    text = render_report(replace(data, front=designs, leanings=leanings(designs, problem_space)))
    assert "the box’s, not the valve’s" in text
    assert "<b>spool radius</b> r, upper bound 16 mm: 100 % of the front" in text


def test_the_same_store_gives_the_same_bytes(store, data, tmp_path):
    first = write_report(store, tmp_path / "deep" / "a.html").read_bytes()
    assert first == render_report(data).encode()
    assert str(store.folder).encode() not in first
    assert not (store.folder / "report.html").exists()


def test_hostile_text_is_escaped_everywhere(data):
    designs = tuple(replace(d, design_id=HOSTILE + d.design_id) for d in data.front)
    known = replace(data, front=designs, sketches=None, sheets=None)  # these have a test of their own
    text = render_report(
        replace(known, name=HOSTILE, campaign=HOSTILE, setting=((HOSTILE, HOSTILE),), notes=(HOSTILE,))
    )
    assert "<script>window.hacked" not in text
    assert "&lt;script&gt;window.hacked" in text


def test_figures_hold_no_tag_from_outside(data):
    link = '<a href="https://example.org/">here</a>'
    objectives = tuple(replace(o, axis=replace(o.axis, words=link, symbol=link)) for o in data.objectives)
    runs = tuple(replace(run, name=link, strategy=link + run.strategy) for run in data.runs)
    front = tuple(replace(d, strategy=link + d.strategy) for d in data.front)
    hostile = replace(data, objectives=objectives, runs=runs, front=front)
    curve = convergence_figure(tracks_of(runs, data.objectives)[0], hostile.strategies)
    for figure in (front_3d(hostile).to_json(), curve.to_json(), projections(hostile)[0][1].to_json()):
        assert "example.org" in figure
        assert "\\u003ca href" not in figure
        assert "<a href" not in figure


def test_a_thinned_curve_keeps_its_shape_and_its_ends():
    times = np.linspace(0.0, 1.0, 2001)
    values = np.column_stack([np.exp(-times / 0.01), np.cos(30 * times) * np.exp(-5 * times)])
    kept = thin(times, values, 150, 1e-4)
    assert (kept[0], kept[-1]) == (0, 2000)
    assert len(kept) <= 150
    for column in values.T:
        assert np.interp(times, times[kept], column[kept]) == pytest.approx(column, abs=5e-3)
    assert np.median(times[kept]) < 0.5, "more points where it bends more"


def test_thinning_needs_no_more_points_than_the_shape():
    times = np.linspace(0.0, 1.0, 500)
    assert len(thin(times, times[:, None], 150, 1e-6)) == 2
    assert list(thin(times[:1], times[:1, None], 150, 1e-6)) == [0]


def test_a_spread_begins_with_what_is_asked_and_repeats_nothing():
    points = np.random.default_rng(1).random((300, 3))
    points[100:200] = points[0]
    chosen = spread(points, [5, 7, 5], 150)
    assert chosen[:2] == [5, 7]
    assert len(set(chosen)) == len(chosen) == 150
    assert chosen == spread(points, [5, 7, 5], 150)
    assert sorted(spread(points[:4], [2], 10)) == [0, 1, 2, 3]


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (9.9996, "10.00"),
        (-0.20461, "−0.2046"),
        (12345.0, "12345"),
        (2.5e-7, "250.0·10⁻⁹"),
        (-1.23456e7, "−12.35·10⁶"),
        (9.99996e-7, "1.000·10⁻⁶"),
    ],
)
def test_numbers_have_four_digits(value, text):
    assert number(value) == text


def test_units_are_those_people_use():
    assert shown_as("m", [3e-6]).unit == "µm"
    assert shown_as("m", [6e-3, 16e-3]).unit == "mm"
    assert shown_as("Pa", [18e6]).unit == "MPa"
    assert shown_as("m^3/s", [5e-4]).unit == "L/min"
    assert shown_as("furlong", [1.0]).unit == "furlong"
    axis = axis_of(Quantity("dynamic_error", "m^3", "E_CUDY, (3.10)", "", 1e-6, signed=True), [1e-6])
    assert axis.label == "dynamic error |E_CUDY| [mL]"
    assert (
        axis_of(Quantity("dynamic_error_abs", "m^3", "∫|·| of (3.10)", "", 1e-6), []).label
        == "dynamic error abs [mL]"
    )
    assert axis_of(Quantity("steady_state_error", "%", "(3.6)", "", 1.0), []).label == "steady state error [%]"


def test_one_quantity_has_one_unit_whatever_values_a_table_has_of_it():
    pressure, size = Quantity("p", "Pa", "", "", 1e7), Quantity("x", "m", "", "", 1e-3)
    assert [axis_of(pressure, values).shown.unit for values in ((), [2e7], [9e8], [0.0])] == ["MPa"] * 4
    assert [axis_of(size, [value]).shown.unit for value in (5e-5, 1e-3, 2.0)] == ["mm"] * 3
    assert [axis_of(size, [value]).shown.unit for value in (5e-6, 20.0)] == ["µm", "m"], "where its own says nothing"
    modulus = Parameter("bulk_modulus", "Pa", "", "", 1e9, Domain(0.0, 1e10))
    assert [axis_of(modulus, [value]).short(value) for value in (2e8, 1.2e9)] == ["0.2 GPa", "1.2 GPa"]


def test_a_response_page_wants_a_value_a_time():
    page = response_page(HOSTILE, ResponseCurves([0.0, 1.0], (Curve("load_flow_1", "m^3/s", [1e-3, np.nan]),)))
    assert HOSTILE not in page
    with pytest.raises(ValueError, match="1 values for 2 times"):
        response_page("x", ResponseCurves([0.0, 1.0], (Curve("x", "m", [1.0]),)))


def test_the_table_says_which_designs_are_verified(store, data):
    stored = store.read_front("combined", schema_of(store)).to_pydict()
    words = dict(zip(stored["design_id"], stored["verified"], strict=True))
    assert set(words.values()) == {"yes", "no"}
    assert {d.design_id: d.verified for d in data.front} == words
    table = front_table(data, 1000)
    place = [heading.words for heading in table.headings].index("verified")
    assert {row.design_id: row.cells[place].text for row in table.rows} == words
    text = render_report(data)
    assert f"Verified: {list(words.values()).count('yes')} of {len(words)} designs" in text
    assert 'id="deviating"' not in text


def test_a_design_that_deviates_is_said_so_above_the_table(data):
    first, second, *others = data.front
    front = (
        replace(first, verified=Verified.DEVIATES, deviation=0.0521),
        replace(second, verified=Verified.DEVIATES, deviation=1e-5),
        *(replace(design, verified=Verified.NO) for design in others),
    )
    text = render_report(replace(data, front=front))
    warning = text.index("2 designs of this front deviate:")
    assert text.index("2 designs of this front deviate</strong>") < text.index('id="front-table"')
    assert text.index('id="certificates"') < warning
    assert f"<b>{first.design_id}</b> deviates, by 5.2 %" in text[warning:]
    assert f"<b>{second.design_id}</b> deviates, by its outcome" in text[warning:]
    assert f"Verified: 2 of {len(front)} designs" in text
    assert "0 came out the same" in text


def test_a_model_without_a_reference_has_nothing_verified(spheres):
    text = write_report(spheres(2)).read_text("utf-8")
    assert "No design was simulated again" in text


def test_the_page_says_how_near_to_stationary_the_front_is(store, data):
    stored = store.read_front("combined", schema_of(store)).to_pandas()
    known = stored.kkt_residual.dropna()
    assert 0 < len(known) == data.kkt.computed == sum(d.optimality is not None for d in data.front)
    text = render_report(data)
    assert f"median {number(known.median(), 2)}, 95th percentile {number(known.quantile(0.95), 2)}" in text
    assert "KKT residual" in [heading.words for heading in front_table(data, 1000).headings]
    lines = {trace.name: trace for trace in residuals(data).data}
    for strategy, line in lines.items():
        own = known[stored.run.str.startswith(strategy)]
        np.testing.assert_allclose(line.x, np.sort(own), rtol=1e-4)
        assert line.y[-1] == 1.0


def test_a_cell_says_what_is_known_of_a_residual(data):
    first = data.front[0]
    for kkt, found, text, order in (
        (Kkt.COMPUTED, Optimality(0.01234, 1e-5), "0.012", "0.01234"),
        (Kkt.COMPUTED, Optimality(1e-9, 1e-5), "< 10·10⁻⁶", "1e-09"),
        (Kkt.NOT_DEFINED, None, "not defined", LAST),
        (Kkt.NOT_COMPUTED, None, "–", LAST),
    ):
        cell = residual_cell(replace(first, kkt=kkt, optimality=found), data)
        assert (cell.text, cell.order) == (text, order)


def test_where_no_residual_was_asked_for_the_page_does_not_speak_of_them(spheres):
    text = write_report(spheres(2)).read_text("utf-8")
    assert 'id="optimality"' not in text
    assert "KKT residual" not in text
