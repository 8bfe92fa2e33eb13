"""The documentation as HTML: it builds without a warning, asks nothing of any server, and reads on any screen."""

import re
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page

from browsing import PATIENCE

WIDEST = ["how-to/compare.html", "model/nomenclature.html", "model/equations.html", "reference/campaign.html"]
"""Pages of wide tables, long lines of output and long formulas."""


def visit(browser: Browser, address: str, **how: object) -> tuple[Page, list[str]]:
    """Open a page, and list what goes wrong and what it asks of others."""
    page, found = browser.new_page(**how), []
    page.set_default_timeout(PATIENCE)
    page.on("console", lambda message: found.append(message.text) if message.type == "error" else None)
    page.on("pageerror", lambda error: found.append(str(error)))
    page.on("request", lambda r: None if r.url.startswith(("file:", "data:")) else found.append(r.url))
    page.goto(address)
    return page, found


def test_it_builds_without_a_warning_and_draws_its_formulas(site):
    assert (site / "model" / "equations.html").read_text(encoding="utf-8").count("<math") > 100


def test_no_page_style_or_script_loads_anything_from_elsewhere(site):
    loaded = re.compile(r"""<(?:script|link|img|iframe)[^>]*(?:src|href)=["']?(?:https?:)?//""")
    styled = re.compile(r"""(?:@import\s+|url\()["']?(?:https?:)?//""")
    pages, styles = list(site.rglob("*.html")), list(site.rglob("*.css"))
    assert len(pages) > 40
    assert styles
    assert [path for path in pages if loaded.search(path.read_text(encoding="utf-8"))] == []
    assert [path for path in (*pages, *styles) if styled.search(path.read_text(encoding="utf-8"))] == []


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("name", WIDEST)
def test_a_page_fits_a_telephone_and_asks_nobody(site, browser, name, scheme):
    page, found = visit(browser, (site / name).as_uri(), viewport={"width": 400, "height": 800}, color_scheme=scheme)
    assert page.evaluate("document.scrollingElement.scrollWidth") == 400
    assert found == []
    page.close()


def test_the_search_works_from_the_disk(site, browser):
    page, found = visit(browser, f"{(site / 'search.html').as_uri()}?q=hypervolume")
    page.wait_for_selector("#search-results li a")
    links = page.eval_on_selector_all("#search-results li a", "links => links.map(link => link.href)")
    assert any("how-to/compare.html" in link for link in links)
    assert all(Path(re.sub(r"^file://|[?#].*", "", link)).is_file() for link in links)
    assert found == []
    page.close()
