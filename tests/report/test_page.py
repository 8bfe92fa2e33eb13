"""The page in a browser: what is drawn, what a selection changes, and that nothing leaves the page."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from playwright.sync_api import expect

from browsing import NO_WEBGL, Opened, borne_out, eventually, into_view, quiet
from divideropt.campaign.load import default_campaign
from divideropt.campaign.simulate import simulate
from divideropt.report import Curve, ResponseCurves, response_page, write_response
from divideropt.report.convergence import tracks_of
from divideropt.report.data import ReportData
from divideropt.report.page import render_report
from pagechecks import axes_without_words, blank_figures, findings

HOSTILE = "</script><script>window.hacked=1</script>"
LINK = '<a href="https://example.org/">here</a>'


BESIDE = """([pair, places]) => {
    const canvas = document.querySelector(`#projection-${pair} canvas.all`);
    const box = canvas.getBoundingClientRect();
    const context = canvas.getContext("2d");
    const ratio = canvas.width / canvas.clientWidth;
    const { data, width, height } = context.getImageData(0, 0, canvas.width, canvas.height);
    const near = (x, y) => places.some(([a, b]) => Math.hypot(a - box.x - x / ratio, b - box.y - y / ratio) < 6);
    let count = 0;
    for (let y = 0; y < height; y += 1) {
        for (let x = 0; x < width; x += 1) if (data[4 * (y * width + x) + 3] && !near(x, y)) count += 1;
    }
    return count;
}"""
"""How many pixels of a projection have ink farther than a mark's size from every design."""


UNDER_POINTER = "(document.getElementById('projection-0-1')._hoverdata ?? []).map(point => point.customdata)"
"""What plotly knows to be under the pointer, and so would be clicked."""


@pytest.fixture(scope="module")
def report(opened: Callable[..., Opened], data: ReportData) -> Opened:
    return opened(render_report(data))


def test_nothing_leaves_the_page(report):
    report.page.wait_for_load_state("networkidle")
    quiet(report)


def test_no_button_shares(report):
    titles = report.page.evaluate(
        "[...document.querySelectorAll('.modebar-btn')].map(b => b.dataset.title + b.dataset.attr + b.outerHTML)"
    )
    assert titles, "the other buttons are there"
    for word in ("share", "cloud", "chart-studio", "plot.ly", "plotly.com"):
        assert not [t for t in titles if word in t.lower()]


def test_each_projection_has_a_point_a_design(report, data):
    for pair in ("0-1", "0-2", "1-2"):
        dots = report.dots(pair)
        assert sorted(dot["id"] for dot in dots) == sorted(design.design_id for design in data.front)
        borne_out(dots, [])
        beside = report.page.evaluate(BESIDE, [pair, [[dot["x"], dot["y"]] for dot in dots]])
        assert beside == 0, "no mark where no design is"


def test_the_front_is_drawn_in_three_dimensions(report):
    report.page.locator("#front").scroll_into_view_if_needed()
    report.page.wait_for_selector("#front[data-drawn]")
    assert blank_figures(report.page, "#front") == []
    hide = "show => { document.querySelector('#front canvas').style.visibility = show ? '' : 'hidden'; }"
    report.page.evaluate(hide, False)
    assert blank_figures(report.page, "#front") == ["front"], "what is blank is found"
    report.page.evaluate(hide, True)


def test_the_parallel_coordinates_are_drawn(report, data):
    assert report.count("#parallel .axis .heading") == len(data.variables) + len(data.objectives)


@pytest.mark.parametrize("track", ["hypervolume", "attainment"])
def test_each_run_has_a_line_of_convergence(report, data, track):
    assert report.count(f"#{track} .scatterlayer path.js-line") == len(data.runs), "each is its strategy's only one"


def test_each_strategy_has_a_line_of_residuals(report, data):
    strategies = {design.strategy for design in data.front if design.optimality is not None}
    assert report.count("#residuals .scatterlayer path.js-line") == len(strategies) > 0


def test_the_response_is_drawn_beside_the_three_sets(report):
    assert report.page.locator("#response").is_visible()
    assert len(report.lines()) == 2 + 2 * 3
    assert report.count("#response .legend .traces") == 4


def test_the_table_has_a_row_a_design(report, data):
    assert report.count("#front-table tbody tr") == len(data.front)


def test_another_row_changes_the_response(report, data):
    before = report.lines()
    report.page.locator("#front-table tbody tr").nth(3).click()
    expect(report.page.locator("#selected-title")).to_contain_text(_id(data, 3))

    def another() -> None:
        assert report.lines() != before
        assert len(report.lines()) == len(before)

    eventually(report.page, another)
    assert report.page.locator("#choice").input_value() == _id(data, 3)
    assert report.page.locator("tr[aria-current=true]").first.get_attribute("data-id") == _id(data, 3)


def test_the_list_and_the_keyboard_select_too(report, data):
    report.page.select_option("#choice", _id(data, 0))
    assert _id(data, 0) in report.title()
    report.page.locator("#front-table tbody tr").first.focus()
    report.page.keyboard.press("ArrowDown")
    report.page.keyboard.press("Enter")
    assert _id(data, 1) in report.title()


def test_a_click_on_a_point_selects_its_design(report, data):
    report.page.select_option("#choice", _id(data, 0))
    into_view(report, "#projection-0-1")
    highest = min(report.dots("0-1"), key=lambda dot: dot["y"])
    chosen = highest["x"], highest["y"]
    before = report.title()

    def noticed() -> None:
        report.page.mouse.move(chosen[0] - 2, chosen[1])
        report.page.mouse.move(*chosen)
        assert report.page.evaluate(UNDER_POINTER) == [highest["id"]]

    eventually(report.page, noticed)
    report.page.mouse.click(*chosen)
    expect(report.page.locator("#selected-title")).not_to_have_text(before)


def test_a_heading_sorts_by_its_column(report):
    column = "#front-table tbody tr td:nth-child(5)"
    heading = report.page.locator("#front-table th").nth(4)
    for order, direction in (("ascending", 1), ("descending", -1)):
        heading.locator("button").press("Enter")
        assert heading.get_attribute("aria-sort") == order
        values = [float(v) for v in report.page.eval_on_selector_all(column, "cs => cs.map(c => c.dataset.order)")]
        assert values == sorted(values, reverse=direction < 0)


def test_the_figures_follow_the_theme(report):
    def colours() -> list[str]:
        return report.page.eval_on_selector_all("#projection-0-1 .xtick text", "ts => ts.map(t => t.style.fill)")

    light = colours()
    assert light

    def dark() -> None:
        assert colours()
        assert set(light).isdisjoint(colours())

    def light_again() -> None:
        assert colours() == light

    report.page.emulate_media(color_scheme="dark")
    eventually(report.page, dark)
    report.page.emulate_media(color_scheme="light")
    eventually(report.page, light_again)


@pytest.fixture(scope="module")
def flat(opened: Callable[..., Opened], data: ReportData) -> Opened:
    """A report in a browser without WebGL, which holds one response only."""
    few = replace(data.responses, designs=data.responses.designs[:1])
    return opened(render_report(replace(data, responses=few)), NO_WEBGL)


def test_a_design_without_a_response_says_so(flat, data):
    kept = data.responses.designs[0].name
    name = next(d.design_id for d in data.front if d.design_id != kept)
    flat.page.locator(f'#front-table tr[data-id="{name}"]').click()
    flat.page.locator("#unstored").wait_for(state="visible")

    def lines() -> None:
        assert len([line for line in flat.lines() if line]) == 2 * 3

    eventually(flat.page, lines)
    assert flat.page.locator("#choice option:checked").inner_text() == f"{name} (no response in the page)"
    quiet(flat)


def test_without_webgl_a_sentence_stands_for_the_picture(flat, data):
    assert not flat.page.locator("#front").is_visible()
    assert flat.page.locator("#the-front .missing").is_visible()
    assert flat.count("#parallel .axis") == len(data.variables) + len(data.objectives)
    assert len([dot for dot in flat.dots("0-1") if dot["all"] > 0]) == len(data.front)
    quiet(flat)


def test_hostile_text_stays_text(opened, data):
    designs = tuple(replace(d, design_id=HOSTILE + d.design_id, strategy=LINK + d.strategy) for d in data.front)
    runs = tuple(replace(run, name=HOSTILE + LINK, strategy=LINK + run.strategy) for run in data.runs)
    objectives = tuple(replace(o, axis=replace(o.axis, words=HOSTILE + LINK, symbol=LINK)) for o in data.objectives)
    found = opened(
        render_report(
            replace(
                data,
                name=HOSTILE,
                campaign=HOSTILE,
                front=designs,
                sheets=None,
                runs=runs,
                objectives=objectives,
                tracks=tracks_of(runs, data.objectives),
                notes=(HOSTILE,),
            )
        ),
        NO_WEBGL,
    )
    assert found.page.evaluate("window.hacked") is None
    assert found.page.locator("h1").inner_text() == HOSTILE
    assert found.page.locator("#campaign").inner_text() == HOSTILE
    assert found.page.title().startswith(HOSTILE)
    quiet(found)


def test_an_injected_script_does_not_run(opened):
    text = response_page("x", ResponseCurves([0.0, 1.0], (Curve("x", "m", [0.0, 1.0]),)))
    found = opened(text.replace("</main>", "<script>window.hacked=1</script></main>"))
    assert found.page.evaluate("window.hacked") is None
    assert found.requests == []


def test_a_simulated_response_is_three_plots(opened, tmp_path: Path):
    path = write_response(simulate(default_campaign(), []), tmp_path / "x.html")
    found = opened(path.read_text("utf-8"))
    assert found.count("#curves .cartesianlayer > .subplot") == 3
    assert found.count("#curves .scatterlayer path.js-line") == 2 + 7 + 1
    assert found.page.locator("h1").inner_text() == "Response: ok"
    quiet(found)


def _id(data: ReportData, row: int) -> str:
    return data.front[row].design_id


def test_a_simulated_response_is_accessible_and_drawn(opened, tmp_path: Path):
    text = write_response(simulate(default_campaign(), []), tmp_path / "x.html").read_text("utf-8")
    assert axes_without_words(text) == []
    found = opened(text)
    assert findings(found) == []
    assert blank_figures(found.page) == []
