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
from divideropt.report.sheets import read_sheets
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
    """The drawing as on the page: for every design that it has, and as rounded."""
    candidates = [candidate.design for candidate in data.choosing.candidates] if data.choosing else []
    variables = np.array([design.variables for design in (*data.front, *data.best, *candidates)])
    columns = {
        name: np.concatenate([column, [valve.dimensions[name] for valve in data.sheets.valves]])
        for name, column in data.sketches.measured(variables).items()
    }
    return lay_out(data.sketches.model.sketch, data.sketches.model.dimensions, columns)


def pick(report: Opened, *ids: str, step: str = "0") -> None:
    """Select designs, the first to be shown closely, as they are or rounded to a step."""
    if report.count("#step"):
        report.page.locator("#step").select_option(step)
    report.visit(f"#select={','.join(ids)}&show={ids[0]}")
    expect(report.page.locator("#sketch-said")).to_contain_text(ids[0])


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
    rows = len(ids) + len(data.sheets.valves)
    assert {design.design_id for design in (*data.front, *data.best)} <= set(ids)
    for column in columns:
        assert isinstance(column, float | int) or "of" in column or len(column) == rows
    assert sum(isinstance(column, list) for column in columns) <= 9
    place = payload["sketch"]["names"].index("groove width")
    for design, width in zip(ids, columns[place][: len(ids)], strict=True):
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
    pick(report, design, step="2")
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


def test_the_drawing_is_that_of_the_dimensions_beside_it_and_says_the_step(
    report: Opened, data: ReportData, store: Store
) -> None:
    design = next(iter(data.sheets.designs))
    drawn = {}
    for place, step in (("0", None), ("2", "0.1 mm"), ("3", "0.5 mm")):
        pick(report, design, step=place)
        found = sheet(store.folder, design, step=step)
        sizes = (found.rounded or found.exact).dimensions
        how = "as it is" if step is None else f"rounded to {step}"
        expect(report.page.locator("#sketch-said")).to_have_text(f"Design {design}, drawn to scale, {how}.")
        labels = report.page.evaluate(LENGTHS)
        for symbol, name in (("2r", "spool_diameter"), ("b", "groove_width"), ("2rv", "port_diameter")):
            said = next(text for text in labels if text.startswith(f"{symbol} = "))
            length = float(said.removeprefix(f"{symbol} = ").removesuffix(" mm"))
            assert length == pytest.approx(sizes[name] * 1e3, rel=2e-4)
        width = report.page.evaluate(BOXES)[4][1] / scale(report)
        assert width == pytest.approx(sizes["spool_diameter"], rel=2e-3)
        drawn[place] = report.page.locator("#sketch-drawn").inner_html()
        titles = report.page.locator("#sheet-lines thead th").all_text_contents()
        assert titles == 2 * (["as it is"] if step is None else ["as it is", "rounded"])
    assert len(set(drawn.values())) == 3
    pick(report, design, step="0")
    assert report.page.locator("#sheet-command").text_content() == f"divideropt sheet . {design}"
    with report.page.expect_download() as saved:
        report.page.locator("#sheet-csv").click()
    assert list(pd.read_csv(saved.value.path()).columns) == ["section", "name", "symbol", "unit", "exact"]
    pick(report, design, step="3")
    with report.page.expect_download() as saved:
        report.page.locator("#sheet-svg").click()
    texts = ET.parse(saved.value.path()).getroot().iter("{http://www.w3.org/2000/svg}text")
    words = ["".join(text.itertext()) for text in texts]
    assert f"Design {design} of small, drawn rounded to 0.5 mm" in words
    assert f"2r = {sizes['spool_diameter'] * 1e3:.4g} mm" in words, "the last of those above"


def test_a_design_without_a_sheet_is_drawn_as_it_is_and_says_so(
    opened: Callable[..., Opened], data: ReportData
) -> None:
    first, *others = data.sheets.designs
    fewer = replace(data.sheets, designs={name: data.sheets.designs[name] for name in others})
    found = opened(render_report(replace(data, sheets=fewer)), NO_WEBGL)
    pick(found, first, step="2")
    expect(found.page.locator("#sketch-said")).to_contain_text("since the page has no rounded dimensions of it")
    expect(found.page.locator("#sheet-said")).to_contain_text(f"The page holds no sheet of {first}")
    assert found.page.locator("#sheet-command").text_content() == f"divideropt sheet . {first} --step '0.1 mm'"
    quiet(found)


def test_what_is_not_simulated_has_its_dimensions_and_says_so(
    opened: Callable[..., Opened], data: ReportData
) -> None:
    design, row = next(iter(data.sheets.designs.items()))
    columns = (*row[:2], replace(row[2], judged=None), row[3])
    some = replace(data.sheets, designs={**data.sheets.designs, design: columns}, weight=65)
    found = opened(render_report(replace(data, sheets=some)), NO_WEBGL)
    pick(found, design, step="2")
    expect(found.page.locator("#sheet-said")).to_contain_text("Rounded to 0.1 mm: simulated not in this page")
    cells = found.page.locator("#sheet-lines tbody tr").all_inner_texts()
    assert next(cell for cell in cells if cell.startswith("spool diameter")).split("\t")[3] == (
        f"{row[2].dimensions['spool_diameter'] * 1e3:.6g}"
    )
    assert next(cell for cell in cells if cell.startswith("steady state error")).split("\t")[3] == "–"
    count = len(some.designs)
    expect(found.page.locator("#sheet-count")).to_contain_text(
        f"to 0.01 mm of {count}, to 0.1 mm of {count - 1} and to 0.5 mm of {count}: a design takes 65 simulations"
    )
    quiet(found)


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
    design = next(iter(data.sheets.designs))
    named = {
        name: [replace(column, dimensions={**column.dimensions, HOSTILE: 0.01}) for column in row]
        for name, row in data.sheets.designs.items()
    }
    broken = {**named, design: (*named[design][:3], HOSTILE)}
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
    pick(found, design, step="3")
    expect(found.page.locator("#sheet-said")).to_contain_text(f"there is no such valve: {HOSTILE}")
    expect(found.page.locator("#sketch-said")).to_contain_text("since rounded to 0.5 mm there is no such valve")
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


def test_sheets_cost_no_more_than_a_few_simulations(
    store: Store, data: ReportData, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("divideropt.report.sheets.MOST_SIMULATED", 60)
    problem = build_problem(stored_campaign(store))
    designs = [replace(data.front[0], design_id=f"nsga2-1/{i}") for i in range(9)]
    known = problem.simulate(np.array([design.variables for design in designs]))
    found = read_sheets(problem, designs, known)
    assert (found.simulated, found.weight) == ((9, 9, 9), 1)
    sources = (Source("density", Uniform(800.0, 900.0)),)
    uncertain = replace(problem, model=under_uncertainty(problem.model, sources, 4, 1))
    known = uncertain.simulate(np.array([design.variables for design in designs]))
    found = read_sheets(uncertain, designs, known)
    assert (found.simulated, found.weight) == ((2, 9, 1), 5), "12 rounded designs, to 0.1 mm first"
    assert list(found.designs) == [design.design_id for design in designs]
    assert all(not isinstance(column, str) for row in found.designs.values() for column in row)
    uncertain = replace(problem, model=under_uncertainty(problem.model, sources, 64, 1))
    found = read_sheets(uncertain, designs[:1], known.part(0, 1))
    assert found.simulated == (0, 0, 0)
    assert found.designs["nsga2-1/0"][2].dimensions["spool_diameter"] > 0.0
    assert read_sheets(problem, [], known.part(0, 0)) is None
