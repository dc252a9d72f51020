from __future__ import annotations

import pytest
from playwright.sync_api import sync_playwright

from Testing.web.chromium import launch


@pytest.fixture(scope="module")
def browser():
    """A browser that ends with its module: others could run no event loop beside Playwright's."""
    with sync_playwright() as playwright:
        browser = launch(playwright)
        yield browser
        browser.close()
