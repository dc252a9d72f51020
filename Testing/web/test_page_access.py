"""Accessibility of the page: screen readers, zoom, phones and large displays, in all languages."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import pytest

from rastrainer.number_text import with_units
from rastrainer_simulator.flow.flow_presenter import FlowPresenter
from rastrainer_simulator.flow.session.preferences import Preferences
from rastrainer_simulator.input.bindings import DEFAULT_BINDINGS
from rastrainer_simulator.presentation.screen import (
    ItemKind,
    Menu,
    MenuItem,
    Screen,
    ScreenMessage,
    Tone,
)
from rastrainer_simulator.texts.texts import LANGUAGES, Texts
from Testing.simulator.flow.languages import LONGEST_OR_EACH, screens_in
from Testing.web.chromium import accessibility_checker, open_page, resize, show
from Testing.web.hands import PageKeys
from Testing.web.place import Place

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
AXE_SIZE = "phone"
"""What axe checks unless it checks everything: the other layout is for the soak tests."""
LOOKED_AT = pytest.mark.parametrize(
    "sizes",
    [
        pytest.param(("phone", "narrowest", "laptop at 200 %"), id="small sizes"),
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


@pytest.fixture(
    scope="module",
    params=["de", *(pytest.param(tag, marks=pytest.mark.soak) for tag in LANGUAGES if tag != "de")],
)
def place(request, tmp_path_factory):
    """A place in German, whose words are long; in every other language in the soak tests."""
    folder = tmp_path_factory.mktemp(request.param)
    language = request.param
    with Place(folder, "--speed", "4", language=language) as place:
        yield place


@pytest.fixture(scope="module")
def page(place, browser):
    page = checked_page(browser, place.simulator.url, place.simulator.code)
    yield page
    assert page.problems == []
    page.context.close()


def checked_page(browser, url: str, code: str, has_touch: bool = False):
    """Open the page with axe-core in it."""
    page = open_page(browser, url, code, draws=False, has_touch=has_touch)
    page.evaluate(accessibility_checker())
    return page


def complaints(page, screen: str, sizes: tuple[str, ...]) -> list[str]:
    """Return the faults of the shown elements, at these sizes of the window."""
    found = []
    for name in sizes:
        resize(page, *SIZES[name])
        page.evaluate("frames_(1)")
        wrong = page.evaluate(OVERLAPS)
        if name == AXE_SIZE or len(sizes) == len(SIZES):
            wrong += page.evaluate(VIOLATIONS)
        found += [f"{screen}, {name}: {each}" for each in wrong]
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
    told_page, served, loop, outside, language, sizes
):
    presenter = FlowPresenter(loop, outside.services, DEFAULT_BINDINGS, Preferences())
    found = []
    for name, screen in screens_in(presenter, language).items():
        show(told_page, served, screen)
        found += complaints(told_page, name, sizes)
    presenter.close()
    assert found == []


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


def shown(page, trainee) -> str:
    """Wait until the page shows the simulator's menu; return its name."""
    name = trainee.menu.name if trainee.menu else ""
    page.wait_for_selector(f'body[data-menu="{name}"]')
    return name


@pytest.mark.soak
@LOOKED_AT
def test_no_part_of_a_trial_breaks_an_accessibility_rule_or_overlaps_at_any_size(
    place, page, sizes
):
    trainee = place.carried_trainee(PageKeys(page))
    trainee.begin("task-1", page)
    page.wait_for_selector("body[data-scene=task-1]")
    found = complaints(page, shown(page, trainee) or "trial", sizes)
    trainee.have_touched(15)
    trainee.press("touch", lambda: trainee.menu is not None, "the choice")
    found += complaints(page, shown(page, trainee), sizes)
    assert found == []


NAMES_OF_PICTURE = {
    "en": "Robot, head and operating room",
    "de": "Roboter, Kopf und Operationssaal",
    "fr": "Robot, tête et salle d’opération",
    "es": "Robot, cabeza y quirófano",
    "zh-Hans": "机器人、头部和手术室",
}
NOBODY_DRIVES = {
    "en": "Nobody is driving the robot",
    "de": "Niemand steuert den Roboter",
    "fr": "Personne ne pilote le robot",
    "es": "Nadie maneja el robot",
    "zh-Hans": "无人操纵机器人",
}


def test_the_page_declares_its_language(told_page, served):
    assert NAMES_OF_PICTURE.keys() == LANGUAGES.keys()
    for language, name in NAMES_OF_PICTURE.items():
        served.tell(Screen(language=language))
        told_page.wait_for_selector(f"html[lang={language}]")
        assert told_page.get_attribute("#picture", "aria-label") == name
        # Sentences shown before the language changed are translated, too.
        told_page.wait_for_selector(f"#control:has-text('{NOBODY_DRIVES[language]}')")


def test_the_browsers_focus_follows_the_simulators_and_has_a_name_and_a_role(place, page):
    trainee = place.trainee(PageKeys(page))
    trainee.go_home()
    shown(page, trainee)
    for item in trainee.menu.items:
        trainee.focus(item.name)
        page.wait_for_selector(f"#menu li[data-name='{item.name}'] button:focus")
        menu = page.get_by_role("dialog", name=trainee.menu.title)
        assert menu.get_by_role("button", name=item.label, exact=True).count() == 1
    trainee.choose("settings")
    shown(page, trainee)
    choice = next(item for item in trainee.menu.items if item.name == "volume")
    trainee.focus(choice.name)
    before = trainee.value(choice.name)
    trainee.press("left", lambda: trainee.value(choice.name) != before, "another value")
    text = f"{choice.label} {trainee.value(choice.name)}"
    page.wait_for_selector(f"#menu [role=status]:has-text('{text}')", state="attached")
    assert page.get_by_role("button", name=text, exact=True).count() == 1
    trainee.press("right", lambda: trainee.value(choice.name) == before, "the value before")


def test_the_task_menu_is_complete_on_a_laptop(place, page):
    trainee = place.trainee(PageKeys(page))
    trainee.go_to_experiment()
    assert shown(page, trainee) == "experiment"
    resize(page, *SIZES["laptop"])
    menu = "document.getElementById('menu')"
    assert page.evaluate(f"{menu}.scrollHeight - {menu}.clientHeight") <= 0


AROUND_MENU = """() => {
  const found = [];
  const menu = document.getElementById("menu");
  const hidden = menu.scrollHeight - menu.clientHeight;
  if (hidden > 1) found.push(`${hidden} px of the menu are hidden`);
  for (const row of ["#status li", "#hints li, #control, #headset"]) {
    const parts = [...document.querySelectorAll(row)].map((part) => part.getBoundingClientRect());
    const top = Math.max(...parts.map((part) => part.top));
    const bottom = Math.min(...parts.map((part) => part.bottom));
    if (parts.length === 0 || top > bottom) found.push(`${row} take several rows`);
  }
  return found;
}"""


@pytest.mark.parametrize("language", LANGUAGES)
def test_tasks_and_controls_are_shown_as_a_whole_on_larger_windows(
    told_page, served, loop, outside, language
):
    presenter = FlowPresenter(loop, outside.services, DEFAULT_BINDINGS, Preferences())
    screens = screens_in(presenter, language)
    presenter.close()
    found = []
    for name in ("start", "experiment", "controls"):
        show(told_page, served, screens[name])
        for size in ("laptop", "full HD"):
            resize(told_page, *SIZES[size])
            told_page.evaluate("frames_(1)")
            found += [f"{name}, {size}: {each}" for each in told_page.evaluate(AROUND_MENU)]
    assert found == []


IN_FOCUS = """() => {
  return ["li[data-focus]", ".help"].map((selector) => {
    const part = document.querySelector(`#menu ${selector}`);
    const { left, top, bottom } = part.getBoundingClientRect();
    const at = (y) => document.elementFromPoint(left + 30, y);
    return [top + 3, bottom - 3].every((y) => part.contains(at(y)));
  });
}"""


def test_a_scrolled_list_shows_the_item_in_focus_and_its_help(told_page, served, loop, outside):
    presenter = FlowPresenter(loop, outside.services, DEFAULT_BINDINGS, Preferences())
    screen = screens_in(presenter, "de")["settings"]
    presenter.close()
    resize(told_page, *SIZES["laptop"])
    for item in screen.menu.items:
        show(told_page, served, replace(screen, menu=replace(screen.menu, focus=item.name)))
        said = told_page.evaluate("document.querySelector('#menu .help').textContent")
        assert said == with_units(item.help)
        assert told_page.evaluate(IN_FOCUS) == [True, True], item.name


TORN = """() => [...document.querySelectorAll("#menu :is(dt, dd)")].flatMap((value) => {
  const text = value.firstChild.data;
  const whole = /\\d\\s(?:mm|s|%)|(?:m[aá]x\\.|最大)\\s\\d|\\d+[.,]?\\d*[)）]|\\p{Script=Latin}+/gu;
  return [...text.matchAll(whole)].filter(({ index, 0: found }) => {
    const range = document.createRange();
    range.setStart(value.firstChild, index);
    range.setEnd(value.firstChild, index + found.length);
    return range.getClientRects().length > 1;
  }).map(() => text);
})"""


def test_no_word_of_a_fact_is_torn_and_no_number_from_its_unit_or_limit_on_a_phone(
    told_page, served, loop, outside
):
    resize(told_page, *SIZES["phone"])
    for language in LANGUAGES:
        presenter = FlowPresenter(loop, outside.services, DEFAULT_BINDINGS, Preferences())
        screens = screens_in(presenter, language)
        presenter.close()
        for name in ("match", "result", "procedure-errors", "tutorial-done"):
            show(told_page, served, screens[name])
            assert "mm" in told_page.inner_text("#menu dl")
            assert told_page.evaluate(TORN) == [], f"{name} in {language}"


def test_the_arrows_of_a_choice_stay_with_its_words(told_page, served):
    choice = MenuItem("view", "View", ItemKind.CHOICE, "A long value of it")
    show(told_page, served, Screen(menu=Menu("one", "One", items=(choice,))))
    arrow = "b => getComputedStyle(b, '::%s').content"
    for side, content in (("before", "◀\u00a0"), ("after", "\u00a0▶")):
        assert content in told_page.eval_on_selector("#menu li b", arrow % side)


def contrast(one, other):
    """Return the contrast of two sRGB colors of 0 to 255 (WCAG 2.2)."""

    def luminance(color):
        shares = [value / 255 for value in color]
        linear = [s / 12.92 if s <= 0.04045 else ((s + 0.055) / 1.055) ** 2.4 for s in shares]
        return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]

    dark, bright = sorted(map(luminance, (one, other)))
    return (bright + 0.05) / (dark + 0.05)


def test_disabled_items_are_legible():
    css = (WEB / "static" / "page.css").read_text(encoding="utf-8").replace("/ ", "")
    pale = bytes.fromhex(re.search(r"--pale: #(\w+);", css)[1])
    night = bytes.fromhex(re.search(r"--night: #(\w+);", css)[1])
    *color, percent = map(float, re.search(r"--row: rgb\((.*)%\);", css)[1].split())
    share = percent / 100
    row = [share * c + (1 - share) * n for c, n in zip(color, night, strict=True)]
    assert contrast(pale, row) >= 4.5
    pen = (WEB / "src" / "panels" / "pen.ts").read_text(encoding="utf-8")
    pale, row = (bytes.fromhex(re.search(rf'{name}: "#(\w+)"', pen)[1]) for name in ("pale", "row"))
    assert contrast(pale, row) >= 4.5


def test_a_selection_is_visible_with_forced_colors(place, page):
    trainee = place.trainee(PageKeys(page))
    trainee.go_home()
    shown(page, trainee)
    page.emulate_media(forced_colors="active")
    color = "button => getComputedStyle(button).backgroundColor"
    focused = page.eval_on_selector("#menu [data-focus] button", color)
    others = page.eval_on_selector_all(
        "#menu li:not([data-focus]) button",
        f"buttons => buttons.map({color})",
    )
    page.emulate_media(forced_colors="none")
    assert focused not in others


def test_zoom_enlarges_text(page):
    """At 200 % a window has half as many pixels each way, and each is twice as large."""
    sizes = []
    for size in ((1280, 720), (640, 360)):
        resize(page, *size)
        sizes.append(
            page.evaluate("parseFloat(getComputedStyle(document.documentElement).fontSize)")
        )
    assert sizes[1] >= sizes[0]
