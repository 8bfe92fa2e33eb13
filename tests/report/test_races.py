"""A report whose theme, medium, width and selection change at any moment: it settles as if each had come alone."""

import os
import random
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import pytest
from playwright.sync_api import Page

from browsing import NO_WEBGL, Opened, quiet
from divideropt.report.data import ReportData
from divideropt.report.page import render_report
from pagechecks import blank_figures

ROUNDS = int(os.environ.get("DIVIDEROPT_RACES", "12"))
"""Rounds of changes; each is checked once it has settled."""

WIDTHS = (703, 1280, 980)
"""Of windows and paper [px]."""

MISFITS = """() => [...document.querySelectorAll(".plot:has(.main-svg)")].filter((e) => e.clientWidth)
    .map((e) => [e.id, e.querySelector(".main-svg").getAttribute("width"), e.clientWidth])
    .filter(([, drawn, own]) => Math.abs(drawn - own) >= 1)"""
"""Figures that are not as wide as their places."""

OFF_COLOUR = """() => {
    const probe = document.body.appendChild(document.createElement("span"));
    probe.style.color = "var(--ink)";
    const ink = getComputedStyle(probe).color;
    probe.remove();
    return [...document.querySelectorAll(".plot .xtick text")].filter((e) => e.style.fill !== ink)
        .map((e) => `${e.closest(".plot").id}: ${e.style.fill}, not ${ink}`);
}"""
"""Figures whose text has another colour than the page's."""

COUNTS = """() => [
    Number(document.getElementById("parallel").dataset.selected),
    ...[...document.querySelectorAll(".projection")].map((e) => Number(e.dataset.selected)),
    document.querySelectorAll("#front-table tr[aria-selected=true]").length,
    location.hash === "" ? 0 : location.hash.replace(/&.*/, "").split(",").flatMap((run) => run.split(".")).length,
]"""
"""How many designs each view tells from the others."""


@contextmanager
def busy(processes: int) -> Iterator[None]:
    """Keep the machine's cores busy."""
    loops = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(processes)]
    try:
        yield
    finally:
        for loop in loops:
            loop.kill()
            loop.wait()


def change(page: Page, source: random.Random) -> str:
    """Change one thing at random; return what."""
    kind = source.choice(["scheme", "medium", "width", "row", "brush", "escape"])
    if kind == "scheme":
        page.emulate_media(color_scheme=source.choice(["light", "dark"]))
    elif kind == "medium":
        page.emulate_media(media=source.choice(["screen", "print"]))
    elif kind == "width":
        page.set_viewport_size({"width": source.choice(WIDTHS), "height": 900})
    elif kind == "row":
        page.evaluate("i => document.querySelectorAll('#front-table tbody tr')[i].click()", source.randrange(5))
    elif kind == "brush":
        key = source.choice(["PageUp", "PageDown"])
        page.evaluate(
            "key => document.querySelector('[data-end=lower0]').dispatchEvent(new KeyboardEvent('keydown', { key }))",
            key,
        )
    else:
        page.keyboard.press("Escape")
    return kind


@pytest.mark.slow
def test_changes_at_any_moment_settle(opened: Callable[..., Opened], data: ReportData):
    found = opened(render_report(data), NO_WEBGL)
    source = random.Random(8)
    with busy(3):
        for _ in range(ROUNDS):
            done = []
            for _ in range(source.randint(2, 8)):
                done.append(change(found.page, source))
                found.page.wait_for_timeout(source.uniform(0, 300))
            found.page.wait_for_timeout(600)
            found.settled()
            assert found.page.evaluate(MISFITS) == [], done
            assert found.page.evaluate(OFF_COLOUR) == [], done
            assert len(set(found.page.evaluate(COUNTS))) == 1, done
            found.page.keyboard.press("Escape")  # what is not selected is nearly grey
            found.settled()
            assert blank_figures(found.page) == [], done
    quiet(found)
