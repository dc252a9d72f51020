"""A headless Chromium, and the page of a simulator in it, with or without an emulated headset."""

from __future__ import annotations

import io
import json
import shutil
import struct
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from PIL import Image
from playwright.sync_api import Browser, Page, Playwright, Response

from rastrainer_simulator.net.views.outgoing import screen_text
from rastrainer_simulator.presentation.screen import Screen, without_secrets
from Testing.end_to_end.window_process import wait_until
from Testing.simulator.net.views.served import ServedViews
from Testing.web.slow_page import slow_pages
from tools.build_page import install_packages

WEB = Path(__file__).parents[2] / "RASTrainerSimulatorServer" / "web"
IWER = WEB / "node_modules" / "iwer" / "build" / "iwer.min.js"
AXE = WEB / "node_modules" / "axe-core" / "axe.min.js"
# Mesa draws several times faster than Chromium's own software renderer; without it, all but
# the canvas is faster.
ARGUMENTS = [
    *("--no-sandbox", "--use-gl=angle", "--use-angle=gl-egl", "--ignore-gpu-blocklist"),
    "--disable-gpu-compositing",
]
PATIENCE_MS = 120_000
POLL_MS = 50
SMALL = {"width": 400, "height": 220}
EYES_M = (0.1, 1.62, 0.2)
_HAS_REJOINED = "page.poses !== window.posesBefore && page.poses.count > 0"
"""Whether all that the simulator sends to a new view has arrived again; the state comes last."""

_EMULATE = """
;(() => {
  const device = new IWER.XRDevice(IWER.%s, { stereoEnabled: true });
  device.installRuntime({ forceInstall: true });
  device.position.set(%f, %f, %f);
  window.device = device;
})();
"""
_FRAMES = """
window.frames_ = (count) => new Promise((done) => {
  const step = () => (count-- > 0 ? requestAnimationFrame(step) : done());
  step();
});
"""
_DRAW_NOTHING = """
window.drawsNothing = true;
// A third of the usual pictures: laying out and composing what is not looked at takes long, too.
window.requestAnimationFrame = (draw) => setTimeout(() => draw(performance.now()), 50);
window.cancelAnimationFrame = clearTimeout;
for (const name of Object.getOwnPropertyNames(WebGL2RenderingContext.prototype)) {
  if (!/^(clear|draw)[A-Z]|^clear$/.test(name)) continue;
  const draw = WebGL2RenderingContext.prototype[name];
  WebGL2RenderingContext.prototype[name] = function (...values) {
    if (!window.drawsNothing) draw.apply(this, values);
  };
}
const { getContext } = HTMLCanvasElement.prototype;
HTMLCanvasElement.prototype.getContext = function (kind, ...options) {
  if (kind === "webgl2") {
    for (const [name, value] of [["width", 400], ["height", 220]]) {
      this[name] = value;
      Object.defineProperty(this, name, { get: () => value, set: () => {} });
    }
  }
  return getContext.call(this, kind, ...options);
};
"""
_SHOW_NOTHING = """(() => {
  const { renderer, scene } = page.stage;
  const { render } = renderer;
  const empty = new scene.constructor();
  renderer.render = (shown, camera) =>
    render.call(renderer, window.drawsNothing ? empty : shown, camera);
  const draw = page.flat.draw.bind(page.flat);
  page.flat.draw = (...values) => !window.drawsNothing && draw(...values);
})()"""
_EMPTY_SCENE = '{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}]}'
_EMPTY_GLB = struct.pack("<4s4I", b"glTF", 2, 88, 68, 0x4E4F534A) + _EMPTY_SCENE.encode()
_LOAD_NO_SCENE = f"""
const {{ fetch }} = window;
window.fetch = (asked, ...options) => String(asked.url ?? asked).endsWith(".glb")
  ? Promise.resolve(new Response(new Uint8Array({list(_EMPTY_GLB)})))
  : fetch(asked, ...options);
"""
_PADS = """
window.pad = { connected: true, mapping: "standard", index: 0, id: "Test pad",
  axes: [0, 0, 0, 0],
  buttons: Array.from({ length: 17 }, () => ({ value: 0, pressed: false, touched: false })) };
window.press = (index, value) => {
  window.pad.buttons[index].value = value;
  window.pad.buttons[index].pressed = value > 0.5;
};
navigator.getGamepads = () => [window.pad];
"""


def launch(playwright: Playwright, *arguments: str) -> Browser:
    """Start the Chromium of this machine, or Playwright's own where there is none."""
    path = shutil.which("chromium") or shutil.which("chromium-browser")
    browser = playwright.chromium.launch(
        executable_path=path, args=[*ARGUMENTS, *arguments], timeout=PATIENCE_MS
    )
    return slow_pages(browser)


def emulator() -> str:
    """Return the script of the emulated headset, which npm installs with the page."""
    if not IWER.exists():
        install_packages()
    return IWER.read_text(encoding="utf-8")


def accessibility_checker() -> str:
    """Return the script of axe-core, which npm installs for the tests alone."""
    if not AXE.exists():
        install_packages()
    return AXE.read_text(encoding="utf-8")


def open_board_page(browser: Browser, url: str, code: str, locale: str = "en-US") -> Page:
    """Open a teacher's board, paired by the code in its address; `problems` are what went wrong."""
    context = browser.new_context(viewport={"width": 1280, "height": 720}, locale=locale)
    context.set_default_timeout(PATIENCE_MS)
    page = context.new_page()
    page.problems = []
    page.on("pageerror", lambda error: page.problems.append(str(error)))
    page.goto(f"{url}/#code={code}")
    return page


def open_page(
    browser: Browser,
    url: str,
    code: str,
    headset: str = "",
    has_pad: bool = False,
    size: dict[str, int] = SMALL,
    has_touch: bool = False,
    draws: bool = True,
    has_scene: bool = True,
) -> Page:
    """Open the page, pair it by the code in its address, and wait until it shows the scene.

    Pictures take both processors: tests that need none have it draw nothing in its canvas, and
    those that need no robot and no head either have it load an empty scene.
    Its `problems` are what went wrong in it, and `loaded` has the bytes of each address.
    """
    context = browser.new_context(viewport=size, ignore_https_errors=True, has_touch=has_touch)
    context.set_default_timeout(PATIENCE_MS)
    page = context.new_page()
    page.add_init_script(_FRAMES)
    if headset:
        page.add_init_script(emulator() + _EMULATE % (headset, *EYES_M))
    if has_pad:
        page.add_init_script(_PADS)
    if not draws:
        draw_nothing(page)
    if not has_scene:
        page.add_init_script(_LOAD_NO_SCENE)
    page.problems = []
    page.on("pageerror", lambda error: page.problems.append(str(error)))
    page.loaded = {}
    page.on("response", lambda answer: page.loaded.update({answer.url: _size(answer)}))
    page.goto(f"{url}/#code={code}")
    page.wait_for_selector("body[data-scene][data-menu]")
    wait_for(page, "page.state !== null")
    if not draws:
        page.evaluate(_SHOW_NOTHING)
    return page


def draw_nothing(page: Page) -> None:
    """Have a page draw no scene from its next load on; menus and texts stay."""
    page.add_init_script(_DRAW_NOTHING)


def draw_for_a_while(page: Page) -> np.ndarray:
    """Let a page that draws nothing draw some pictures; return the last as `pixels` does."""
    page.evaluate("drawsNothing = false; page.isDue = true; frames_(3)")
    picture = pixels(page)
    page.evaluate("drawsNothing = true")
    return picture


def _size(answer: Response) -> int:
    return int(answer.headers.get("content-length", 0))


def enter_headset(page: Page) -> None:
    """Press the button that leads into immersive VR, and wait until it has joined and draws."""
    with _rejoining(page):
        page.click("#headset:enabled")
        page.wait_for_selector("body[data-headset]")
    page.evaluate("frames_(3)")


def leave_headset(page: Page) -> None:
    """Leave immersive VR, as the headset's own button does."""
    with _rejoining(page):
        page.evaluate("page.headset.leave()")
        page.wait_for_selector("body:not([data-headset])")


def stand(page: Page, x=EYES_M[0], y=EYES_M[1], z=EYES_M[2], yaw=0.0) -> Page:
    """Have the wearer stand somewhere in their own room, and look there."""
    page.evaluate(
        """async ([x, y, z, half]) => {
          device.position.set(x, y, z);
          device.quaternion.set(0, Math.sin(half), 0, Math.cos(half));
          await frames_(4); }""",
        [x, y, z, yaw / 2],
    )
    return page


@contextmanager
def _rejoining(page: Page) -> Iterator[None]:
    """Wait until a page has joined again: earlier input is lost."""
    page.evaluate("void (window.posesBefore = page.poses)")
    yield
    wait_for(page, _HAS_REJOINED)


def resize(page: Page, width: int, height: int) -> None:
    """Give the window another size, and wait until the page has it."""
    page.set_viewport_size({"width": width, "height": height})
    wait_for(page, f"innerWidth === {width} && innerHeight === {height}")


def wait_for(page: Page, expression: str) -> None:
    """Wait until an expression is true; Playwright's own waiting breaks the page's rules."""
    give_up = time.monotonic() + PATIENCE_MS / 1000.0
    while not page.evaluate(expression):
        assert time.monotonic() < give_up, f"{expression} never came true"
        page.wait_for_timeout(POLL_MS)


def show(page: Page, served: ServedViews, screen: Screen) -> None:
    """Send a page a screen, and wait until the page shows it."""
    served.tell(screen)
    wanted = json.loads(screen_text(without_secrets(screen)))["screen"]
    wait_until(lambda: page.evaluate("page.screen") == wanted, "the screen", PATIENCE_MS / 1000.0)


def pixels(page: Page) -> np.ndarray:
    """Return what the window shows, (height, width, 3) float."""
    image = Image.open(io.BytesIO(page.screenshot())).convert("RGB")
    return np.asarray(image, dtype=float)
