from __future__ import annotations

import pytest
from playwright.sync_api import sync_playwright

from Testing.web.chromium import launch


@pytest.fixture(scope="module")
def driver():
    """What starts browsers; ends with its module: others could run no event loop beside it."""
    with sync_playwright() as driver:
        yield driver


@pytest.fixture(scope="module")
def browser(driver):
    browser = launch(driver)
    yield browser
    browser.close()
