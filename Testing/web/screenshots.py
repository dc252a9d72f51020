"""Make the pictures of page and headset for the README: python -m Testing.web.screenshots."""

from __future__ import annotations

import tempfile
from pathlib import Path

from playwright.sync_api import Page, sync_playwright

from Testing.end_to_end.hands import Controllers, PageKeys
from Testing.end_to_end.lab import WITHOUT_GRAPHICS, Place
from Testing.pictures import keep_picture
from Testing.web.chromium import enter_headset, launch, open_page

FOLDER = Path(__file__).parents[2] / "Screenshots"
DESKTOP = {"width": 1600, "height": 900}
BOTH_EYES = {"width": 1832, "height": 960}
LOOK_DOWN_AND_ASIDE = "device.quaternion.set(-0.19, -0.17, -0.03, 0.966)"


def keep(page: Page, name: str) -> None:
    """Save what the window shows."""
    page.evaluate("frames_(8)")
    keep_picture(page.screenshot(), FOLDER / name)


def main() -> None:
    """Make all of them."""
    with sync_playwright() as playwright, tempfile.TemporaryDirectory() as folder:
        browser = launch(playwright)
        with Place(Path(folder), limits=WITHOUT_GRAPHICS) as place:
            url, code = place.url, place.code
            page = open_page(browser, url, code, size=DESKTOP)
            trainee = place.carried_trainee(PageKeys(page))
            trainee.begin("task-1", page)
            page.wait_for_selector("body[data-scene=task-1]")
            trainee.touch_all(4)
            trainee.approach(place.view.state["next"], 0.004)
            page.evaluate("page.stage.setQuality('high'); frames_(4)")
            if trainee.menu is not None:
                trainee.choose("resume")
                page.wait_for_selector('body[data-menu=""]')
            keep(page, "page.webp")
            page.close()
            page = open_page(browser, url, code, "metaQuest2", size=BOTH_EYES)
            trainee.hands = Controllers(page)
            enter_headset(page)
            trainee.choose("resume")
            page.evaluate(LOOK_DOWN_AND_ASIDE)
            page.wait_for_selector('body[data-menu=""]')
            keep(page, "headset.webp")
        browser.close()


if __name__ == "__main__":
    main()
