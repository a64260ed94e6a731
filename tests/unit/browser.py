"""A headless Chromium that opens pages, for the tests of what a reader does with them."""

import shutil
from contextlib import contextmanager

import pytest

CHROMIUM = next(
    filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None
)
# WebGL without a graphics card.
_DRAWING = ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]


class Opened:
    """A page in the browser, everything it complains of and everything it loads.

    Attributes
    ----------
    wrong, loaded : list of str
        Errors and warnings of the console; addresses.
    """

    def __init__(self, page):
        self.page, self.wrong, self.loaded = page, [], []
        page.on("console", lambda said: self.wrong.append(f"{said.type}: {said.text}"))
        page.on("pageerror", lambda error: self.wrong.append(str(error)))
        page.on("request", lambda request: self.loaded.append(request.url))


@contextmanager
def opened(path, width=900, height=700):
    """Open the file in a browser of its own; skip the test where there is none."""
    if CHROMIUM is None:
        pytest.skip("no Chromium here (apt-get install chromium)")
    playwright = pytest.importorskip("playwright.sync_api", reason="needs playwright")
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox", *_DRAWING])
        there = Opened(browser.new_page(viewport={"width": width, "height": height}))
        there.page.set_default_timeout(60_000)
        there.page.goto(path.as_uri())
        yield there
        browser.close()
