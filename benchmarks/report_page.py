"""What a large report weighs, and how soon a browser answers on it: 5,000 designs on the front, 30,000 evaluations.

    python benchmarks/report_page.py [--store DIR] [--loads N] [--against PAGE] [--write] [--profile FILE]

Makes a store, unless there is one, whose objectives are made up and whose responses are the valve's; writes its
report as `divideropt report` does; and opens it in headless Chromium, which computes WebGL with the processor. Prints
the page's bytes by part, and of each load when the page is drawn, and when a brush on an axis of the parallel
coordinates, made as soon as it is drawn and with them in view, is followed by every view and on the screen, both
since the navigation. Then how long another brush takes, and a third with the front in three dimensions in view. All
by the clock and in processor time of the page's main thread. Then of each kind of selection how long the first views
take to follow, and all of them (`report_selections.py`). `--against` names an older report's page, which takes turns
with it; `--write` puts the figures into `docs/benchmarks.md`; `--profile` writes a load's processor profile, as the
browser's own tools read it.
"""

import argparse
import json
import os
import re
import shutil
import statistics
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from playwright.sync_api import Browser, CDPSession, Page, sync_playwright
from report_selections import WATCH, Answer, answers, works
from report_selections import worded as worded_answers

from divideropt.campaign.dump import dump_campaign
from divideropt.campaign.load import parse_campaign
from divideropt.campaign.plan import build_problem, plan_runs
from divideropt.models import Outcome, Verdict
from divideropt.problem import Evaluations, Problem
from divideropt.report import write_report
from divideropt.store import Store, TableSchema

FRONT = 5000
"""Designs on the front; the evaluations are those of the campaign."""

FAILED, BROKEN = 0.2, 0.1
"""Shares of the other evaluations that fail, and that break the constraint."""

LIMITS = {"bytes": 9e6, "interactive": 3.0}
"""What a page is to stay below: bytes, and seconds."""

CAMPAIGN = """
name: large
model: {kind: divider, set: {radial_clearance: 3 um, rim_thickness: 0.8 mm}}
variables:
  spool_radius: [6 mm, 16 mm]
  groove_width: [0.6 mm, 2 mm]
  total_pressure_drop: [2 MPa, 10 MPa]
  fixed_drop_ratio: [0.3, 0.99]
  centred_opening: [0.1, 0.9]
objectives:
  steady_state_error: {goal: 0.5 %, weight: 3}
  dynamic_error: {goal: 0.5 mL, weight: 3}
  source_pressure: {goal: 18 MPa, weight: 1}
constraints: {stop_clearance: {min: 0 mm}}
reference_point: {steady_state_error: 10 %, dynamic_error: 10 mL, source_pressure: 30 MPa}
strategies:
  nsga2: {population: 100, generations: 100, seeds: [1, 2]}
  complex: {aggregate: goal_attainment, evaluations: 1000, seeds: [1, 2]}
  goal_attainment: {directions: 91, evaluations: 8000, seeds: [1]}
"""

IDEAL, REACH = np.array([0.1, 2e-7, 14e6]), np.array([4.0, 4e-6, 12e6])
"""The least of each objective on the front that is made up, and how far it goes [%, m³, Pa]."""

BENCHMARKS = Path(__file__).parents[1] / "docs" / "benchmarks.md"
BEGIN, END = (
    "<!-- report page: written by python benchmarks/report_page.py --write -->",
    "<!-- end of report page -->",
)

INTRODUCTION = """## A large report

`python benchmarks/report_page.py --write` makes a report of 5,000 designs on the front, all drawn, and 20,000 sampled
of the 25,000 evaluations that did not fail, opens it in headless Chromium and writes this section. Interactive is
when a brush on an axis, made as soon as the page is drawn, is followed by every view and on the screen: since the
navigation by the clock, and in processor time of the page's main thread, which counts where others use the machine. A
brush is timed from the key to the screen, with the 60 ms that the page waits for another. Then kinds of selection, in
medians since the input: until lines, points and the count in the bar have followed, and until all views have.
"""

PATIENCE = 120_000
"""How long a page may take [ms]."""

SETTLING = 3000
"""How long what is drawn in the background has [ms]."""

ANSWERED = """count => {
    const told = document.getElementById("announced").textContent.startsWith(count + " design");
    const rows = document.querySelectorAll("#front-table tr[aria-selected=true]").length > 0;
    const named = document.getElementById("selected-title").textContent.includes("and " + (count - 1) + " other");
    const lines = document.getElementById("parallel").dataset.selected === String(count);
    const projections = [...document.querySelectorAll(".projection")];
    const dotted = projections.length === 3 && projections.every((plot) => plot.dataset.selected === String(count));
    return told && rows && named && lines && dotted && location.hash.startsWith("#select=");
}"""
"""Whether every view shows so many designs as selected."""

PROBE = (
    """
window.answered = null;
window.brushed = (end, key, from) => new Promise((done) => {
    const handle = document.querySelector('[data-end="' + end + '"]');
    const begin = from ?? performance.now();
    handle.dispatchEvent(new KeyboardEvent("keydown", { key, shiftKey: true, bubbles: true }));
    const count = document.getElementById("parallel").dataset.selected;
    const answered = """
    + ANSWERED
    + """;
    const painted = () => setTimeout(() => done([performance.now() - begin, Number(count)]));
    const ask = () => requestAnimationFrame(answered(count) ? painted : ask);
    ask();
});
new MutationObserver((_, watcher) => {
    if (!document.documentElement.dataset.ready) return;
    watcher.disconnect();
    document.getElementById("parallel").scrollIntoView({ block: "center", behavior: "instant" });
    window.answered = window.brushed("lower0", "PageUp", 0);
}).observe(document, { attributes: true, subtree: true, attributeFilter: ["data-ready"] });
"""
)
"""Brushes as soon as the page is drawn; the promise has the time since the navigation [ms], and how many."""


@dataclass(frozen=True)
class Load:
    """One load of the page [s]; pairs are by the clock, and processor time of its main thread.

    Attributes:
        drawn: From the navigation until the page is drawn, by the clock.
        interactive: From there until the first brush is answered.
        brush: Another brush.
        with_front: A third, with the front in three dimensions in view.
        selected: Designs that the first brush selected.
        busy: How many processes wanted the machine's cores.
        answers: Each kind of selection, and how soon it was followed.
    """

    drawn: float
    interactive: tuple[float, float]
    brush: tuple[float, float]
    with_front: tuple[float, float]
    selected: int
    busy: float
    answers: Mapping[str, Answer]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--store", type=Path, help="where the store is, or is to be; else it is thrown away")
    parser.add_argument("--loads", type=int, default=5)
    parser.add_argument("--against", type=Path, help="an older report of the same store, to be measured in turns")
    parser.add_argument("--write", action="store_true", help="write the figures into docs/benchmarks.md")
    parser.add_argument("--profile", type=Path, help="where to write a processor profile of a load")
    chosen = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        store = Store(chosen.store or Path(folder) / "large")
        if not store.exists:
            make_store(store)
        page = write_report(store)
        with sync_playwright() as playwright:
            args = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
            browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=args)
            pages = {"this": page} | ({"before": chosen.against} if chosen.against else {})
            turns = [{name: measured(browser, path) for name, path in pages.items()} for _ in range(chosen.loads)]
            loads = [turn["this"] for turn in turns]
            if chosen.profile:
                chosen.profile.write_text(json.dumps(profiled(browser, page)))
            browser.close()
        selections = worded_answers({name: [turn[name].answers for turn in turns] for name in pages})
        text = "\n".join([*worded(page.read_text("utf-8"), loads), "", *selections]) + "\n"
    print(text)
    if chosen.write:
        write_section(text)


# --- the store ---


def make_store(store: Store) -> None:
    """Log every run's evaluations: a front in all objectives, and behind it what was tried on the way."""
    campaign = parse_campaign(CAMPAIGN)
    problem, runs = build_problem(campaign), plan_runs(campaign)
    random = np.random.default_rng(1)
    ends = np.cumsum([run.budget for run in runs])
    chosen = np.zeros(ends[-1], dtype=bool)
    chosen[random.choice(len(chosen), FRONT, replace=False)] = True
    store.write_campaign(dump_campaign(campaign))
    for run, on_front in zip(runs, np.split(chosen, ends[:-1]), strict=True):
        log = store.log(run.name, TableSchema.of(problem))
        for batch in batches(problem, on_front, random):
            log.append(batch)
        log.flush()


def batches(problem: Problem, on_front: NDArray[np.bool_], random: np.random.Generator) -> Iterator[Evaluations]:
    """Make up evaluations, a hundred at a time: on the front where told so, else behind it, ever nearer."""
    n, names, space = len(on_front), list(problem.model.quantities), problem.space
    directions = np.abs(random.normal(size=(n, 3)))
    places = 1.0 - directions / np.linalg.norm(directions, axis=1)[:, None]  # a sphere: none dominates another
    away = 0.1 + np.linspace(1.0, 0.2, n)[:, None] * random.exponential(size=(n, 3))
    places += np.where(on_front[:, None], 0.0, away)
    fate = np.where(on_front, 1.0, random.random(n))
    quantities = np.full((n, len(names)), np.nan)
    for objective, column in zip(problem.objectives, (IDEAL + REACH * places).T, strict=True):
        quantities[:, names.index(objective.quantity.name)] = column
    quantities[:, names.index("stop_clearance")] = np.where(fate < FAILED + BROKEN, -1e-4, 1e-4)
    quantities[fate < FAILED] = np.nan
    verdicts = [Verdict(Outcome.UNSETTLED, "made up") if f < FAILED else Verdict(Outcome.OK, "") for f in fate]
    designs = space.lower + random.random((n, len(space))) * (space.upper - space.lower)
    whole = Evaluations(designs, quantities, verdicts)
    for begin in range(0, n, 100):
        yield whole.part(begin, min(n, begin + 100))


# --- the page ---


def measured(browser: Browser, path: Path) -> Load:
    """Open the page and brush."""
    page = browser.new_page(viewport={"width": 1280, "height": 900})
    page.set_default_timeout(PATIENCE)
    page.add_init_script(PROBE + WATCH)
    session = page.context.new_cdp_session(page)
    session.send("Performance.enable", {"timeDomain": "threadTicks"})
    busy = os.getloadavg()[0]
    page.goto(path.as_uri(), wait_until="commit")
    page.wait_for_function("() => window.answered")
    first, count = page.evaluate("window.answered")
    drawn = float(page.evaluate("document.documentElement.dataset.ready"))
    interactive = works(session)
    page.wait_for_timeout(SETTLING)  # what is drawn when the browser is idle
    second = brushed(page, session, "lower2")
    page.wait_for_selector("#front[data-drawn]")
    page.locator("#front").scroll_into_view_if_needed()
    page.wait_for_timeout(SETTLING)
    third = brushed(page, session, "lower3")
    page.keyboard.press("Escape")
    found = answers(page, session)
    page.close()
    return Load(drawn / 1e3, (first / 1e3, interactive), second, third, int(count), busy, found)


def brushed(page: Page, session: CDPSession, end: str) -> tuple[float, float]:
    """Brush another axis; return how long until all views follow [s], and the main thread's part of it."""
    before = works(session)
    clock, _ = page.evaluate("end => window.brushed(end, 'PageUp')", end)
    return clock / 1e3, works(session) - before


def profiled(browser: Browser, path: Path) -> object:
    """Profile a load up to the first brush's answer."""
    page = browser.new_page(viewport={"width": 1280, "height": 900})
    page.set_default_timeout(PATIENCE)
    page.add_init_script(PROBE)
    session = page.context.new_cdp_session(page)
    session.send("Profiler.enable")
    session.send("Profiler.start")
    page.goto(path.as_uri(), wait_until="commit")
    page.wait_for_function("() => window.answered")
    page.evaluate("window.answered")
    return session.send("Profiler.stop")["profile"]


def worded(text: str, loads: Sequence[Load]) -> Iterator[str]:
    """Word what was measured, as Markdown."""
    parts = {
        "Plotly": len(max(re.findall(r"<script>.*?</script>", text, re.DOTALL), key=len).encode()),
        "data": weight(re.findall(r'<script type="application/json".*?</script>', text, re.DOTALL)),
        "tables": weight(re.findall(r"<table.*?</table>", text, re.DOTALL)),
    }
    whole = len(text.encode())
    yield "| part | MB |"
    yield "| --- | --- |"
    for name, size in [*parts.items(), ("rest", whole - sum(parts.values())), ("**page**", whole)]:
        yield f"| {name} | {size / 1e6:.2f} |"
    yield ""
    yield "| load | drawn | interactive | thread | a brush | thread | 3-D in view | thread | load average |"
    yield "| --- | --- | --- | --- | --- | --- | --- | --- | --- |"
    for i, load in enumerate(loads, 1):
        times = (load.drawn, *load.interactive, *load.brush, *load.with_front)
        yield f"| {i} | " + " | ".join(f"{seconds:.2f} s" for seconds in times) + f" | {load.busy:.1f} |"
    middle = statistics.median(load.interactive[0] for load in loads)
    yield ""
    yield (
        f"Interactive after {middle:.2f} s in the median, where {LIMITS['interactive']:.0f} s are asked for, and "
        f"{whole / 1e6:.2f} MB of {LIMITS['bytes'] / 1e6:.0f}. The first brush selected {loads[0].selected} designs."
    )


def write_section(text: str) -> None:
    """Put the figures into the page of benchmarks, in the place of older ones."""
    before, _, rest = BENCHMARKS.read_text("utf-8").partition(BEGIN)
    _, _, after = rest.partition(END)
    BENCHMARKS.write_text(f"{before.rstrip()}\n\n{BEGIN}\n\n{INTRODUCTION}\n{text}\n{END}\n{after}", "utf-8")


def weight(found: Sequence[str]) -> int:
    return sum(len(part.encode()) for part in found)


if __name__ == "__main__":
    main()
