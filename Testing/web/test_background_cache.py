"""Where the processor draws the page, what stands still is drawn once and kept."""

import numpy as np
import pytest

from Testing.web.chromium import open_page, pixels

BEGIN = """() => {
  const { flat, stage } = page;
  stage.renderer.setAnimationLoop(null);
  window.now = 1e6;
  window.backgrounds = 0;
  const { render } = stage.renderer;
  stage.renderer.render = (scene, camera) => {
    if (camera === flat.camera && !camera.layers.isEnabled(0)) window.backgrounds++;
    render.call(stage.renderer, scene, camera);
  };
  page.place = page.take = () => {};
}"""
DRAW = """(seconds) => {
  window.now += seconds;
  page.isDue = true;
  page.drawFlat(page.flat, window.now, page.stage.model, page.state);
}"""
SETTLE = f"() => {{ for (let count = 0; count < 3; count++) ({DRAW})(1); }}"
CHANGES = {
    "another view": "page.state.view.position[0] += 0.01",
    "another place of the head": "page.stage.model.node('head').position.x += 0.01",
    "paint": "page.stage.model.paintSkin(new Float32Array(page.stage.model.skinVertices.count))",
    "a clear head": "page.screen = { ...page.screen, isHeadClear: true }",
    "a restored context": (
        "page.stage.renderer.domElement.dispatchEvent(new Event('webglcontextrestored'))"
    ),
}


@pytest.fixture(scope="module")
def page(browser, served):
    page = open_page(browser, served.url, served.code)
    page.evaluate(BEGIN)
    yield page
    assert page.problems == []


def drawn_backgrounds(page, change=""):
    page.evaluate(SETTLE)
    page.evaluate(f"() => {{ window.backgrounds = 0; {change} }}")
    page.evaluate(SETTLE)
    return page.evaluate("window.backgrounds")


def test_a_moved_arm_is_drawn_over_the_kept_background_as_with_all_of_the_scene(page):
    page.evaluate(SETTLE)
    before = pixels(page)
    move = "page.stage.model.bodies.at(-2).position.y += 0.03"
    assert drawn_backgrounds(page, move) == 0
    kept = pixels(page)
    page.evaluate("page.flat.caches.view.keptContent = page.flat.caches.view.content = ''")
    page.evaluate(DRAW, 0.0)
    whole = pixels(page)
    assert np.abs(kept - before).max() > 50, "the arm has not moved"
    # Only edges differ, which are smoothed in the kept background.
    assert np.median(np.abs(kept - whole)) == 0
    assert np.mean(np.abs(kept - whole).max(axis=2) > 40) < 0.02


def test_the_background_is_drawn_again_once_whatever_has_changed_in_it(page):
    drawn = {name: drawn_backgrounds(page, change) for name, change in CHANGES.items()}
    assert drawn == dict.fromkeys(CHANGES, 1)
