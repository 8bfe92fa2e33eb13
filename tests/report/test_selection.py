"""One selection that every view of the report follows: however it is made, in the address, and saved to files."""

import base64
import csv
import io
import json
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Browser, Page, expect
from ruamel.yaml import YAML

from browsing import FITTING, NO_WEBGL, PATIENCE, STILL, Opened, borne_out, eventually, into_view, quiet
from divideropt.campaign.designs import evaluate_designs, read_designs
from divideropt.campaign.load import parse_campaign, stored_campaign
from divideropt.campaign.plan import build_model
from divideropt.campaign.simulate import chosen_design
from divideropt.models.divider import PARAMETERS
from divideropt.models.divider.scenarios import BASE
from divideropt.report.data import ReportData, read_report
from divideropt.report.drawn import rows_drawn
from divideropt.report.page import render_report
from divideropt.report.tried import Tried
from divideropt.store import Store
from pagechecks import COLOURED

CAMPAIGN = """
name: pasted
model: {kind: divider, set: SET}
variables: {radial_clearance: [2 um, 4 um]}
objectives: {source_pressure: {goal: 18 MPa}}
strategies: {nsga2: {population: 8, generations: 2, seeds: [1]}}
"""

COUNTS = """() => ({
    lines: Number(document.querySelector("#parallel").dataset.selected || 0),
    projections: ["0-1", "0-2", "1-2"].map((pair) => document.getElementById(`projection-${pair}`).dataset.selected)
        .map((count) => (count === "" ? null : Number(count))),
    solid: document.getElementById("front").data?.find((trace) => trace.name === "chosen").x.length ?? null,
    rows: document.querySelectorAll("#front-table tr[aria-selected=true]").length,
    compared: document.querySelectorAll("#compared tbody tr").length,
    address: location.hash.replace(/&.*/, "").split(",").flatMap((run) => run.split(".")).length,
})"""
"""How many designs each view tells from the others."""

CLOUD = """pair => {
    const canvas = document.querySelector(`#projection-${pair} canvas.tried`);
    if (canvas.hidden || !canvas.width) return 0;
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    return data.filter((_, i) => i % 4 === 3 && data[i] > 0).length;
}"""
"""How many pixels of a projection have something on them that was tried."""

INK = """([from, to]) => {
    const canvas = document.querySelector("#parallel canvas.all");
    const [left, width] = [from, to - from].map((x) => Math.round(x * canvas.width / canvas.clientWidth));
    const { data } = canvas.getContext("2d").getImageData(left, 0, width, canvas.height);
    return data.filter((_, i) => i % 4 === 3 && data[i] > 0).length;
}"""
"""How many pixels between two places [px] have a line on them."""


CLICKS = """rows => rows.map((row) => {
    document.querySelectorAll("#front-table tbody tr")[row].click();
    const counts = ["parallel", "projection-0-1"].map((id) => document.getElementById(id).dataset.selected);
    return [...counts, document.getElementById("announced").textContent];
})"""
"""Clicks on rows in one go; what lines, points and bar tell in the very moment after each."""


@pytest.fixture(scope="module")
def page_text(data: ReportData) -> str:
    return render_report(data)


@pytest.fixture(scope="module")
def report(opened: Callable[..., Opened], page_text: str) -> Opened:
    """A report in a browser without WebGL, which is far quicker; its tests begin with nothing selected."""
    return opened(page_text, NO_WEBGL)


@pytest.fixture(autouse=True)
def nothing_selected(report: Opened) -> None:
    report.page.keyboard.press("Escape")
    expect(report.page.locator("#let-go")).to_be_hidden()
    report.settled()


def drag(found: Opened, begin: tuple[float, float], end: tuple[float, float]) -> None:
    mouse = found.page.mouse
    mouse.move(*begin)
    mouse.down()
    mouse.move((begin[0] + end[0]) / 2, (begin[1] + end[1]) / 2)
    mouse.move(*end)
    mouse.up()


def brush(found: Opened, axis: int, begin: float, end: float) -> None:
    """Drag along an axis, between shares of it from above."""
    into_view(found, "#parallel")
    box = found.page.locator("#parallel .axis .spine").nth(axis).bounding_box()
    drag(found, *((box["x"], box["y"] + share * box["height"]) for share in (begin, end)))


def told(found: Opened, count: int) -> None:
    """Wait until so many are announced, and every view has followed."""
    expect(found.page.locator("#announced")).to_contain_text(re.compile(rf"^{count or 'No'} design"))
    found.settled()


def followed(found: Opened, count: int) -> None:
    """Every view tells so many designs from the others, and has come to rest."""
    told(found, count)

    def views() -> None:
        seen = found.page.evaluate(COUNTS)
        compared = min(count, 12) if count > 1 else seen["compared"]
        assert seen == {
            "lines": count,
            "projections": [count] * 3,
            "solid": seen["solid"] if seen["solid"] is None else count,
            "rows": count,
            "compared": compared,
            "address": count,
        }
        rows = found.page.locator("#front-table tr[aria-selected=true]").evaluate_all(
            "rows => rows.map(r => r.dataset.id)"
        )
        for pair in ("0-1", "0-2", "1-2"):
            borne_out(found.dots(pair), rows)

    eventually(found.page, views)
    found.page.evaluate(STILL, "#parallel")


def upper_half(data: ReportData, axis: int) -> int:
    facts = data.variables[axis]
    middle = (facts.lower + facts.upper) / 2
    return sum(design.variables[axis] > middle for design in data.front)


def test_a_brush_is_followed_by_every_view(report, data):
    brush(report, 0, 0.5, -0.05)
    count = upper_half(data, 0)
    assert 1 < count < len(data.front)
    followed(report, count)

    def lines() -> None:
        assert len([line for line in report.lines() if line]) == 2 * 3 + 2 * count, "the sets, and each selected"

    eventually(report.page, lines)
    assert f"and {count - 1} other" in report.title()
    quiet(report)


def test_two_brushes_select_what_goes_through_both(report, data):
    brush(report, 0, 0.5, -0.05)
    brush(report, 2, 0.5, 1.05)
    middles = [(v.lower + v.upper) / 2 for v in data.variables]
    count = sum(d.variables[0] > middles[0] and d.variables[2] < middles[2] for d in data.front)
    followed(report, count) if count else told(report, 0)
    box = report.page.locator("#parallel .axis .spine").nth(2).bounding_box()
    report.page.mouse.click(box["x"], box["y"] + 0.1 * box["height"])
    followed(report, upper_half(data, 0))


def test_keys_brush_an_axis(report, data):
    report.page.get_by_role("slider", name="spool radius, lower end of the brush").focus()
    for _ in range(5):
        report.page.keyboard.press("PageUp")
    followed(report, upper_half(data, 0))
    end = report.page.get_by_role("slider", name="spool radius, lower end of the brush")
    assert end.get_attribute("aria-valuetext") == "11.00 mm"
    report.page.keyboard.press("Delete")
    expect(report.page.locator("#announced")).to_have_text("Nothing selected")
    assert report.page.evaluate(COUNTS)["projections"] == [None] * 3
    for pair in ("0-1", "0-2", "1-2"):
        borne_out(report.dots(pair), [])
    expect(report.page.locator("#projection-0-1 canvas.all")).to_have_css("opacity", "1")


def test_no_line_through_a_brush_is_no_design(report):
    report.page.get_by_role("slider", name="spool radius, lower end of the brush").press("End")
    told(report, 0)
    assert report.title() == "No design selected"
    assert report.page.locator("[data-save=csv]").is_disabled()
    report.page.keyboard.press("Escape")
    expect(report.page.locator("#announced")).to_have_text("Nothing selected")


def test_a_box_in_a_projection_selects_what_is_in_it(report, data):
    place = report.page.locator("#projection-0-1 .nsewdrag").first
    into_view(report, "#projection-0-1")
    box = place.bounding_box()
    right = box["x"] + 0.4 * box["width"]
    inside = [dot["x"] for dot in report.dots("0-1")]
    count = sum(x < right for x in inside)
    assert 1 < count < len(data.front)
    drag(report, (box["x"] + 1, box["y"] + 1), (right, box["y"] + box["height"] - 1))
    followed(report, count)
    farther = box["x"] + 0.7 * box["width"]
    drag(report, (right, box["y"] + box["height"] / 2), (farther, box["y"] + box["height"] / 2))
    followed(report, sum(x < farther for x in inside))
    brush(report, 0, 0.5, -0.05)
    followed(report, upper_half(data, 0))
    assert report.count("#projection-0-1 .selectionlayer path") == 0, "its outline is gone"


def test_a_lasso_selects_what_is_in_it(report, data):
    into_view(report, "#projection-0-2")
    dots = report.dots("0-2")
    report.page.evaluate("Plotly.relayout('projection-0-2', { dragmode: 'lasso' })")
    box = report.page.locator("#projection-0-2 .nsewdrag").first.bounding_box()
    left, top, bottom = box["x"] + 2, box["y"] + 2, box["y"] + box["height"] - 2
    middle = sorted(dot["x"] for dot in dots)[len(dots) // 2] + 0.5
    mouse = report.page.mouse
    mouse.move(left, top)
    mouse.down()
    for corner in ((left, bottom), (middle, bottom), (middle, top)):
        mouse.move(*corner, steps=8)
    mouse.up()
    inside = [dot["x"] < middle for dot in dots]
    assert 0 < sum(inside) < len(data.front)
    followed(report, sum(inside))
    report.page.evaluate("Plotly.relayout('projection-0-2', { dragmode: 'select' })")
    quiet(report)


def test_a_double_click_shows_all_that_was_tried_and_another_the_front(report, data):
    into_view(report, "#projection-0-1")
    shown = "() => document.getElementById('projection-0-1').layout.xaxis.range.map(Number)"
    front = report.page.evaluate(shown)
    double_click = "document.getElementById('projection-0-1').emit('plotly_deselect', null)"  # as plotly tells of one
    report.page.evaluate(double_click)
    report.page.wait_for_function(f"front => ({shown})()[1] > 1.2 * front[1]", arg=front)
    whole = report.page.evaluate(shown)
    largest = data.objectives[0].axis.scaled(data.tried.objectives[:, 0].max())
    assert whole[1] > largest > front[1]
    borne_out(report.dots("0-1"), [])
    report.page.evaluate(double_click)
    report.page.wait_for_function(f"front => String(({shown})()) === String(front)", arg=front)
    borne_out(report.dots("0-1"), [])
    quiet(report)


def test_what_was_tried_can_be_left_out(report):
    assert report.page.evaluate(CLOUD, "0-1") > 20
    box = report.page.get_by_label("What was tried")
    box.uncheck()
    assert report.page.evaluate(CLOUD, "0-1") == 0
    assert not report.page.locator("#projection-0-1 canvas.tried").is_visible()
    box.check()
    assert report.page.locator("#projection-0-1 canvas.tried").is_visible()


def test_a_projections_picture_has_its_points(report, tmp_path):
    into_view(report, "#projection-0-1")
    report.page.locator("#projection-0-1").hover()
    with report.page.expect_download() as waiting:
        report.page.locator("#projection-0-1 [data-title='Download plot as a PNG']").click()
    path = tmp_path / waiting.value.suggested_filename
    waiting.value.save_as(path)
    assert path.name == "projection-0-1.png"
    (inked,) = report.page.evaluate(COLOURED, [base64.b64encode(path.read_bytes()).decode(), None, 80])
    assert inked > 100, "the strategies' colours are in it, which only the canvases have"
    quiet(report)


def test_a_row_selects_and_another_joins(report, data):
    rows = report.page.locator("#front-table tbody tr")
    rows.nth(2).click()
    followed(report, 1)
    rows.nth(4).click(modifiers=["Control"])
    followed(report, 2)
    assert report.page.locator("#compared tbody tr").nth(1).get_attribute("data-id") == data.front[4].design_id
    rows.nth(2).click(modifiers=["Control"])
    followed(report, 1)
    assert data.front[4].design_id in report.title()


def test_what_was_selected_is_seen_at_once_and_the_last_selection_lasts(report, data):
    at_once = report.page.evaluate(CLICKS, [2, 4])
    assert at_once == [
        ["1", "1", f"1 design of {len(data.front)} selected: {data.front[i].design_id}"] for i in (2, 4)
    ]
    followed(report, 1)
    assert data.front[4].design_id in report.title()
    (row,) = report.page.locator("#front-table tr[aria-selected=true]").all()
    assert row.get_attribute("data-id") == data.front[4].design_id
    quiet(report)


def test_a_line_can_be_clicked(report, data):
    into_view(report, "#parallel")
    first, second = (report.page.locator("#parallel .axis .spine").nth(k).bounding_box() for k in (0, 1))
    design = data.front[0]
    shares = [(v.upper - x) / (v.upper - v.lower) for v, x in zip(data.variables, design.variables, strict=True)]
    height = sum(b["y"] + s * b["height"] for b, s in zip((first, second), shares, strict=False)) / 2
    report.page.mouse.click((first["x"] + second["x"]) / 2, height)
    followed(report, 1)


def test_keys_alone_select_a_design_and_its_response(report, data):
    held = {response.name for response in data.responses.designs}
    place = next(i for i in range(3, len(data.front)) if data.front[i].design_id in held)
    before = report.lines()
    report.page.locator("[data-save=csv]").evaluate(
        "() => document.querySelector('#front-table tr[tabindex=\"0\"]').focus()"
    )
    report.page.keyboard.press("Home")
    for _ in range(place):
        report.page.keyboard.press("ArrowDown")
    report.page.keyboard.press(" ")
    followed(report, 1)
    assert data.front[place].design_id in report.title()

    def another() -> None:
        assert report.lines() != before

    eventually(report.page, another)


def test_every_table_of_designs_is_reached_by_tab(report):
    for table in ("best", "choosing-table", "front-table"):
        assert report.count(f"#{table} tr[tabindex='0']") == 1


def test_a_headings_drag_moves_its_axis(report, data):
    headings = report.page.locator("#parallel .heading title")
    names = [facts.axis.label for facts in (*data.variables, *data.objectives)]
    expect(headings).to_have_text(names)
    into_view(report, "#parallel")
    heading = report.page.locator("#parallel .heading").first.bounding_box()
    third = report.page.locator("#parallel .axis .spine").nth(2).bounding_box()
    begin = heading["x"] + heading["width"] / 2, heading["y"] + 5
    drag(report, begin, (third["x"], begin[1]))
    expect(headings).to_have_text([*names[1:3], names[0], *names[3:]])
    report.page.get_by_role("slider", name="spool radius, lower end of the brush").focus()
    for _ in range(2):
        report.page.keyboard.press("Control+ArrowLeft")
    expect(headings).to_have_text(names)


def test_the_address_restores_a_selection(report, data):
    wanted = [data.front[i].design_id for i in (1, 5, 6)]
    report.visit(f"#select={','.join(wanted)}&show={wanted[2]}")
    followed(report, 3)
    assert wanted[2] in report.title()
    written = report.page.evaluate("location.hash")
    report.page.evaluate("document.querySelector('nav a').click()")
    expect(report.page).to_have_url(re.compile(re.escape(written)))
    report.page.reload()
    report.page.wait_for_selector("html[data-drawn]")
    followed(report, 3)
    assert wanted[2] in report.title()
    report.page.keyboard.press("Escape")
    report.settled()
    assert report.page.evaluate("location.hash") == ""
    quiet(report)


def test_designs_that_the_page_has_not_are_said(report, data):
    report.visit(f"#select={data.front[1].design_id},nsga2-9/1.2")
    expect(report.page.locator("#announced")).to_contain_text("2 of the 3 designs that the address names are not in")
    report.settled()
    assert report.page.evaluate(COUNTS)["rows"] == 1


HOSTILE_FRAGMENTS = (
    "#select=",
    "#select=__proto__/constructor",
    "#select=<img src=x onerror=window.hacked=1>",
    "#select=nsga2-1/1&show=<script>window.hacked=1</script>",
    "#select=nsga2-1/1/2",
    "#select=nsga2-1",
    "#select=nsga2-1/1&show=nsga2-1/1&show=x",
    "#select=nsga2-1/%00",
    "#select=" + "nsga2-1/1," * 40_000,
    "#javascript:window.hacked=1",
)


@pytest.mark.parametrize("fragment", HOSTILE_FRAGMENTS, ids=lambda text: text[:30])
def test_a_hostile_address_is_ignored(report, data, fragment):
    report.page.locator("#front-table tbody tr").nth(1).click()
    followed(report, 1)
    report.visit(fragment)
    followed(report, 1)
    assert data.front[1].design_id in report.title()
    assert report.page.evaluate("window.hacked ?? null") is None
    quiet(report)


def saved(found: Opened, kind: str, folder: Path) -> Path:
    with found.page.expect_download() as waiting:
        found.page.locator(f"[data-save={kind}]").click()
    path = folder / waiting.value.suggested_filename
    waiting.value.save_as(path)
    return path


def test_the_selection_is_saved_as_tables(report, data, store: Store, tmp_path):
    report.visit("#select=" + ",".join(_some(data)))
    told(report, 3)
    path = saved(report, "designs", tmp_path)
    assert path.name == "small-selection-designs.csv"
    designs = read_designs(path, list(PARAMETERS.values()))
    chosen = [design for design in data.front if design.design_id in _some(data)]
    assert designs.identities == tuple(design.design_id for design in chosen)
    assert [tuple(row) for row in designs.values] == [design.variables for design in chosen], "to the last bit"
    campaign = stored_campaign(store)
    again = evaluate_designs(designs, build_model(campaign), campaign.model.base_parameters())
    assert again["source_pressure"].tolist() == [design.objectives[2] for design in chosen]
    whole = saved(report, "csv", tmp_path).read_text().splitlines()
    assert whole[0].split(",")[-3:] == ["steady_state_error", "|dynamic_error|", "source_pressure"]
    assert [tuple(map(float, line.split(",")[-3:])) for line in whole[1:]] == [d.objectives for d in chosen]
    quiet(report)


def test_the_selection_is_saved_as_blocks_for_a_campaign(report, data, store: Store, tmp_path):
    report.visit("#select=" + ",".join(_some(data)))
    told(report, 3)
    text = saved(report, "yaml", tmp_path).read_text()
    chosen = [design for design in data.front if design.design_id in _some(data)]
    documents: list[Any] = list(YAML(typ="safe", pure=True).load_all(io.StringIO(text)))
    campaign = stored_campaign(store)
    commands = [line for line in text.splitlines() if line.startswith("# divideropt simulate")]
    for design, block, command in zip(chosen, documents, commands, strict=True):
        values = dict(zip((facts.axis.name for facts in data.variables), design.variables, strict=True))
        pasted = parse_campaign(CAMPAIGN.replace("SET", json.dumps(block["set"])))
        assert pasted.model.set == values, "to the last bit"
        settings = [f"{name}={value}" for name, value in re.findall(r"--set (\w+)='([^']*)'", command)]
        simulated = chosen_design(campaign, settings, BASE)[1]
        assert {name: simulated[name] for name in values} == values
    quiet(report)


def test_hostile_names_stay_in_their_cells_and_comments(opened, data, tmp_path):
    hostile = 'x\n=1+1,"\u2028</script>'
    front = data.variables[0]
    second = data.variables[1]
    named = (replace(v, axis=replace(v.axis, name=name)) for v, name in ((front, hostile), (second, "=1+1")))
    changed = replace(data, name=hostile, variables=(*named, *data.variables[2:]))
    found = opened(render_report(changed), NO_WEBGL)
    found.page.locator("#front-table tbody tr").first.click()
    told(found, 1)
    path = saved(found, "yaml", tmp_path)
    assert path.name == "x-1-1-script--selection.yaml"
    (block,) = YAML(typ="safe", pure=True).load_all(io.StringIO(path.read_text()))
    assert list(block) == ["set"]
    assert list(block["set"])[:2] == [hostile, "=1+1"]
    with saved(found, "designs", tmp_path).open(newline="") as file:
        heading, *_ = csv.reader(file)
    assert heading[:3] == ["design_id", hostile, "'=1+1"], "no spreadsheet computes a name"
    quiet(found)


def test_another_width_keeps_every_height_and_fits_the_paper(opened, page_text, data):
    found = opened(page_text, NO_WEBGL)
    heights = "() => [...document.querySelectorAll('.plot')].map(e => e.offsetHeight)"
    before = found.page.evaluate(heights)
    assert min(before[1:]) > 300
    found.page.emulate_media(media="print")
    found.page.set_viewport_size({"width": 703, "height": 1200})  # A4 within its margins
    expect(found.page.locator("#bar")).to_be_hidden()

    def fitting() -> None:
        assert found.page.evaluate(FITTING)
        assert found.page.evaluate(heights) == before
        assert found.page.locator("#parallel").bounding_box()["width"] == 703
        assert found.page.locator("#parallel .axis .spine").last.bounding_box()["x"] < 703

    eventually(found.page, fitting)
    quiet(found)


def test_a_missing_value_is_a_gap_in_its_line(opened, data):
    variables = (data.front[0].variables[0], float("nan"), *data.front[0].variables[2:])
    one = replace(data, front=(replace(data.front[0], variables=variables),), drawn=(0,), best=(), choosing=None)
    found = opened(render_report(one), NO_WEBGL)
    places = [box["x"] for box in (found.page.locator("#parallel .spine").nth(k).bounding_box() for k in range(5))]
    left = found.page.locator("#parallel").bounding_box()["x"]
    first, _, third, fourth, _ = (place - left for place in places)
    assert found.page.evaluate(INK, [first + 5, third - 5]) == 0, "nothing on either side of the axis without a value"
    assert found.page.evaluate(INK, [third + 5, fourth - 5]) > (fourth - third - 10) / 2
    assert found.page.evaluate(INK, [first - 5, first + 5]) > 0, "a value between gaps is a dot"
    slider = found.page.get_by_role("slider", name="groove width, lower end of the brush")
    slider.press("PageUp")
    told(found, 0)
    quiet(found)


def test_a_click_on_the_front_in_three_dimensions_selects(opened, data, page_text):
    found = opened(page_text)
    found.page.locator("#front").scroll_into_view_if_needed()
    found.page.wait_for_selector("#front[data-drawn]")
    chosen = data.front[3].design_id
    found.page.evaluate(
        "id => document.getElementById('front').emit('plotly_click', {points: [{customdata: id}]})", chosen
    )
    followed(found, 1)
    assert chosen in found.title()
    assert found.page.evaluate(
        "document.getElementById('front').data.slice(0, -2).every(trace => trace.opacity < 0.5)"
    )
    assert "unsafe-eval" not in page_text.partition("<style>")[0]
    quiet(found)


@pytest.mark.parametrize("objectives", [1, 4])
def test_a_front_without_goals_or_responses_is_linked_too(opened, spheres, objectives):
    data = read_report(spheres(objectives))
    found = opened(render_report(data), NO_WEBGL)
    assert found.count("#parallel .axis") == 3 + objectives
    slider = found.page.get_by_role("slider", name="p0, lower end of the brush")
    slider.press("PageUp")
    told(found, sum(design.variables[0] >= 0.1 for design in data.front))
    assert found.page.evaluate("location.hash").startswith("#select=nsga2-")
    quiet(found)


def test_a_front_of_five_thousand_is_light_and_drawn(browser: Browser, data: ReportData, tmp_path: Path):
    page = large_page(browser, data, tmp_path)
    assert (tmp_path / "large.html").stat().st_size < 9e6
    dots = Opened(page).dots("0-1")
    assert len(dots) == 5000
    borne_out(dots, [])
    assert page.evaluate(CLOUD, "0-1") > 1000, "what was tried is drawn, too"


def large_page(browser: Browser, data: ReportData, tmp_path: Path) -> Page:
    """Open the report of a front of 5,000 designs, drawn."""
    random = np.random.default_rng(1)
    front = tuple(replace(data.front[i % len(data.front)], design_id=f"nsga2-1/{i + 100}") for i in range(5000))
    shaken = random.normal(1.0, 0.02, (5000, 3))
    front = tuple(
        replace(design, objectives=tuple(float(q * s) for q, s in zip(design.objectives, row, strict=True)))
        for design, row in zip(front, shaken, strict=True)
    )
    path = tmp_path / "large.html"
    values = np.abs(random.normal(1.0, 0.5, (20_000, 3))) * data.front[0].objectives
    tried = Tried(values, random.random(20_000) > 0.1, 25_000, 3)
    text = render_report(replace(data, front=front, drawn=rows_drawn(front), tried=tried))
    path.write_text(text, encoding="utf-8")
    page = browser.new_page(viewport={"width": 1280, "height": 900})
    page.goto(path.as_uri(), timeout=PATIENCE)
    page.wait_for_selector("html[data-drawn]", timeout=PATIENCE)
    return page


def _some(data: ReportData) -> list[str]:
    return [data.front[i].design_id for i in (1, 5, 6)]
