"""A teacher's board in a browser: a seat is added, watched, given orders, and removed."""

from __future__ import annotations

import pytest

from rastrainer_simulator.ops.instructor_pin import InstructorPin
from rastrainer_simulator.presentation.messages import Seat
from rastrainer_simulator.presentation.screen import Screen, ScreenMessage
from Testing.simulator.board.class_study import play_class
from Testing.simulator.board.conftest import PIN, BoardClient, WatchedSimulator
from Testing.simulator.net.views.served import ServedViews
from Testing.web.chromium import (
    accessibility_checker,
    draw_nothing,
    open_board_page,
    resize,
    wait_for,
)
from Testing.web.test_page_access import SIZES, VIOLATIONS
from Testing.web.test_spectator import NOTE_WHAT_IS_SENT

AT_WORK = Seat("P07", "Task 2", 15, instruction="Touch 3", score=71.5, holder="gamepad")
LONG = Seat(
    "A-trainee-whose-pseudonym-is-as-long-as-one-may-be-0123456789012",
    "Zielpunkte am Hinterkopf und an der Schläfe",
    15,
    warnings=("Die Verbindung zu 3D Slicer ist unterbrochen; alles wird nachgeliefert.",),
    score=100.0,
    holder="headset's controllers",
    slicer=True,
    assignments="12 von 24 erreicht · Als Nächstes: Aufgabe 4 mit dem Headset, dann Biopsie.",
)
CUT_OFF = """() => [...document.querySelectorAll("body *")]
  .filter((part) => part.checkVisibility() && part.clientWidth > 0)
  .filter((part) => part.matches(":not(input, .scroller, .scroller table, .scroller table *)"))
  .filter((part) => getComputedStyle(part).display !== "inline")
  .filter((part) => part.scrollWidth > part.clientWidth + 1
    || part.getBoundingClientRect().right > innerWidth + 1)
  .map((part) => `${part.tagName} ${part.textContent} is cut off`)"""
CELLS = """() => {
  const scroller = document.querySelector(".scroller");
  const found = [...scroller.querySelectorAll("th, td, button")]
    .filter((part) => part.scrollWidth > part.clientWidth + 1)
    .map((part) => `${part.tagName} ${part.textContent} is cut off`);
  scroller.scrollLeft = 10000;
  const { left } = scroller.querySelector("tbody th").getBoundingClientRect();
  const { left: edge } = scroller.getBoundingClientRect();
  if (Math.abs(left - edge) > 2) found.push("trainees are scrolled away");
  if (document.documentElement.scrollWidth > innerWidth + 1) found.push("the page scrolls");
  scroller.scrollLeft = 0;
  return found;
}"""
"""The table scrolls in its region, next to the trainees' names."""
KEEP_NOTICES = """() => {
  const { setTimeout } = window;
  window.setTimeout = (act, ms) => setTimeout(act, 100 * ms);
}"""
"""A notice disappears after some seconds, which a busy machine may need to read it."""


@pytest.fixture
def simulator(loop, loop_thread, tmp_path):
    config = tmp_path / "seat"
    config.mkdir()
    InstructorPin(config).set(PIN)
    served = ServedViews(loop_thread, loop, config=config)
    yield WatchedSimulator(served, config, tmp_path / "certificates")
    served.close()


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    """A class of virtual trainees, one of whom is at the seat."""
    path = tmp_path_factory.mktemp("class") / "study.db"
    play_class(path, ["T2", "T10", "T1", LONG.trainee], 12)
    return path


@pytest.fixture
def board(loop_thread, tmp_path, study):
    board = BoardClient(loop_thread, tmp_path / "teacher", study)
    yield board
    board.close()


def open_board(browser, board, locale: str = "en-US"):
    """Return the board's page once a seat can be added."""
    page = open_board_page(browser, board.url, board.server.code.code, locale)
    page.wait_for_selector("#add:not([hidden])")
    return page


def press(page, name: str) -> None:
    page.get_by_role("button", name=name, exact=True).click()


def test_a_teacher_adds_a_seat_by_keyboard_sees_it_change_gives_orders_and_removes_it(
    browser, board, simulator
):
    presenter = simulator.served.presenter
    presenter.reported_seat = AT_WORK
    page = open_board(browser, board)
    page.wait_for_selector("#empty:not([hidden])")
    page.focus("#add")
    page.keyboard.press("Enter")
    page.keyboard.type("Window 3")
    page.keyboard.press("Tab")
    page.keyboard.type(simulator.address)
    page.keyboard.press("Tab")
    page.keyboard.type(simulator.served.code)
    page.keyboard.press("Enter")
    page.wait_for_selector("dialog output.fingerprint")
    assert page.inner_text("dialog output.fingerprint") == simulator.fingerprint
    press(page, "They are the same")
    tile = page.locator("#seats > li")
    page.wait_for_selector("#seats > li[data-link=watching] .who:has-text('P07')")
    page.wait_for_selector("#seats > li:has-text('71.5 / 100')")
    page.wait_for_selector("#count:text-is('1 of 1 seats connected, 0 training')")
    presenter.reported_seat = Seat("<img src=x onerror=alert(1)>")
    page.wait_for_selector("#seats .who:has-text('<img src=x')")
    presenter.reported_seat = Seat("P07", screen="Experiment")
    page.wait_for_selector("#seats .says:text-is('Menu: Experiment')")

    press(page, "Send a sentence")
    page.fill("[name=text]", "Look from the side.")
    press(page, "Send")
    page.fill("[name=pin]", "000000")
    press(page, "Send")
    page.wait_for_selector("dialog output:has-text('This is not the PIN of this seat.')")
    page.fill("[name=pin]", PIN)
    page.evaluate(KEEP_NOTICES)
    press(page, "Send")
    page.wait_for_selector("#notice[data-tone=good]:has-text('The sentence is shown at Window 3.')")
    assert presenter.calls == [("instruct", "say", "Look from the side.")]

    press(page, "Remove")
    page.locator("dialog").get_by_role("button", name="Cancel").click()
    assert tile.count() == 1
    press(page, "Remove")
    page.locator("dialog").get_by_role("button", name="Remove").click()
    page.wait_for_selector("#empty:not([hidden])")
    assert page.problems == []
    page.context.close()


def test_a_seat_is_watched_live_from_the_board(browser, board, simulator):
    board.add(simulator)
    page = open_board(browser, board)
    with page.context.expect_page() as opened:
        page.get_by_role("link", name="Watch").click()
    live = opened.value
    draw_nothing(live)
    live.reload()
    live.wait_for_selector("body[data-watching][data-scene]")
    simulator.served.tell(Screen(instruction=ScreenMessage("Touch 3")))
    live.wait_for_selector("#instruction:has-text('Touch 3')")
    wait_for(live, "page.state !== null")
    assert live.locator("#take-part").is_hidden()
    live.evaluate(NOTE_WHAT_IS_SENT)
    live.keyboard.press("Space")
    live.evaluate("page.connection.send({ type: 'press', control: 'touch' })")
    assert live.evaluate("sent") == []
    assert simulator.served.presenter.calls == []
    page.context.close()


@pytest.mark.parametrize(
    ("locale", "driven"),
    [
        ("de-DE", "Controller des Headsets"),
        pytest.param("en-US", "headset's controllers", marks=pytest.mark.soak),
        pytest.param("fr-CA", "contrôleurs du casque", marks=pytest.mark.soak),
        pytest.param("es-MX", "controladores del visor", marks=pytest.mark.soak),
        pytest.param("zh-CN", "头显控制器", marks=pytest.mark.soak),
    ],
)
def test_the_board_breaks_no_accessibility_rule_and_fits_every_size_in_its_own_language(
    browser, board, simulator, locale, driven
):
    simulator.served.presenter.reported_seat = LONG
    for name in ("Window 3", "A place whose name is as long as may be..."[:40]):
        board.add(simulator, name)
    page = open_board(browser, board, locale)
    page.wait_for_selector("#seats > li[data-link=watching]")
    page.wait_for_selector("#class td:has-text('A place whose name')")
    page.evaluate(accessibility_checker())
    written = "zh-Hans" if locale == "zh-CN" else locale[:2]
    assert page.locator("html").get_attribute("lang") == written
    page.get_by_text(driven).first.wait_for()
    found = []

    def look(what: str, size: str = "narrowest") -> None:
        resize(page, *SIZES[size])
        wrong = page.evaluate(CUT_OFF) + page.evaluate(CELLS)
        wrong += page.evaluate(VIOLATIONS) if size == "narrowest" else []
        found.extend(f"{what}, {size}: {each}" for each in wrong)

    # The other sizes lie between these.
    look("tiles", "laptop")
    look("tiles")
    page.click("#add")
    look("form")
    page.context.close()
    assert found == []
