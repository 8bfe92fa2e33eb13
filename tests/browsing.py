"""A document in a browser: what the tests of pages look at, and that it keeps quiet."""

from dataclasses import dataclass, field

from playwright.sync_api import Page

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


def quiet(found: Opened) -> None:
    assert found.requests == []
    assert found.errors == []
    links = found.page.evaluate(
        "[...document.querySelectorAll('[href], [src]')].map(e => e.getAttribute('href') ?? e.getAttribute('src'))"
    )
    assert [link for link in links if link and not link.startswith("#")] == []
