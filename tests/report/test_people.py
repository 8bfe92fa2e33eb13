"""The report for people: by keys alone, in any theme, on narrow screens, in few colours, without motion, on paper."""

import math
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from browsing import FITTING, NO_WEBGL, Opened, eventually, quiet
from divideropt.report.data import ReportData
from divideropt.report.page import render_report
from pagechecks import axes_without_words, blank_figures, findings

HIDE = "document.querySelectorAll(':is(#projection-0-1, #parallel) canvas').forEach(c => c.toggleAttribute('hidden'))"
"""Takes away what two figures draw, and brings it back."""

MISLEAD = "name => document.querySelector('label:has(+ #choice)').setAttribute('for', name)"

OWN = """['response', 'projection-0-1'].map(id => document.getElementById(id))
    .map(e => [Math.round(e.querySelector('.main-svg').getAttribute('width')), e.clientWidth])"""
"""Of two figures, as wide as they are drawn, and as wide as their places."""

BEYOND = """() => [...document.querySelectorAll("main, main *")].filter((e) => {
    const { right, width } = e.getBoundingClientRect();
    return width > 0 && right > document.documentElement.clientWidth + 1
        && !e.parentElement.closest(".scroll, pre, .plot") && getComputedStyle(e).clipPath === "none";
}).map((e) => `${e.tagName}.${e.className}#${e.id}`)"""
"""What goes beyond the page's right edge, apart from what is in a frame that scrolls of itself."""

RING = """() => {
    const { outlineStyle, outlineWidth } = getComputedStyle(document.activeElement);
    return outlineStyle !== "none" && parseFloat(outlineWidth) > 0;
}"""
"""Whether the element with the focus shows it."""

TRANSITIONS = """() => [...document.querySelectorAll("*")].map((e) => getComputedStyle(e).transitionDuration)
    .filter((time) => parseFloat(time) > 0)"""


SHADES = """() => {
    const canvas = document.querySelector("#front canvas.printed");
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    const shades = [];
    for (let i = 0; i < data.length; i += 4) {
        const colour = data.subarray(i, i + 3);
        if (data[i + 3] > 200) shades.push([Math.min(...colour), Math.max(...colour)]);
    }
    return [shades.filter(([, most]) => most < 60).length, shades.filter(([least]) => least > 215).length];
}"""
"""How many pixels of the front as it is printed are dark, and how many light: paper's text and the screen's."""


@pytest.fixture(scope="module")
def report(opened: Callable[..., Opened], data: ReportData) -> Opened:
    return opened(render_report(data), NO_WEBGL)


@pytest.fixture
def page(report: Opened) -> Page:
    """The report's page, as it is at first."""
    report.page.set_viewport_size({"width": 1280, "height": 900})
    report.page.emulate_media(
        media="screen", color_scheme="light", forced_colors="none", reduced_motion="no-preference"
    )
    report.page.keyboard.press("Escape")
    expect(report.page.locator("#let-go")).to_be_hidden()
    report.settled()
    return report.page


def test_axe_finds_nothing_but_what_is_wrong(report, page):
    for row, keys in ((1, []), (3, ["Control"])):
        page.locator("#front-table tbody tr").nth(row).click(modifiers=keys)
    expect(page.locator("#compared tbody tr")).to_have_count(2)
    report.settled()
    assert findings(report) == []
    quiet(report)
    page.evaluate(MISLEAD, "nothing")
    assert {text.split(" | ")[1] for text in findings(report, ["light"])} == {"select-name"}
    page.evaluate(MISLEAD, "choice")


def test_every_figure_is_drawn_and_a_blank_one_is_found(page):
    assert blank_figures(page) == []
    page.evaluate(HIDE)
    assert blank_figures(page) == ["projection-0-1", "parallel"]
    page.evaluate(HIDE)


def test_every_axis_has_its_unit_and_one_without_is_found(data):
    text = render_report(data)
    assert axes_without_words(text) == []
    assert axes_without_words(text.replace("[ms]", ""))[0].startswith("response xaxis2: 'time since")


def test_keys_alone_lead_from_the_pages_start_to_a_design_and_its_response(report, page, data):
    page.goto(page.url.partition("#")[0])
    page.wait_for_selector("html[data-drawn]")
    before = report.lines()
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.className") == "skip"
    assert page.locator(".skip").bounding_box()["y"] >= 0, "it is seen while it has the focus"
    page.keyboard.press("Enter")
    for _ in range(30):
        page.keyboard.press("Tab")
        assert page.evaluate(RING), page.evaluate("document.activeElement.outerHTML.slice(0, 200)")
        if page.evaluate("document.activeElement.matches('#front-table tr')"):
            break
    page.keyboard.press("ArrowDown")
    page.keyboard.press("ArrowDown")
    page.keyboard.press("Enter")
    chosen = data.front[2].design_id
    expect(page.locator("#announced[role=status]")).to_contain_text(chosen)
    report.settled()
    assert page.evaluate("document.activeElement.getAttribute('data-id')") == chosen
    assert page.evaluate("document.activeElement.getAttribute('aria-selected')") == "true"
    assert chosen in report.title()

    def response() -> None:
        assert report.lines() != before
        assert page.locator("#response .legend").text_content().endswith(chosen)

    eventually(page, response)
    page.keyboard.press("Escape")
    expect(page.locator("#announced")).to_have_text("Nothing selected")
    page.keyboard.press("Tab")
    assert not page.evaluate("document.activeElement.matches('#front-table tr')"), "Tab leaves the table"
    quiet(report)


def test_every_place_that_tab_reaches_shows_that_it_has_the_focus(page):
    page.goto(page.url.partition("#")[0])
    page.wait_for_selector("html[data-drawn]")
    seen = set()
    for _ in range(400):
        page.keyboard.press("Tab")
        if page.evaluate("document.activeElement === document.body"):
            break
        seen.add(page.evaluate("document.activeElement.closest('[id]')?.id"))
        if page.evaluate("document.activeElement.matches('.end')"):
            drawn = page.evaluate("getComputedStyle(document.activeElement.firstElementChild).strokeWidth")
            assert drawn == "5px"
        else:
            assert page.evaluate(RING), page.evaluate("document.activeElement.outerHTML.slice(0, 200)")
    assert {"best", "choosing-table", "front-table", "choice"} <= seen


@pytest.mark.parametrize(("width", "zoom"), [(320, 1), (1280, 4), (1280, 2)])
def test_a_narrow_screen_or_a_large_zoom_scrolls_one_way(page, width, zoom):
    """1280 px at 400 % are 320 px (WCAG 2.2, 1.4.10)."""
    page.set_viewport_size({"width": width // zoom, "height": 700})

    def fits() -> None:
        assert page.evaluate(FITTING)
        assert page.evaluate(BEYOND) == []
        assert page.evaluate("document.documentElement.scrollWidth") <= width // zoom

    eventually(page, fits)
    assert page.locator("#front-table").bounding_box()["width"] > width // zoom, "the table scrolls in its frame"


def test_forced_colours_keep_the_marks_and_the_selection(page):
    page.emulate_media(forced_colors="active")
    assert blank_figures(page, "#projection-0-1, #parallel") == []
    page.locator("#front-table tbody tr").nth(2).click()
    expect(page.locator("#announced")).to_contain_text("1 design")
    style = "(e) => getComputedStyle(e).outlineStyle"
    rows = page.locator("#front-table tbody tr")
    assert rows.nth(2).evaluate(style) != "none"
    assert rows.nth(5).evaluate(style) == "none"
    fills = page.eval_on_selector_all(".key .mark", "ms => ms.map(m => getComputedStyle(m).fill)")
    assert len(set(fills)) > 1


def test_nothing_moves_for_who_wants_no_motion(page):
    page.emulate_media(reduced_motion="reduce")
    assert page.evaluate("getComputedStyle(document.documentElement).scrollBehavior") == "auto"
    page.locator("#front-table tbody tr").nth(2).click()
    durations = page.evaluate(TRANSITIONS)
    assert durations == []


def test_paper_is_light_and_has_everything_but_what_is_clicked(page):
    page.emulate_media(media="screen", color_scheme="dark")
    page.emulate_media(media="print", color_scheme="dark")
    page.set_viewport_size({"width": 703, "height": 1000})
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"

    def inked() -> None:
        ink = page.eval_on_selector_all("#projection-0-1 .xtick text", "ts => ts.map(t => t.style.fill)")
        assert set(ink) == {"rgb(0, 0, 0)"}

    eventually(page, inked)
    page.wait_for_function(FITTING)
    for hidden in ("nav", "#bar", ".skip", ".choose", ".modebar"):
        assert not page.locator(hidden).first.is_visible()
    assert page.locator("#campaign").is_visible(), "what is folded away is opened"
    assert page.evaluate(BEYOND) == []
    assert (
        page.evaluate(
            "[...document.querySelectorAll('.scroll')].filter(e => e.scrollWidth > e.clientWidth + 1).length"
        )
        == 0
    )
    assert blank_figures(page) == []


def test_the_print_has_as_many_pages_as_it_needs(page, tmp_path: Path):
    path = tmp_path / "report.pdf"
    height = page.evaluate("document.body.scrollHeight")
    page.pdf(path=path, format="A4", print_background=True)
    pages = len(re.findall(rb"/Type\s*/Page\b", path.read_bytes()))
    assert math.ceil(height / 2200) <= pages <= math.ceil(height / 700)


def test_figures_have_the_papers_width_when_printed_and_the_screens_again(page, tmp_path: Path):
    page.emulate_media(media="null")
    page.set_viewport_size({"width": 1280, "height": 900})
    page.evaluate(
        f"matchMedia('print').addEventListener('change', (e) => {{ if (e.matches) window.printed = {OWN}; }})"
    )
    page.pdf(path=tmp_path / "report.pdf", format="A4")
    printed = page.evaluate("window.printed")
    assert printed
    assert all(width == own for width, own in printed)

    def wide_again() -> None:  # plotly waits a tenth of a second
        assert all(width == own for width, own in page.evaluate(OWN))
        assert page.evaluate(OWN)[0][1] > printed[0][1]

    eventually(page, wide_again)


def test_figures_follow_paper_of_another_width(page):
    page.emulate_media(media="print")
    page.wait_for_function(FITTING)
    wide = page.evaluate(OWN)
    page.set_viewport_size({"width": 703, "height": 1000})

    def narrow() -> None:
        found = page.evaluate(OWN)
        assert all(width == own for width, own in found)
        assert found[0][1] < wide[0][1]

    eventually(page, narrow)
    assert blank_figures(page) == []


def test_the_front_in_three_dimensions_is_printed_in_papers_colours(opened, data, tmp_path: Path):
    page = opened(render_report(data)).page
    page.emulate_media(color_scheme="dark")
    page.wait_for_selector("#front[data-drawn]")
    page.evaluate("scrollTo(0, document.body.scrollHeight)")
    page.pdf(path=tmp_path / "report.pdf", format="A4")
    dark, light = page.evaluate(SHADES)
    assert dark > 100, "text"
    assert light == 0
    assert not page.locator("#front .printed").is_visible(), "the screen has the one that turns"


def test_a_figure_taller_than_paper_is_made_to_fit_a_page(opened, data):
    text = render_report(data)
    assert text.count('"height":520') == 1
    page = opened(text.replace('"height":520', '"height":2100'), NO_WEBGL).page
    tall = page.locator("#response")
    size = "e => [e.getBoundingClientRect().width, e.getBoundingClientRect().height]"
    wide, high = tall.evaluate(size)
    assert high == 2100
    page.emulate_media(media="print")
    page.set_viewport_size({"width": 703, "height": 1000})

    def fits() -> None:
        assert tall.evaluate(size) == pytest.approx([703, 900], abs=1)
        assert all(width == own for width, own in page.evaluate(OWN))

    eventually(page, fits)
    assert blank_figures(page, "#response") == []
    page.emulate_media(media="screen")
    page.set_viewport_size({"width": 1280, "height": 900})

    def as_before() -> None:
        assert tall.evaluate(size) == [wide, high]

    eventually(page, as_before)


def test_the_label_of_a_point_writes_numbers_as_the_page_does(opened, data):
    front = tuple(replace(d, objectives=(*d.objectives[:2], 1.23456e10)) for d in data.front)
    some = replace(data, front=front, best=(), choosing=None)
    found = opened(render_report(some), NO_WEBGL)
    place = found.page.locator("#projection-0-2")
    place.evaluate("e => e.scrollIntoView({ block: 'center', behavior: 'instant' })")
    point = found.dots("0-2")[0]
    found.page.mouse.move(point["x"] - 2, point["y"])
    found.page.mouse.move(point["x"], point["y"])
    expect(place.locator(".hoverlayer")).to_contain_text("source pressure 12346 MPa")


def test_a_number_is_written_alike_by_the_page_and_its_script(opened, data):
    sizes = (1.23456e10, 9.87654e12, 2.5e1, 0.0, -3.2e9)
    front = [replace(d, objectives=(*d.objectives[:2], size)) for d, size in zip(data.front, sizes, strict=False)]
    some = replace(data, front=tuple(front), drawn=tuple(range(len(front))), best=(), choosing=None)
    found = opened(render_report(some), NO_WEBGL)
    page = found.page
    heading = page.locator("#front-table thead th").all_text_contents()
    column = next(i for i, words in enumerate(heading) if words.strip().startswith("source pressure"))
    for row in page.locator("#front-table tbody tr").all():
        row.click()
        found.settled()
        written = row.locator("td").nth(column).text_content().strip("✓✗ \n")
        told = page.locator("#details div", has_text="source pressure").locator("dd").inner_text()
        assert re.split(r"\s*[✓✗]", told)[0] == written
