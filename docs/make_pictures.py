"""The pictures of reports in the documentation, light and dark, as Chromium draws them.

`python docs/make_pictures.py results/divider` after `divideropt run campaigns/divider.yaml` takes the README's.
With the folder in which the tutorial was followed as a second argument it takes the tutorial's too. It needs
Debian's chromium, the extra `test`, and Pillow, which pymoo brings.
"""

import io
import shutil
import sys
from pathlib import Path

from PIL import Image
from playwright.sync_api import Browser, Page, sync_playwright

PICTURES = Path(__file__).parent / "images"


def main(store: Path, tutorial: Path | None = None) -> None:
    """Take the pictures."""
    wanted = [(store / "report.html", "#the-front", "front")]
    if tutorial is not None:
        wanted += [
            (tutorial / "results/quickstart/report.html", "#the-front", "tutorial-front"),
            (tutorial / "light.html", "body", "tutorial-response"),
        ]
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=shutil.which("chromium"),
            args=["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
        )
        for page, part, name in wanted:
            _take(browser, page.resolve(), part, PICTURES / f"{name}.png", scheme="light")
            _take(browser, page.resolve(), part, PICTURES / f"{name}-dark.png", scheme="dark")
        browser.close()


def _take(browser: Browser, address: Path, part: str, picture: Path, scheme: str) -> None:
    page = browser.new_page(
        viewport={"width": 1100, "height": 1000}, color_scheme="dark" if scheme == "dark" else "light"
    )
    page.goto(address.as_uri())
    _draw(page)
    shot = Image.open(io.BytesIO(page.locator(part).screenshot()))
    shot.convert("RGB").quantize(128, dither=Image.Dither.NONE).save(picture, optimize=True)
    page.close()
    print(f"{picture}: {picture.stat().st_size / 1e3:.0f} kB")


def _draw(page: Page) -> None:
    """Wait until all is drawn, the front where it is looked at."""
    if page.locator("#front").count():
        page.locator("#front").scroll_into_view_if_needed()
        page.wait_for_selector("#front[data-drawn]")
    page.wait_for_timeout(5000)  # WebGL without a graphics card takes its time


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
