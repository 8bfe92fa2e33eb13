"""A document in a browser: what the tests of pages look at, and that it keeps quiet."""

import os
import shutil
from collections.abc import Iterator
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


@dataclass
class Opened:
    """A page, and what it did that it should not."""

    page: Page
    requests: list[str] = field(default_factory=list)
    errors: list[str] = field(default_factory=list)

    def count(self, selector: str) -> int:
        return self.page.locator(selector).count()

    def lines(self) -> list[str]:
        """Outlines of the response's lines as drawn."""
        return self.page.eval_on_selector_all(
            "#response .scatterlayer path.js-line", "paths => paths.map(p => p.getAttribute('d'))"
        )

    def title(self) -> str:
        return self.page.locator("#selected-title").inner_text()


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
