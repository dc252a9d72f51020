"""The page draws the errors of the touches on the head, each in the color of its size."""

from __future__ import annotations

import pytest

from rastrainer_simulator.net.views.screen import ErrorArrow, Hint, Screen, Tone
from Testing.web.chromium import open_page, wait_for

DRAWN = """
() => page.errors.group.children
  .filter((mesh) => mesh.geometry.type === "SphereGeometry")
  .map((mesh) => [mesh.material.color.getHexString(), ...mesh.position.toArray()])
"""


def arrow(tone, height):
    return ErrorArrow((0.5, 0.0, 0.4), (0.5, 0.0, height), tone)


def test_arrows_come_with_the_screen_and_go_with_it(browser, served):
    size = {"width": 960, "height": 600}
    page = open_page(browser, served.url, served.code, size=size, draws=False)
    arrows = tuple(map(arrow, (Tone.GOOD, Tone.WARNING, Tone.ERROR), (0.41, 0.42, 0.43)))
    served.tell(Screen(errors=arrows, hints=(Hint("Esc", "Result", "back"), Hint("D", "Turn"))))
    wait_for(page, "page.errors.group.children.length === 6")
    drawn = page.evaluate(DRAWN)
    assert [color for color, *_place in drawn] == ["8ff0d0", "ffe000", "ef5f66"]
    assert [place for _color, *place in drawn] == [pytest.approx(list(each.end)) for each in arrows]
    # Who has only a mouse gets back, too.
    assert page.locator("#hints button").count() == 1
    page.click("#hints button:has-text('Result')")
    (view,) = {call[1] for call in served.presenter.calls if call[0] == "view_joined"}
    served.wait_for_call("on_item", view, "back")
    served.tell(Screen())
    wait_for(page, "page.errors.group.children.length === 0")
    assert page.problems == []
