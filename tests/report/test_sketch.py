"""Sketch and dimension sheet of a report: to scale, for every design, following the selection, saved to files."""

import json
import math
import re
import xml.etree.ElementTree as ET
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from playwright.sync_api import expect

from browsing import NO_WEBGL, Opened, quiet
from divideropt.campaign.load import stored_campaign
from divideropt.campaign.plan import build_problem, dimensioned
from divideropt.campaign.sheet import sheet
from divideropt.models.dimensions import Dimension, Kind, Measure, Shape, Sketch, View, circle, the
from divideropt.models.distributions import Uniform
from divideropt.models.divider import PARAMETERS
from divideropt.models.uncertain import Source, under_uncertainty
from divideropt.report.data import ReportData, read_report
from divideropt.report.page import render_report
from divideropt.report.sheets import MOST_SIMULATED, read_sheets
from divideropt.report.sketch_layout import Drawing, lay_out
from divideropt.report.sketch_svg import draw
from divideropt.report.sketches import sketch_payload
from divideropt.store import Store

NUMBER = re.compile(r"-?[0-9]+\.[0-9]+")

BOXES = """() => [...document.querySelectorAll("#sketch-drawn > path.steel, #sketch-drawn > path.edge")]
    .map((path) => path.getBBox()).map(({ width, height }) => [width, height])"""
"""Widths and heights: stems and necks, the middle land, the outer lands, then the rims of the ports."""

LENGTHS = """() => [...document.querySelectorAll("#sketch-drawn > text.label")].map((text) => text.textContent)"""


@pytest.fixture(scope="module")
def page_text(data: ReportData) -> str:
    return render_report(data)


@pytest.fixture(scope="module")
def report(opened: Callable[..., Opened], page_text: str) -> Opened:
    return opened(page_text, NO_WEBGL)


@pytest.fixture(scope="module")
def known(store: Store, data: ReportData) -> dict[str, dict[str, float]]:
    """The dimensions of each design of the front, measured here."""
    problem = build_problem(stored_campaign(store))
    model = dimensioned(problem.model)
    found = {}
    for design in data.front:
        p = dict(problem.fixed) | dict(zip(problem.space.names, design.variables, strict=True))
        row = model.measured(np.array([[p[name] for name in PARAMETERS]]))[0]
        found[design.design_id] = dict(zip(model.dimensions, row.tolist(), strict=True))
    return found


def variables_of(data: ReportData) -> np.ndarray:
    return np.array([design.variables for design in data.front])


def laid_out(data: ReportData) -> Drawing:
    """The drawing as on the page: for every design that it has."""
    candidates = [candidate.design for candidate in data.choosing.candidates] if data.choosing else []
    variables = np.array([design.variables for design in (*data.front, *data.best, *candidates)])
    return lay_out(data.sketches.model.sketch, data.sketches.model.dimensions, data.sketches.measured(variables))


def pick(report: Opened, *ids: str) -> None:
    report.page.evaluate("(hash) => { location.hash = hash; }", f"#select={','.join(ids)}&show={ids[0]}")
    expect(report.page.locator("#sketch-title")).to_contain_text(ids[0])


def extremes(known: dict[str, dict[str, float]], name: str) -> tuple[str, str]:
    order = sorted(known, key=lambda design: known[design][name])
    return order[0], order[-1]


def scale(report: Opened) -> float:
    """Pixels a metre, from the scale bar of the first view."""
    width = report.page.locator("#sketch-drawn > path.bar").first.evaluate("(bar) => bar.getBBox().width")
    length = report.page.locator("#sketch-drawn > text.scale").first.text_content()
    return float(width) / (float(length.removesuffix(" mm")) * 1e-3)


def test_what_is_drawn_is_to_scale_and_another_design_is_drawn_otherwise(report: Opened, known) -> None:
    drawn = {}
    for design in extremes(known, "spool_diameter"):
        pick(report, design)
        boxes, d, px = report.page.evaluate(BOXES), known[design], scale(report)
        stem, _, neck, _, middle, outer, _, port, *_ = boxes
        for size, name in (
            (stem[1], "stem_diameter"), (2.0 * neck[1], "spool_diameter"), (middle[1], "spool_diameter"),
            (outer[1], "spool_diameter"), (outer[0], "drawn_outer_land"), (port[0], "port_diameter"),
            (middle[0], "drawn_middle_land"),
        ):  # fmt: skip
            assert size / px == pytest.approx(d[name], rel=2e-3, abs=3e-5), (design, name)
        drawn[design] = report.page.locator("#sketch-drawn").inner_html()
        words = report.page.locator("#sketch-words").text_content()
        assert f"spool diameter {d['spool_diameter'] * 1e3:.4g} mm" in words
        assert any(f"2r = {d['spool_diameter'] * 1e3:.4g} mm" in text for text in report.page.evaluate(LENGTHS))
    assert len(set(drawn.values())) == 2
    quiet(report)


def test_page_and_file_draw_the_same(report: Opened, data: ReportData, known) -> None:
    design = extremes(known, "groove_width")[1]
    pick(report, design)
    paths = report.page.eval_on_selector_all("#sketch-drawn > path", "all => all.map((p) => p.getAttribute('d'))")
    texts = report.page.eval_on_selector_all("#sketch-drawn > text", "all => all.map((t) => t.textContent)")
    mine = ET.fromstring(f"<svg>{draw(laid_out(data), known[design])}</svg>")
    theirs = [path.get("d") for path in mine.findall("path")]
    assert len(paths) == len(theirs) > 40
    for one, other in zip(paths, theirs, strict=True):
        assert NUMBER.sub("#", one) == NUMBER.sub("#", other)
        assert [float(n) for n in NUMBER.findall(one)] == pytest.approx(
            [float(n) for n in NUMBER.findall(other)], abs=0.2
        )
    words = ["".join(text.itertext()) for text in mine.findall("text")]
    assert [NUMBER.sub("#", text) for text in texts] == [NUMBER.sub("#", text) for text in words]
    for one, other in zip(texts, words, strict=True):
        assert [float(n) for n in NUMBER.findall(one)] == pytest.approx(
            [float(n) for n in NUMBER.findall(other)], rel=2e-4
        )


def test_every_design_that_can_be_selected_has_a_sketch(page_text: str, data: ReportData, known) -> None:
    payload = json.loads(re.search(r'id="report-data">(.*?)</script>', page_text, re.DOTALL)[1])
    columns, ids = payload["sketch"]["columns"], payload["designs"]["ids"]
    assert {design.design_id for design in (*data.front, *data.best)} <= set(ids)
    for column in columns:
        assert isinstance(column, float | int) or "of" in column or len(column) == len(ids)
    assert sum(isinstance(column, list) for column in columns) <= 8
    place = payload["sketch"]["names"].index("groove width")
    for design, width in zip(ids, columns[place], strict=True):
        if design in known:
            assert width == pytest.approx(known[design]["groove_width"] * 1e3, rel=1e-3)


def test_other_selected_designs_are_outlines(report: Opened, known) -> None:
    first, second = extremes(known, "spool_diameter")
    pick(report, first, second)
    assert report.count("#sketch-drawn > path.other") == 1
    expect(report.page.locator("#sketched-others")).to_contain_text("1 other selected design")
    height = report.page.locator("#sketch-drawn > path.other").evaluate("(path) => path.getBBox().height")
    assert height / scale(report) > known[second]["spool_diameter"]
    pick(report, first)
    assert report.count("#sketch-drawn > path.other") == 0


def test_the_sheet_is_that_of_the_command_and_its_files_can_be_read(
    report: Opened, data: ReportData, store: Store
) -> None:
    design = next(iter(data.sheets.designs))
    pick(report, design)
    report.page.locator("#step").select_option("2")
    found = sheet(store.folder, design, step="0.1 mm")
    with report.page.expect_download() as saved:
        report.page.locator("#sheet-csv").click()
    table = pd.read_csv(saved.value.path())
    assert saved.value.suggested_filename.endswith("-sheet.csv")
    numbers = table[table["section"] != "outcome"].astype({"exact": float, "rounded": float})
    sizes = numbers[~numbers["section"].isin(["parameters", "objectives", "constraints"])]
    for line in sizes.itertuples():
        assert line.exact == pytest.approx(found.exact.dimensions[line.name], rel=1e-5)
        assert line.rounded == pytest.approx(found.rounded.dimensions[line.name], rel=1e-5)
    objectives = numbers[numbers["section"] == "objectives"]
    assert list(objectives["rounded"]) == pytest.approx(list(found.rounded.objectives), rel=1e-5)
    assert table["rounded"].iloc[-1] == found.rounded.verdict.outcome
    with report.page.expect_download() as saved:
        report.page.locator("#sheet-svg").click()
    root = ET.parse(saved.value.path()).getroot()
    assert root.tag == "{http://www.w3.org/2000/svg}svg"
    text = " ".join(root.itertext())
    assert design in text
    assert "var(" not in text
    assert f"{found.rounded.dimensions['spool_diameter'] * 1e3:.6g}" in text


def test_another_step_is_another_column_and_the_command_says_it(report: Opened, data: ReportData) -> None:
    design = next(iter(data.sheets.designs))
    pick(report, design)
    said = []
    for place, step in (("1", "0.01 mm"), ("3", "0.5 mm")):
        report.page.locator("#step").select_option(place)
        said.append(report.page.locator("#sheet-lines").inner_text())
        assert report.page.locator("#sheet-command").text_content() == f"divideropt sheet . {design} --step '{step}'"
    assert said[0] != said[1]
    assert "goals met" in report.page.locator("#sheet-said").text_content()
    without = (
        next(d.design_id for d in data.front if d.design_id not in data.sheets.designs)
        if len(data.front) > len(data.sheets.designs)
        else None
    )
    assert without is None or without not in data.sheets.designs


def test_a_model_without_a_sketch_has_no_section(spheres: Callable[..., Store]) -> None:
    data = read_report(spheres(2))
    assert data.sketches is None
    assert data.sheets is None
    text = render_report(data)
    assert 'id="sketch"' not in text
    assert 'id="sheet"' not in text


HOSTILE = "</script><script>alert(1)</script>_x"


class Hostile:
    """A model that draws a circle, and words all that it can as an attack."""

    def __init__(self, model) -> None:
        self.parameters = model.parameters
        self.dimensions = {HOSTILE: Dimension(HOSTILE, "m", HOSTILE, HOSTILE, Kind.LENGTH)}
        x = the(HOSTILE)
        measure = Measure(HOSTILE, (x * 0.0, x), (x, x), "below")
        self.sketch = Sketch((View(HOSTILE, (Shape(circle(x, x, x), "steel"),), (measure,)),), (HOSTILE,), HOSTILE)

    def measured(self, designs):
        return designs[:, :1]


def test_words_of_a_model_are_text_and_a_step_that_makes_no_valve_is_said(
    opened: Callable[..., Opened], data: ReportData
) -> None:
    hostile = replace(data.sketches, model=Hostile(data.sketches.model))
    design, sheets = next(iter(data.sheets.designs.items()))
    broken = {**data.sheets.designs, design: (*sheets[:3], HOSTILE)}
    changed = replace(
        data,
        sketches=hostile,
        sheets=replace(data.sheets, designs=broken),
    )
    text = render_report(changed)
    assert text.count("</script>") == 3
    found = opened(text, NO_WEBGL)
    assert HOSTILE.replace("_", "") in found.page.locator("#sketch-drawn").text_content()
    columns = hostile.measured(variables_of(data))
    ET.fromstring(
        f"<svg>{draw(lay_out(hostile.model.sketch, hostile.model.dimensions, columns), {HOSTILE: 0.01})}</svg>"
    )
    pick(found, design)
    found.page.locator("#step").select_option("3")
    expect(found.page.locator("#sheet-said")).to_contain_text(f"there is no such valve: {HOSTILE}")
    quiet(found)


def test_what_is_the_same_or_in_proportion_is_stored_once(data: ReportData) -> None:
    payload = sketch_payload(data.sketches, variables_of(data))
    by_name = dict(zip(payload["names"], payload["columns"], strict=True))
    assert by_name["spool length"] == 100.0
    assert by_name["stem diameter"]["times"] == pytest.approx(0.3)
    assert by_name["groove depth"]["times"] == pytest.approx(math.sqrt(3.0) / 2.0)


def test_a_design_without_a_variable_has_no_drawing(data: ReportData) -> None:
    variables = variables_of(data)
    variables[1, 0] = np.nan
    columns = sketch_payload(data.sketches, variables)["columns"]
    lists = [column for column in columns if isinstance(column, list)]
    assert all(column[1] is None for column in lists)
    assert all(value is not None for column in lists for row, value in enumerate(column) if row != 1)
    assert sketch_payload(data.sketches, variables[1:2]) is None


def test_sheets_cost_no_more_than_a_few_simulations(store: Store, data: ReportData) -> None:
    problem = build_problem(stored_campaign(store))
    many = [data.front[0]] * (MOST_SIMULATED // 4 + 10)
    assert len(read_sheets(problem, many[:3]).designs) == 1
    named = [replace(design, design_id=f"nsga2-1/{i}") for i, design in enumerate(many)]
    assert len(read_sheets(problem, named).designs) == MOST_SIMULATED // 4
    sources = (Source("density", Uniform(800.0, 900.0)),)
    uncertain = replace(problem, model=under_uncertainty(problem.model, sources, MOST_SIMULATED // 8 - 1, 1))
    assert len(read_sheets(uncertain, named).designs) == 2
    uncertain = replace(problem, model=under_uncertainty(problem.model, sources, MOST_SIMULATED, 1))
    assert read_sheets(uncertain, named) is None
