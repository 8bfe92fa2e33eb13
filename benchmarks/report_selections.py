"""How soon a report answers each kind of selection: a brush, a box, a row, and Escape; used by report_page.py."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from statistics import median

from playwright.sync_api import CDPSession, Page

LULL = 1200
"""How long the page is left alone before each selection [ms]."""

WATCH = """
window.seen = () => {
    const count = (text) => (text === "" ? 0 : Number(text));
    const told = document.getElementById("announced").textContent;
    const others = /and (\\d+) other/.exec(document.getElementById("selected-title").textContent);
    const lines = count(document.getElementById("parallel").dataset.selected);
    const address = location.hash.replace(/&.*/, "").split(",").flatMap((run) => run.split("."));
    const plots = [...document.querySelectorAll(".projection")];
    const more = (found) => (found ? Math.max(lines, 2) : Math.min(lines, 1));
    return {
        first: [/^\\d/.test(told) ? Number.parseInt(told) : 0, ...plots.map((plot) => count(plot.dataset.selected))],
        then: [
            others ? Number(others[1]) + 1 : Math.min(lines, 1),
            location.hash === "" ? 0 : address.length,
            document.querySelector("#front-table tr[aria-selected=true]") ? lines : 0,
            more(/other/.test(document.querySelector("#response .legend").textContent)),
            more(!document.getElementById("comparison").hidden),
        ],
        lines,
    };
};
window.timed = (kind) => {
    window.answer = new Promise((done) => addEventListener(kind, (event) => {
        const [before, begin] = [window.seen().lines, event.timeStamp];
        let first = null;
        const ask = () => {
            const now = window.seen();
            const changed = now.lines !== before && now.first.every((count) => count === now.lines);
            const settled = changed && now.then.every((count) => count === now.lines);
            setTimeout(() => { // what was seen is on the screen
                if (changed) first ??= performance.now() - begin;
                if (settled) done([first, performance.now() - begin, now.lines]);
                else requestAnimationFrame(ask);
            });
        };
        requestAnimationFrame(ask);
    }, { capture: true, once: true }));
};
"""
"""Waits for an input; then how long until lines, points and bar tell another count, and until all views do [ms]."""


@dataclass(frozen=True)
class Answer:
    """How soon a selection was followed, since the input [s].

    Attributes:
        first: Until the lines, the projections' points and the count in the bar have followed.
        settled: Until every view has, the response and the address among them.
        thread: Processor time of the page's main thread.
        selected: Designs that are selected then.
    """

    first: float
    settled: float
    thread: float
    selected: int


def answers(page: Page, session: CDPSession) -> dict[str, Answer]:
    """Select in each way, nothing being selected before, and let go; the page has been drawn, with `WATCH` in it."""
    kinds = {"a brush": ("keydown", _brush, "#parallel"), "a box": ("mouseup", _box, "#projection-0-1")}
    kinds["a row"] = ("click", _row, "#front-table")
    found = {}
    for name, (event, act, place) in kinds.items():
        page.evaluate("(place) => document.querySelector(place).scrollIntoView({ behavior: 'instant' })", place)
        found[name] = _answer(page, session, event, act)
        found[f"Escape after {name}"] = _answer(page, session, "keydown", lambda p: p.keyboard.press("Escape"))
    return found


def works(session: CDPSession) -> float:
    """Processor time of the page's main thread since the navigation [s]."""
    metrics = {metric["name"]: metric["value"] for metric in session.send("Performance.getMetrics")["metrics"]}
    return float(metrics["TaskDuration"])


def worded(pages: Mapping[str, Sequence[Mapping[str, Answer]]]) -> Iterator[str]:
    """Word the medians of each page's loads, as Markdown."""
    yield "| selection | designs | page | first | all | thread |"
    yield "| --- | --- | --- | --- | --- | --- |"
    for kind in next(iter(pages.values()))[0]:
        for name, loads in pages.items():
            times = [median(getattr(load[kind], key) for load in loads) for key in ("first", "settled", "thread")]
            yield f"| {kind} | {loads[0][kind].selected} | {name} | " + " | ".join(f"{t:.2f} s" for t in times) + " |"


def _answer(page: Page, session: CDPSession, event: str, act: Callable[[Page], None]) -> Answer:
    page.wait_for_timeout(LULL)
    page.evaluate("kind => window.timed(kind)", event)
    before = works(session)
    act(page)
    first, settled, count = page.evaluate("window.answer")
    return Answer(first / 1e3, settled / 1e3, works(session) - before, int(count))


def _brush(page: Page) -> None:
    page.locator("[data-end=lower0]").press("Shift+PageUp")


def _box(page: Page) -> None:
    """Draw a box over the left half of a projection."""
    area = page.locator("#projection-0-1 .nsewdrag").first.bounding_box()
    assert area
    page.mouse.move(area["x"] + 2, area["y"] + 2)
    page.mouse.down()
    page.mouse.move(area["x"] + area["width"] / 3, area["y"] + area["height"] / 2)
    page.mouse.move(area["x"] + area["width"] / 2, area["y"] + area["height"] - 2)
    page.mouse.up()


def _row(page: Page) -> None:
    page.locator("#front-table tbody tr").nth(3).click()
