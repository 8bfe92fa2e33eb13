"""What every page must be, whatever it shows: open to people with any tool, its figures drawn, its axes worded."""

import base64
import json
import re
from collections.abc import Iterator, Sequence
from importlib.resources import files
from typing import Any

from playwright.sync_api import Page

from browsing import Opened

AXE = files("axe_playwright_python").joinpath("axe.min.js").read_text("utf-8")
"""Evaluated by the browser's debugger, which no content security policy concerns: the page's own stays as it is."""

FINDINGS = """async () => {
    const drawings = { exclude: [".main-svg"] };
    const { violations } = await axe.run(drawings, { resultTypes: ["violations"] });
    return violations.flatMap(({ id, impact, nodes }) => nodes.map((node) => {
        const why = [...node.any, ...node.all, ...node.none].map((check) => check.message);
        return [impact, id, node.target.join(" "), ...why].join(" | ");
    }));
}"""

AREAS = """(element) => {
    const frame = element.getBoundingClientRect();
    const areas = [...element.querySelectorAll(".nsewdrag")].map((e) => e.getBoundingClientRect());
    const margin = areas.length ? 5 : 0;
    return (areas.length ? areas : [frame]).map(({ x, y, width, height }) =>
        [x - frame.x - margin, y - frame.y - margin, width + 2 * margin, height + 2 * margin]);
}"""
"""Where a figure draws its data: within the axes and on them, or where there are none all of it."""

COLOURED = """async ([png, areas, least]) => {
    const image = new Image();
    image.src = "data:image/png;base64," + png;
    await image.decode();
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [image.width, image.height];
    const context = canvas.getContext("2d");
    context.drawImage(image, 0, 0);
    return (areas || [[0, 0, image.width, image.height]]).map(([x, y, width, height]) => {
        const { data } = context.getImageData(x, y, Math.max(1, width), Math.max(1, height));
        let count = 0;
        for (let i = 0; i < data.length; i += 4) {
            const [red, green, blue] = data.subarray(i, i + 3);
            count += Math.max(red, green, blue) - Math.min(red, green, blue) > least;
        }
        return count;
    });
}"""
"""How many pixels of each area, or of all, have a colour, their channels so far apart at the least."""

COLOUR = 48
"""Text, grids and paper are nearly grey in either theme, data are not."""

FEWEST = 12
"""A small mark has some thirty pixels."""

DIMENSIONLESS = re.compile(
    r"(least )?[pq]\d|(hypervolume|IGD\+|ε|best max λ|(mean|worst) gap)( \((more|less) is better\))?|evaluations.*"
    r"|blocks|KKT residual|share of designs|part of the range.*|Sobol ind.*|μ\*|σ|lost"
)
"""Axes that need no unit: counts, shares, and what the tests' own models have."""


def findings(found: Opened, schemes: Sequence[str] = ("dark", "light")) -> list[str]:
    """What axe finds, of whatever weight, in either theme, with place and reason; what is folded away is opened."""
    found.page.evaluate("document.querySelectorAll('details').forEach(e => { e.open = true; })")
    found.page.evaluate(AXE)
    seen: list[str] = []
    for scheme in schemes:
        found.page.emulate_media(color_scheme=scheme)
        found.page.wait_for_function("document.getAnimations().length === 0")
        seen += [f"{scheme}: {finding}" for finding in found.page.evaluate(FINDINGS)]
    return seen


def blank_figures(page: Page, selector: str = ".plot[id], #parallel") -> list[str]:
    """The ids of figures that are shown, and have an area in which nothing is drawn."""
    return [name for name, counts in _coloured(page, selector).items() if min(counts) < FEWEST]


def _coloured(page: Page, selector: str) -> dict[str, list[int]]:
    """How many pixels have a colour in each area of each figure that is shown, by its id."""
    found = {}
    for figure in page.locator(selector).all():
        if not figure.is_visible():
            continue
        picture = base64.b64encode(figure.screenshot(animations="disabled")).decode()
        found[str(figure.get_attribute("id"))] = page.evaluate(COLOURED, [picture, figure.evaluate(AREAS), COLOUR])
    return found


def axes_without_words(text: str) -> list[str]:
    """Axes of a document's figures that say neither a unit in brackets nor what they count."""
    embedded = re.search(r'id="report-data">(.*?)</script>', text, re.DOTALL)
    assert embedded, "the document has its data"
    return [
        f"{figure['id']} {name}: {words!r}"
        for figure in json.loads(embedded[1])["figures"]
        for name, words in _axes_of_numbers(figure)
        if not (re.search(r"\[.+\]", words) or DIMENSIONLESS.fullmatch(words))
    ]


def _axes_of_numbers(figure: dict[str, Any]) -> Iterator[tuple[str, str]]:
    """Axes with numbers at them, and their words: their own, else the first panel's, else what stands above them."""
    layout = figure["layout"]
    axes = {**layout, **layout.get("scene", {})}
    above = {str(n): a["text"] for n, a in enumerate(layout.get("annotations", []), start=1)}
    for key in (name for name in axes if re.fullmatch(r"[xyz]axis\d*", name)):
        letter, number = key[0], key[5:]
        if axes[key].get("showticklabels") is False or _has_names(figure, letter, number) or _named(axes[key]):
            continue
        yield key, _title(axes[key]) or _title(axes[f"{letter}axis"]) or above.get(number or "1", "")


def _title(axis: dict[str, Any]) -> str:
    return str((axis.get("title") or {}).get("text") or "")


def _named(axis: dict[str, Any]) -> bool:
    return any(not re.fullmatch(r"\d+k?", text) for text in axis.get("ticktext", []))


def _has_names(figure: dict[str, Any], letter: str, number: str) -> bool:
    """Whether what is drawn on an axis has names there, not numbers."""
    values = [trace.get(letter) for trace in figure["data"] if trace.get(f"{letter}axis", letter) == letter + number]
    return any(isinstance(found, list) and any(isinstance(v, str) for v in found) for found in values)
