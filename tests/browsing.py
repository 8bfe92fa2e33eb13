"""A document in a browser: what the tests of pages look at, and that it keeps quiet."""

import os
import shutil
import time
from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

import pytest
from playwright.sync_api import Browser, Page, sync_playwright

PATIENCE = 90_000
"""How long a page may take [ms]: without a graphics card, on a busy machine, WebGL alone takes ten seconds."""

NO_WEBGL = """const old = HTMLCanvasElement.prototype.getContext;
HTMLCanvasElement.prototype.getContext = function (kind, ...more) {
    return String(kind).includes("webgl") ? null : old.call(this, kind, ...more);
};"""
"""Makes a browser that lacks it, and is faster than one that computes it."""


DOTS = """pair => {
    const figure = document.getElementById("projection-" + pair);
    const box = figure.getBoundingClientRect();
    const { xaxis, yaxis } = figure._fullLayout;
    const pixels = (name) => {
        const canvas = figure.querySelector("canvas." + name);
        const { data, width } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
        const ratio = canvas.width / canvas.clientWidth;
        return (x, y) => data[4 * (Math.floor(y * ratio) * width + Math.floor(x * ratio)) + 3];
    };
    const [all, some] = [pixels("all"), pixels("some")];
    return figure.data.filter((trace) => trace.customdata).flatMap((trace) => [...trace.customdata].map((id, i) => {
        const [x, y] = [xaxis.d2p(trace.x[i]), yaxis.d2p(trace.y[i])];
        return { id, x: box.x + xaxis._offset + x, y: box.y + yaxis._offset + y, all: all(x, y), some: some(x, y) };
    }));
}"""
"""Where each design is in a projection, by plotly's axes, and how opaque the page's canvases are there."""

ANOTHER_ADDRESS = """(text) => new Promise((done) => {
    const before = location.hash;
    addEventListener("hashchange", () => done(), { once: true });
    location.hash = text;
    if (location.hash === before) done();
})"""
"""Gives the page an address, and waits until it has read it."""

APART = 12.0
"""How far from each other two marks surely do not touch, nor the ring around the one that is shown closely [px]."""


STILL = """async (selector) => {
  const place = () => JSON.stringify(document.querySelector(selector).getBoundingClientRect());
  const frame = () => new Promise((done) => requestAnimationFrame(done));
  for (let still = 0, last = place(); still < 5; last = place()) {
    await frame();
    still = place() === last ? still + 1 : 0;
  }
}"""
"""Waits until an element has not moved for five frames: what follows a selection is drawn later, and moves others."""

FITTING = """() => [...document.querySelectorAll(".js-plotly-plot")].filter((figure) => figure.clientWidth)
    .every((figure) => Math.abs(figure._fullLayout.width - figure.clientWidth) <= 1)"""
"""Whether every figure that is shown is as wide as its place."""


@dataclass
class Opened:
    """A page, and what it did that it should not."""

    page: Page
    requests: list[str] = field(default_factory=list)
    errors: list[str] = field(default_factory=list)

    def count(self, selector: str) -> int:
        return self.page.locator(selector).count()

    def lines(self) -> list[str]:
        """Outlines of the response's lines as drawn, for what is selected."""
        self.settled()
        return self.page.eval_on_selector_all(
            "#response .scatterlayer path.js-line", "paths => paths.map(p => p.getAttribute('d'))"
        )

    def dots(self, pair: str) -> list[dict[str, float]]:
        """Each design's `id`, place on the screen `x`, `y` [px], and alpha in the canvases `all` and `some` there."""
        return list(self.page.evaluate(DOTS, pair))

    def visit(self, fragment: str) -> None:
        """Give the page an address with this fragment, `#select=…`, and wait until every view has followed."""
        self.page.evaluate(ANOTHER_ADDRESS, fragment)
        self.settled()

    def settled(self) -> None:
        """Wait until every view has followed the selection."""
        self.page.wait_for_selector("html:not([data-following])", timeout=PATIENCE)

    def title(self) -> str:
        self.settled()
        return self.page.locator("#selected-title").inner_text()


def eventually(page: Page, check: Callable[[], None]) -> None:
    """Check again and again until it passes: a page follows in its own time. At last its complaint is raised."""
    end = time.monotonic() + PATIENCE / 1000
    while True:
        try:
            return check()
        except AssertionError:
            if time.monotonic() > end:
                raise
        page.wait_for_timeout(50)


def into_view(found: Opened, selector: str) -> None:
    """Bring an element to the middle of the window, and wait until it stays there."""
    found.page.locator(selector).evaluate("e => e.scrollIntoView({block: 'center', behavior: 'instant'})")
    found.page.evaluate(STILL, selector)


def borne_out(dots: list[dict[str, float]], chosen: Collection[object]) -> None:
    """Every design has its mark; every chosen one is drawn above, and no other is that has no chosen one near."""
    assert all(dot["all"] > 0 for dot in dots)
    above = [dot for dot in dots if dot["id"] in chosen]
    assert len(above) == len(chosen)
    assert all(dot["some"] > 0 for dot in above)
    for dot in dots:
        if all(max(abs(dot["x"] - other["x"]), abs(dot["y"] - other["y"])) > APART for other in above):
            assert dot["some"] == 0


@contextmanager
def chromium() -> Iterator[Browser]:
    """Start Debian's Chromium; where there is none skip the test, or fail it if the environment asks for one."""
    path = shutil.which("chromium") or shutil.which("chromium-browser")
    if path is None and os.environ.get("DIVIDEROPT_NEED_CHROMIUM"):
        pytest.fail("no chromium on PATH, and DIVIDEROPT_NEED_CHROMIUM asks for it")
    if path is None:
        pytest.skip("no chromium on PATH: what a browser draws cannot be tested")
    with sync_playwright() as playwright:
        args = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
        browser = playwright.chromium.launch(executable_path=path, args=args)
        yield browser
        browser.close()


def quiet(found: Opened) -> None:
    assert found.requests == []
    assert found.errors == []
    links = found.page.evaluate(
        "[...document.querySelectorAll('[href], [src]')].map(e => e.getAttribute('href') ?? e.getAttribute('src'))"
    )
    assert [link for link in links if link and not link.startswith("#")] == []
