"""The headset's boards have room for what is on them in every language."""

from __future__ import annotations

import pytest

from rastrainer_simulator.flow.flow_presenter import FlowPresenter
from rastrainer_simulator.flow.session.preferences import Preferences
from rastrainer_simulator.input.bindings import DEFAULT_BINDINGS
from rastrainer_simulator.ops.texts.texts import LANGUAGES
from Testing.simulator.flow.languages import LONGEST, LONGEST_OR_EACH, letters, screens_in
from Testing.web.chromium import enter_headset, open_page, show
from Testing.web.test_page_access import at_work

WITHOUT_ROOM = """() => {
  const written = [];
  const { fillText } = CanvasRenderingContext2D.prototype;
  CanvasRenderingContext2D.prototype.fillText = function (text, x, y) {
    const right = x + this.measureText(text).width;
    const size = parseFloat(/([\\d.]+)px/.exec(this.font)[1]);
    written.push({ text, canvas: this.canvas, left: x, right, y, size });
    return fillText.call(this, text, x, y);
  };
  const { boards } = page.headset;
  for (const board of [boards.menu, boards.work, boards.actions, boards.warning]) board.shown = "";
  page.headset.showScreen(page.screen);
  CanvasRenderingContext2D.prototype.fillText = fillText;
  const found = written.length > 0 ? [] : ["nothing is written"];
  written.forEach((one, index) => {
    // Texts of its own that end so have a space before the dots.
    if (/[^ ]…$/.test(one.text)) found.push(`${one.text} is cut`);
    if (one.size < 24) found.push(`${one.text} is too small to read`);
    const { width, height } = one.canvas;
    const isOff = one.left < 0 || one.right > width || one.y > height - 8;
    if (isOff) found.push(`${one.text} is off its board`);
    for (const other of written.slice(index + 1)) {
      const isBeside = one.canvas === other.canvas && Math.abs(one.y - other.y) < 20;
      const across = Math.min(one.right, other.right) - Math.max(one.left, other.left);
      if (isBeside && across > 0) found.push(`${one.text} over ${other.text}`);
    }
  });
  return found;
}"""


@pytest.mark.parametrize("language", LONGEST_OR_EACH)
def test_nothing_on_a_board_is_cut_or_over_something_else(browser, served, loop, outside, language):
    page = open_page(browser, served.url, served.code, "metaQuest2", draws=False)
    enter_headset(page)
    presenter = FlowPresenter(loop, outside.services, DEFAULT_BINDINGS, Preferences())
    spoken = LANGUAGES if language == LONGEST else [language]
    screens = {**screens_in(presenter, language), "work": max(map(at_work, spoken), key=letters)}
    found = []
    for name, screen in screens.items():
        show(page, served, screen)
        found += [f"{name}: {each}" for each in page.evaluate(WITHOUT_ROOM)]
    presenter.close()
    assert page.problems == []
    page.context.close()
    assert found == []
