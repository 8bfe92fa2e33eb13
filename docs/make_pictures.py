"""The README's picture: the front's section of a report, as Chromium draws it.

Run it with `python docs/make_pictures.py results/divider` after `divideropt run campaigns/divider.yaml`. It needs
Debian's chromium and the `test` extra.
"""

import shutil
import sys
from pathlib import Path

from playwright.sync_api import sync_playwright

PICTURE = Path(__file__).parent / "images" / "front.png"


def main(store: Path) -> None:
    """Take the picture."""
    report = (store / "report.html").resolve()
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=shutil.which("chromium"),
            args=["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
        )
        page = browser.new_page(viewport={"width": 1280, "height": 1000}, color_scheme="light")
        page.goto(report.as_uri())
        page.locator("#front").scroll_into_view_if_needed()  # it is drawn where it is looked at
        page.wait_for_selector("#front[data-drawn]")
        page.wait_for_timeout(5000)  # WebGL without a graphics card takes its time
        page.locator("#the-front").screenshot(path=PICTURE)
        browser.close()
    print(PICTURE)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
