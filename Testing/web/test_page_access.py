"""Accessibility of the page: screen readers, zoom, phones and large displays, in all languages."""

from __future__ import annotations

import json
from dataclasses import fields, is_dataclass, replace
from enum import Enum
from pathlib import Path

import pytest

from rastrainer.number_text import with_units
from rastrainer_simulator.presentation.screen import (
    ItemKind,
    Menu,
    MenuItem,
    Screen,
    ScreenMessage,
    Tone,
)
from rastrainer_simulator.texts.texts import LANGUAGES, Texts
from Testing.simulator.flow.every_page import LONGEST_OR_EACH
from Testing.web.chromium import accessibility_checker, open_page, resize, show

WEB = Path(__file__).parents[2] / "RASTrainerSimulatorServer" / "web"
SIZES = {
    "phone": (390, 844),
    "phone on its side": (844, 390),
    "narrowest": (320, 568),
    "laptop": (1280, 720),
    "laptop at 200 %": (640, 360),
    "full HD": (1920, 1080),
    "full HD at 200 %": (960, 540),
    "4K": (3840, 2160),
}
LOOKED_AT = pytest.mark.parametrize(
    "sizes",
    [
        pytest.param(("narrowest", "laptop at 200 %"), id="small sizes"),
        pytest.param(tuple(SIZES), id="every size", marks=pytest.mark.soak),
    ],
)
"""Large windows have room to spare, and take the processors long to draw."""
VIOLATIONS = """async () => {
  const { violations } = await axe.run(document, { resultTypes: ["violations"] });
  return violations.flatMap(({ id, nodes }) => nodes.map(({ html }) => `${id}: ${html}`));
}"""
OVERLAPS = """() => {
  const parts = "#status li, #instruction, #warnings li, #loading, #inset, #menu, " +
    "#touch-controls, #hints, #control, #headset";
  const boxes = [...document.querySelectorAll(parts)]
    .filter((part) => part.checkVisibility() && part.getBoundingClientRect().width > 0)
    .map((part) => {
      const { left, right, top, bottom } = part.getBoundingClientRect();
      return { name: part.id || part.textContent, left, right, top, bottom };
    });
  const found = [];
  boxes.forEach((a, index) => {
    if (a.left < -1 || a.right > innerWidth + 1) found.push(`${a.name} is cut off`);
    for (const b of boxes.slice(index + 1)) {
      const across = Math.min(a.right, b.right) - Math.max(a.left, b.left);
      const down = Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top);
      if (across > 1 && down > 1) found.push(`${a.name} over ${b.name}`);
    }
  });
  const { scrollHeight, clientHeight } = document.getElementById("overlay");
  const isScrolled = document.body.dataset.menu !== "";
  const hidden = scrollHeight - clientHeight;
  if (!isScrolled && hidden > 1) found.push(`${hidden} px do not fit`);
  for (const part of document.querySelectorAll("#menu *")) {
    const isBox = part.matches(":not(input, .unseen)") && part.clientWidth > 0;
    const isInline = getComputedStyle(part).display === "inline";
    const isCut = isBox && !isInline && part.scrollWidth > part.clientWidth + 1;
    if (isCut) found.push(`${part.textContent} is cut off`);
  }
  for (const part of document.querySelectorAll("#overlay :is(p, ul, li)")) {
    const isPainted = getComputedStyle(part).backgroundColor !== "rgba(0, 0, 0, 0)";
    const isEmpty = part.clientHeight > 0 && part.innerText.trim() === "";
    if (isPainted && isEmpty) found.push(`${part.id || part.className} is an empty box`);
  }
  return found;
}"""


def checked_page(browser, url: str, code: str, has_touch: bool = False):
    """Open the page with axe-core in it."""
    page = open_page(browser, url, code, draws=False, has_scene=False, has_touch=has_touch)
    page.evaluate(accessibility_checker())
    return page


def faults(page, screen: str, size: str, has_axe: bool = True) -> list[str]:
    """Return the faults of the shown elements at the present size of the window."""
    page.evaluate("frames_(1)")
    wrong = page.evaluate(OVERLAPS) + (page.evaluate(VIOLATIONS) if has_axe else [])
    return [f"{screen}, {size}: {each}" for each in wrong]


def complaints(page, screen: str, sizes: tuple[str, ...]) -> list[str]:
    """Return the faults of the shown elements at these sizes; axe looks only at the first."""
    found = []
    for size in sizes:
        resize(page, *SIZES[size])
        found += faults(page, screen, size, has_axe=size == sizes[0])
    return found


@pytest.fixture(scope="module")
def told_page(served, browser):
    """A page that shows what a test sends it."""
    page = checked_page(browser, served.url, served.code)
    yield page
    assert page.problems == []
    page.context.close()


@LOOKED_AT
@pytest.mark.parametrize("language", LONGEST_OR_EACH)
def test_no_page_of_the_simulator_breaks_an_accessibility_rule_or_overlaps_at_any_size(
    told_page, served, screens, language, sizes
):
    found, shown = [], screens(language)
    kinds = {kind_of(screen): name for name, screen in shown.items()}
    for size in sizes:
        resize(told_page, *SIZES[size])
        for name, screen in shown.items():
            show(told_page, served, screen)
            is_first = size == sizes[0] and kinds[kind_of(screen)] == name
            found += faults(told_page, name, size, is_first or sizes == tuple(SIZES))
    assert found == []


def kind_of(value):
    """Return a screen, or a part, without its words and numbers: axe looks at one of each kind."""
    if isinstance(value, tuple):
        return tuple(dict.fromkeys(map(kind_of, value)))
    if is_dataclass(value):
        return tuple(kind_of(getattr(value, each.name)) for each in fields(value))
    if isinstance(value, (Enum, bool)):
        return value
    return value is not None and value != ""


def at_work(language: str) -> Screen:
    """Return a trial with two warnings."""
    texts = Texts(LANGUAGES[language])
    say = texts.say
    directions = texts.listed(say(f"way.{name}") for name in ("right", "back"))
    point = say("status.point", point="13")
    return Screen(
        language=language,
        status=(
            say("task.task-4"),
            say("status.points", kept=12, count=15),
            "2:31",
            say("status.toward", name=point, distance=120, direction=directions),
        ),
        instruction=ScreenMessage(say("touched", trainee="P07", label="12", point="13"), Tone.GOOD),
        warnings=(
            ScreenMessage(say("warning.elsewhere"), Tone.ERROR),
            ScreenMessage(say("warning.obstacle.links"), Tone.ERROR),
        ),
    )


AT_A_GUIDE = """(procedure) => {
  page.touch.takeState({ ...page.state, procedure });
  page.overlay.showInset("Along the skin");
}"""


def test_thumb_controls_overlap_nothing_at_any_size(browser, served):
    page = checked_page(browser, served.url, served.code, has_touch=True)
    page.wait_for_selector("#touch-controls", state="attached")
    page.evaluate("page.takeState = () => undefined")
    found = []
    for language in LANGUAGES:
        screen = at_work(language)
        show(page, served, screen)
        page.wait_for_selector("#touch-controls")
        page.evaluate(AT_A_GUIDE, {"tool": "guide", "aim": {}})
        page.wait_for_selector("#touch-controls [data-toggle=tilt]")
        found += complaints(page, f"at work in {language}", ("phone", "laptop at 200 %"))
    page.context.close()
    assert found == []


def test_the_page_declares_its_language_and_uses_it_for_its_own_texts(told_page, served):
    for language in LANGUAGES:
        served.tell(Screen(language=language))
        told_page.wait_for_selector(f"html[lang={language}]")
        own = json.loads((WEB / "src" / "texts" / f"{language}.json").read_text("utf-8"))["page"]
        name = told_page.get_attribute("#picture", "aria-label")
        assert name.replace("\u00a0", " ") == own["view"]
        # Sentences shown before the language changed are translated, too.
        told_page.wait_for_selector(f"#control:has-text('{own['nobody']}')")


def test_the_browsers_focus_follows_the_simulators_and_has_a_name_and_a_role(
    told_page, served, screens
):
    menu = screens("de")["settings"].menu
    for item in menu.items:
        show(told_page, served, Screen(menu=replace(menu, focus=item.name)))
        told_page.wait_for_selector(f"#menu li[data-name='{item.name}'] button:focus")
        name = f"{item.label} {item.value}".strip()
        dialog = told_page.get_by_role("dialog", name=menu.title)
        assert dialog.get_by_role("button", name=name, exact=True).count() == 1
    last = replace(menu.items[-1], value="another value")
    show(
        told_page,
        served,
        Screen(menu=replace(menu, items=(*menu.items[:-1], last), focus=last.name)),
    )
    said = f"#menu [role=status]:has-text('{last.label} another value')"
    told_page.wait_for_selector(said, state="attached")


IN_FOCUS = """() => {
  return ["li[data-focus]", ".help"].map((selector) => {
    const part = document.querySelector(`#menu ${selector}`);
    const { left, top, bottom } = part.getBoundingClientRect();
    const at = (y) => document.elementFromPoint(left + 30, y);
    return [top + 3, bottom - 3].every((y) => part.contains(at(y)));
  });
}"""


def test_a_scrolled_list_shows_the_item_in_focus_and_its_help(told_page, served, screens):
    screen = screens("de")["settings"]
    resize(told_page, *SIZES["laptop"])
    for item in screen.menu.items:
        show(told_page, served, replace(screen, menu=replace(screen.menu, focus=item.name)))
        said = told_page.evaluate("document.querySelector('#menu .help').textContent")
        assert said == with_units(item.help)
        assert told_page.evaluate(IN_FOCUS) == [True, True], item.name


LATER = "new Promise((done) => setTimeout(() => setTimeout(done)))"
"""A focused field's timers have run by then."""


def test_typing_goes_on_in_a_field_while_another_item_appears(told_page, served):
    field = MenuItem("trainee", "Your ID", kind=ItemKind.TEXT, value="")
    task = MenuItem("task-1", "Task 1")
    menu = Menu("experiment", "Experiment", items=(field, task), focus="trainee")
    show(told_page, served, Screen(menu=menu))
    told_page.wait_for_selector("#menu input:focus")
    told_page.evaluate(LATER)
    told_page.keyboard.press("P")
    items = (replace(field, value="P"), MenuItem("skip", "Skip"), task)
    show(told_page, served, Screen(menu=replace(menu, items=items)))
    told_page.wait_for_selector("#menu li[data-name=skip] + li[data-name=task-1]")
    told_page.evaluate(LATER)
    told_page.keyboard.press("7")
    assert told_page.input_value("#menu input:focus") == "P7"


def test_a_selection_is_visible_with_forced_colors(told_page, served, screens):
    page = told_page
    show(page, served, screens("de")["start"])
    page.emulate_media(forced_colors="active")
    color = "button => getComputedStyle(button).backgroundColor"
    focused = page.eval_on_selector("#menu [data-focus] button", color)
    others = page.eval_on_selector_all(
        "#menu li:not([data-focus]) button",
        f"buttons => buttons.map({color})",
    )
    page.emulate_media(forced_colors="none")
    assert focused not in others
