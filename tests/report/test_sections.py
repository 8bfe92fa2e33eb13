"""The report's sections: what came out goal by goal, how runs came on, what failed and where, how to repeat it."""

import json
import re
import shutil
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pandas as pd
import pytest

from browsing import FITTING, NO_WEBGL, eventually, quiet
from divideropt.analysis import course_of
from divideropt.analysis.failures import PARTS
from divideropt.campaign.load import load_campaign, parse_campaign
from divideropt.report.convergence import tracks_of
from divideropt.report.convergence_figure import convergence_figure
from divideropt.report.convergence_tables import convergence_table, unequal
from divideropt.report.data import read_report
from divideropt.report.display import brief, grouped, share
from divideropt.report.failing import FEW
from divideropt.report.failing_tables import along_table, bounds_table
from divideropt.report.page import render_report
from divideropt.report.runs import marks_of
from divideropt.report.summary_tables import goals_table
from divideropt.report.tables import outcome_table
from divideropt.store import Store
from stores import logs

SECTIONS = (
    "Summary",
    "Front",
    "Designs",
    "Responses",
    "Convergence",
    "Strategies compared",
    "Certificates and failures",
    "Provenance",
)
"""Those of a campaign without a sensitivity study, which comes before the certificates."""


@pytest.fixture(scope="module")
def text(data):
    return render_report(data)


@pytest.fixture(scope="module")
def log(store):
    """Every evaluation of every run."""
    return pd.concat(logs(store.folder).values(), ignore_index=True)


def test_the_sections_are_in_order_in_the_page_and_above_it(text):
    assert tuple(re.findall(r"<h2[^>]*>([^<]*)</h2>", text)) == SECTIONS
    nav = text[text.index("<nav") : text.index("</nav>")]
    links = re.findall(r'<a href="#([a-z-]+)">([^<]*)</a>', nav)
    assert tuple(words for _, words in links) == SECTIONS
    for target, words in links:
        section = text[text.index(f'<section id="{target}"') :]
        assert re.search(r"<h2[^>]*>([^<]*)</h2>", section).group(1) == words


# --- summary ---


def test_the_headline_counts_the_goals(data):
    head = data.headline
    goals = np.array([facts.goal for facts in data.objectives])
    values = np.array([design.objectives for design in data.front])
    met = (values <= goals).sum(axis=1)
    assert head.goals == 3
    assert head.best.attainment == min(design.attainment for design in data.best)
    assert head.met == int((np.array(head.best.objectives) <= goals).sum())
    assert dict(head.meeting) == {n: int((met == n).sum()) for n in (3, 2, 1) if (met == n).any()}
    for i, aim in enumerate(head.aims):
        assert (aim.least, aim.greatest) == (values[:, i].min(), values[:, i].max())
        assert aim.meeting == int((values[:, i] <= goals[i]).sum())
        assert aim.lack == pytest.approx(head.best.objectives[i] - goals[i])


def test_the_first_screen_says_what_misses_and_by_how_much(data, text):
    head = data.headline
    missing = [aim for aim in head.aims if not aim.met]
    assert missing, "the test needs a goal that is missed"
    assert f"<strong>{head.best.design_id} meets {head.met or 'none'} of 3 goals</strong>" in text
    table = goals_table(head)
    place = [heading.words for heading in table.headings].index("goal missed by")
    for row, aim in zip(table.rows, head.aims, strict=True):
        shown = row.cells[place].text
        if aim.met:
            assert shown == "–"
        else:
            percent = float(re.search(r"\(([\d.]+) %\)", shown).group(1))
            assert percent == pytest.approx(100 * aim.lack / aim.facts.goal, rel=0.05)
    assert all(f"{aim.facts.axis.words} is {aim.facts.axis.text(aim.reached)}" in text for aim in missing)


def test_goals_that_are_met_are_said_to_be(spheres):
    data = read_report(spheres(2, goal="{goal: 2}"))
    text = render_report(data)
    assert f"{data.headline.best.design_id} meets 2 of 2 goals</strong>" in text
    assert data.headline.all_met == len(data.front)
    assert f"<strong>{len(data.front)} designs (100 %) meet all 2 goals</strong>" in text


def test_without_goals_the_summary_speaks_of_none(spheres):
    data = read_report(spheres(2))
    assert (data.headline.best, data.headline.goals, data.headline.meeting) == (None, 0, {})
    assert [heading.words for heading in goals_table(data.headline).headings] == ["objective", "on the front"]
    assert "Goals on the front" not in render_report(data)


@pytest.mark.parametrize(
    ("part", "whole", "words"),
    [
        (0, 9, "0 %"),
        (9, 9, "100 %"),
        (1, 9999, "< 0.1 %"),
        (9998, 9999, "> 99.9 %"),
        (1, 3, "33 %"),
        (1, 25, "4.0 %"),
    ],
)
def test_a_share_is_none_or_all_only_where_it_is(part, whole, words):
    assert share(part, whole) == words


def test_large_counts_are_readable():
    assert (grouped(9999), grouped(1234567)) == ("9999", "1\u202f234\u202f567")
    assert (brief(9999), brief(29786), brief(31_400_000)) == ("9999", "29.8k", "31.4M")


# --- convergence ---


def test_a_run_attains_what_its_log_says(store, data, log):
    goals = {"steady_state_error": (0.5, 3.0), "dynamic_error": (5e-7, 3.0), "source_pressure": (18e6, 1.0)}
    for run in data.runs:
        own = log[log.run == run.name].reset_index(drop=True)
        worst = np.max([(own[n].abs() - goal) / goal * weight for n, (goal, weight) in goals.items()], axis=0)
        kept = (own.outcome == "ok") & (own.source_pressure <= 30e6) & (own.stop_clearance >= 0.0)
        running = np.minimum.accumulate(np.where(kept, worst, np.inf))
        assert run.attainments == pytest.approx([running[mark - 1] for mark in run.marks])
        assert run.attainments[-1] == run.best[1]


def test_a_median_is_that_of_the_runs_at_equal_evaluations():
    course = course_of([1, 10, 100], [[np.inf, 3.0, 1.0], [np.inf, 2.0, 1.5], [5.0, 4.0, 0.5], [6.0, 2.5, 0.0]])
    assert course.quartiles
    assert course.median == pytest.approx((np.inf, 2.75, 0.75))
    assert course.lower == pytest.approx((5.75, 2.375, 0.375))
    assert course.upper == pytest.approx((np.inf, 3.25, 1.125))


def test_of_few_runs_the_spread_is_all():
    course = course_of([1, 2], [[3.0, 1.0], [1.0, 0.5], [2.0, 0.0]])
    assert not course.quartiles
    assert (course.lower, course.median, course.upper) == ((1.0, 0.0), (2.0, 0.5), (3.0, 1.0))


@pytest.fixture
def several(spheres):
    """`several(runs)`: the report of a strategy with so many seeds."""

    def make(runs, goal="{goal: 0.1}"):
        seeds = ", ".join(str(i + 1) for i in range(runs))
        strategies = f"strategies: {{nsga2: {{population: 8, generations: 4, seeds: [{seeds}]}}}}"
        return read_report(spheres(2, goal=goal, strategies=strategies))

    return make


def test_the_median_goes_as_far_as_the_shortest_run(several):
    data = several(4)
    common = marks_of(20, 2)
    shortened = tuple(
        replace(run, **_at(run, common if run.seed == 2 else {*run.marks, *common})) for run in data.runs
    )
    tracks = tracks_of(shortened, data.objectives)
    for track in tracks:
        assert track.courses["nsga2"].marks == common
        assert track.courses["nsga2"].runs == 4
    assert unequal(tracks) == (("nsga2", 20),)
    page = render_report(replace(data, runs=shortened, tracks=tracks))
    assert "nothing is carried on beyond it: nsga2 to 20 evaluations" in page
    assert unequal(data.tracks) == ()


def _at(run, marks):
    """A run's histories, looked at more often: each value holds until the next."""
    marks = tuple(sorted(marks))
    places = np.searchsorted(run.marks, marks, side="right") - 1
    names = ("hypervolumes", "attainments", "least")
    return {"marks": marks} | {name: tuple(getattr(run, name)[i] for i in places) for name in names}


@pytest.mark.parametrize(("runs", "bands", "dashed"), [(1, 0, 0), (2, 0, 0), (3, 0, 2), (4, 1, 0)])
def test_runs_are_thin_and_the_median_is_bold(several, runs, bands, dashed):
    data = several(runs)
    assert [track.name for track in data.tracks] == ["hypervolume", "attainment"]
    for track in data.tracks:
        traces = convergence_figure(track, data.strategies).data
        widths = [trace.line.width for trace in traces]
        assert widths.count(3) == 1
        assert widths.count(1) == (runs if runs > 1 else 0)
        assert sum(trace.fill == "toself" for trace in traces) == bands
        assert sum(trace.line.dash == "dash" for trace in traces) == dashed
        median = next(trace for trace in traces if trace.line.width == 3)
        values = [v for v in median.y if v is not None]
        better = [b >= a if track.name == "hypervolume" else b <= a for a, b in pairwise(values)]
        assert all(better), "what is best so far gets no worse"
    table = convergence_table(data.tracks)
    assert [row.cells[0].text for row in table.rows] == ["hypervolume", "best max λ"]
    assert (table.rows[0].cells[-1].text == "–") == (runs == 1)


def test_what_cannot_be_measured_is_not_drawn_and_said(run_campaign, spheres, tmp_path):
    goalless = read_report(spheres(2))
    assert [track.name for track in goalless.tracks] == ["hypervolume"]
    assert "Without a goal for every objective there is no goal attainment." in render_report(goalless)
    bare = spheres(2).read_campaign()
    bare = re.sub(r"reference_point:.*\n(  .*\n)*", "", bare)
    data = read_report(run_campaign(bare, tmp_path / "bare"))
    assert data.tracks == ()
    assert "there is nothing by which runs could be followed" in render_report(data)


# --- certificates and failures ---


def test_failures_are_counted_where_they_are(data, log):
    failed = log[log.outcome != "ok"]
    assert len(failed) > 0, "the test needs failures"
    failing = data.failing
    assert (failing.designs, failing.failed, failing.worked) == (len(log), len(failed), len(log) - len(failed))
    for along, facts in zip(failing.along, data.variables, strict=True):
        edges = np.linspace(facts.lower, facts.upper, PARTS + 1)
        for rows, counts in ((log, [p.designs for p in along.parts]), (failed, [p.failed for p in along.parts])):
            assert counts == np.histogram(rows[facts.axis.name], edges)[0].tolist()
    table = along_table(failing)
    assert table.rows[0].cells[2].text == f"{failing.along[0].parts[0].failed} of {failing.along[0].parts[0].designs}"


def test_outcomes_have_their_share_and_their_words(data, log):
    table = outcome_table(data)
    counts = log.outcome.value_counts()
    assert {row.cells[0].text: int(row.cells[1].text) for row in table.rows} == counts.to_dict()
    for row in table.rows:
        assert row.cells[2].text == share(int(row.cells[1].text), len(log))
        words = row.cells[-1].text
        assert (words == "") == (row.cells[0].text == "ok")
        assert words in set(log.outcome_text[log.outcome == row.cells[0].text].fillna(""))


def test_broken_constraints_are_counted_among_what_ended_well(data, log):
    well = log[log.outcome == "ok"]
    high, out = well.source_pressure > 30e6, well.stop_clearance < 0.0
    found = {bound.words: (bound.broken, bound.alone) for bound in data.failing.bounds}
    assert found == {
        "source pressure at most 30 MPa": (high.sum(), (high & ~out).sum()),
        "stop clearance at least 0 mm": (out.sum(), (out & ~high).sum()),
    }
    assert high.any(), "the test needs a broken one"
    assert bounds_table(data.failing).rows[0].cells[0].text == "source pressure at most 30 MPa"


def test_where_nothing_failed_nothing_is_drawn(spheres):
    text = render_report(read_report(spheres(2)))
    assert "<strong>None of 48 simulated designs failed.</strong>" in text
    assert "Where in the box" not in text
    assert "Which constraints are broken" not in text


def test_certificates_are_together(text):
    begin, end = text.index('<section id="certificates"'), text.index('<section id="provenance"')
    for part in ('id="verified"', 'id="validity"', 'id="kkt"', 'id="residuals"', 'id="failed"', 'class="histogram"'):
        assert text.count(part) == 1 or part == 'class="histogram"'
        assert begin < text.index(part) < end


# --- provenance ---


def test_it_says_what_wrote_the_store_and_how_to_repeat_it(store, data, text):
    (writer,) = store.writers()
    assert writer == json.loads((store.folder / ".writers.json").read_text())["writers"][-1]
    for word in (writer["processor"], writer["numpy"], data.provenance.here["platform"]):
        assert f'<td class="number">{word}</td>' in text
    assert f"python -m pip install numpy=={writer['numpy']} " in text
    assert "divideropt run campaign.yaml --store results/small-again\n" in text
    assert 'id="unrepeatable"' not in text
    assert "nsga2-1 has 1, complex-1 has 1." in text


def test_several_writers_are_told_apart(store, data, tmp_path):
    copy = Store(tmp_path / "copy")
    shutil.copytree(store.folder, copy.folder)
    path = copy.folder / ".writers.json"
    first = json.loads(path.read_text())["writers"][0]
    path.write_text(json.dumps([first | {"numpy": "1.0"}, first]))
    text = render_report(read_report(copy))
    assert "2 sets of versions or processors" in text
    assert re.search(r">writer 1\s*</th>.*>writer 2\s*</th>", text, re.DOTALL)
    assert '<td class="number">1.0</td>' in text
    for content in ("[", "[1]", None):
        path.unlink() if content is None else path.write_text(content)
        assert "The store does not say what wrote it" in render_report(read_report(copy))


@pytest.mark.parametrize(
    ("ended", "words"),
    [({"timed_out": 2, "crashed": 1}, "2 timed_out, 1 crashed"), ({"crashed": 1}, "1 crashed")],
)
def test_what_a_clock_ended_is_not_promised_to_come_again(data, ended, words):
    runs = tuple(replace(run, outcomes={**run.outcomes, **ended}) for run in data.runs[:1])
    text = render_report(replace(data, runs=(*runs, *data.runs[1:])))
    warning = text[text.index('id="unrepeatable"') :]
    assert f"<li><b>nsga2-1</b>: {words}</li>" in warning
    assert "<b>complex-1</b>:" not in warning


def test_a_branch_is_said_not_to_come_out_anew(data, text):
    runs = (*data.runs, replace(data.runs[0], name="nsga2-1-branch-1"))
    assert 'id="branched"' not in text
    said = render_report(replace(data, runs=runs))
    assert "nsga2-1-branch-1: a run that another machine or version went on with." in said


# --- in a browser ---


@pytest.fixture(scope="module")
def page(opened, text):
    return opened(text, NO_WEBGL)


def test_the_campaign_is_saved_as_the_store_has_it(page, store, tmp_path):
    with page.page.expect_download() as started:
        page.page.locator("#save-campaign").click()
    assert started.value.suggested_filename == "campaign.yaml"
    path = tmp_path / "campaign.yaml"
    started.value.save_as(path)
    assert path.read_text("utf-8") == store.read_campaign()
    assert load_campaign(path) == parse_campaign(store.read_campaign())
    quiet(page)


def test_bars_are_as_high_as_their_shares(page, data):
    bars = "bars => bars.map(bar => [Number(bar.getAttribute('height')), bar.classList.contains('few')])"
    for place, along in enumerate(data.failing.along):
        found = page.page.eval_on_selector_all(f".histogram:nth-child({place + 1}) rect.failed", bars)
        parts = [part for part in along.parts if part.designs]
        heights = [78 * min(part.share / data.failing.top, 1.0) for part in parts]
        assert [height for height, _ in found] == pytest.approx(heights, abs=0.06)
        assert [few for _, few in found] == [part.designs < FEW for part in parts]


@pytest.mark.parametrize("width", [1200, 400])
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_nothing_is_wider_than_the_page(page, width, scheme):
    page.page.emulate_media(color_scheme=scheme)
    page.page.set_viewport_size({"width": width, "height": 900})

    def fits() -> None:
        assert page.page.evaluate(FITTING)
        assert page.page.evaluate("document.documentElement.scrollWidth") <= width

    eventually(page.page, fits)
    quiet(page)


def test_bars_follow_the_theme(page):
    def fill(scheme):
        page.page.emulate_media(color_scheme=scheme)
        bar = page.page.locator(".histogram rect.failed:not(.few)").first
        return bar.evaluate("bar => getComputedStyle(bar).fill")

    assert fill("light") != fill("dark")


def test_where_no_design_meets_a_goal_that_is_said(spheres):
    data = read_report(spheres(2, goal="{goal: 1e-9}"))
    assert (data.headline.met, data.headline.meeting) == (0, {})
    assert re.search(r"<dt>Goals on the front</dt>\s*<dd>No design meets any goal\.", render_report(data))


def test_the_response_has_the_selected_design_above_it(page, data):
    wanted = data.responses.designs[1].name
    page.page.select_option("#choice", wanted)
    assert page.page.locator("#response-title").inner_text() == f"Step response of {wanted}"
    assert page.title() == f"Selected design: {wanted}"
