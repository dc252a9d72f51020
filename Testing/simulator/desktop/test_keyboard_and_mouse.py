"""What the window sends: keys, the sticks that the mouse drags, and turns of the view."""

from __future__ import annotations

from typing import ClassVar

import pygame
import pytest

from rastrainer_simulator.desktop.keyboard_and_mouse import (
    CODES,
    DEG_PER_HEIGHT,
    MouseSticks,
    ViewMouse,
    key_names,
    without_late_repeats,
)
from rastrainer_simulator.desktop.panels.controls_picture import stick_boxes
from rastrainer_simulator.input.bindings import DEFAULT_BINDINGS
from rastrainer_simulator.presentation.messages import OrbitInput, SticksInput

SIZE = (1280, 720)
HEIGHT = 720
LEFT, RIGHT = 1, 3
A, B = pygame.KSCAN_A, pygame.KSCAN_B
# SDL's constants beside the codes of the W3C's table, from both documents.
BOTH = {
    pygame.KSCAN_A: "KeyA",
    pygame.KSCAN_Z: "KeyZ",
    pygame.KSCAN_1: "Digit1",
    pygame.KSCAN_0: "Digit0",
    pygame.KSCAN_RETURN: "Enter",
    pygame.KSCAN_ESCAPE: "Escape",
    pygame.KSCAN_BACKSPACE: "Backspace",
    pygame.KSCAN_TAB: "Tab",
    pygame.KSCAN_SPACE: "Space",
    pygame.KSCAN_MINUS: "Minus",
    pygame.KSCAN_SLASH: "Slash",
    pygame.KSCAN_F1: "F1",
    pygame.KSCAN_F12: "F12",
    pygame.KSCAN_PAGEUP: "PageUp",
    pygame.KSCAN_PAGEDOWN: "PageDown",
    pygame.KSCAN_RIGHT: "ArrowRight",
    pygame.KSCAN_LEFT: "ArrowLeft",
    pygame.KSCAN_DOWN: "ArrowDown",
    pygame.KSCAN_UP: "ArrowUp",
    pygame.KSCAN_KP_ENTER: "NumpadEnter",
    pygame.KSCAN_KP0: "Numpad0",
    pygame.KSCAN_LCTRL: "ControlLeft",
    pygame.KSCAN_LSHIFT: "ShiftLeft",
    pygame.KSCAN_RSHIFT: "ShiftRight",
    pygame.KSCAN_RALT: "AltRight",
}


@pytest.mark.parametrize(("scancode", "code"), BOTH.items())
def test_a_key_is_identified_by_its_position(scancode, code):
    assert CODES[scancode] == code


class Keyboard(tuple):
    """SDL's answer to which keys are pressed, on a French keyboard: asked by what is on a key."""

    AZERTY: ClassVar = {"a": "KeyQ", "q": "KeyA", "&": "Digit1", "é": "Digit2", " ": "Space"}

    def __getitem__(self, written):
        code = self.AZERTY.get(chr(written), "")
        return tuple.__getitem__(self, next((s for s, c in CODES.items() if c == code), 0))


def test_keys_are_named_by_what_is_written_on_them(monkeypatch):
    monkeypatch.setattr(pygame.key, "get_pressed", lambda: Keyboard([False] * 512))
    names = {"KeyQ": "a", "KeyA": "q", "Digit1": "&", "Digit2": "é"}
    assert key_names() == names


def test_every_key_with_a_function_can_be_pressed_in_the_window():
    bound = {code for codes in DEFAULT_BINDINGS.keyboard.values() for code in codes}
    assert bound <= set(CODES.values())


def key_down(scancode):
    return pygame.event.Event(pygame.KEYDOWN, scancode=scancode)


def key_up(scancode):
    return pygame.event.Event(pygame.KEYUP, scancode=scancode)


@pytest.mark.parametrize(
    ("held", "events", "left"),
    [
        ([], [key_down(A), key_up(A), key_down(B), key_up(B)], [0, 1, 2, 3]),
        ([], [key_down(A), key_down(A), key_down(A), key_up(A)], [0, 3]),
        ([A], [key_down(A), key_down(A), key_up(A), key_down(A)], [2, 3]),
        ([A], [key_down(A), key_down(A), key_down(B), key_down(A)], [0, 2]),
        ([A], [key_down(B), key_down(A), key_up(A), key_down(B)], [0, 2, 3]),
    ],
    ids=["taps", "tap in one look", "tap over two looks", "held", "two keys"],
)
def test_a_held_key_repeats_at_most_once_per_frame_and_a_released_key_not_at_all(
    held, events, left
):
    kept = without_late_repeats(events, held.__contains__)
    assert [id(event) for event in kept] == [id(events[index]) for index in left]


def test_all_other_events_are_left_unchanged():
    others = [pygame.event.Event(kind) for kind in (pygame.QUIT, pygame.MOUSEMOTION)]
    assert without_late_repeats(others, lambda _scancode: True) == others


class Kept:
    """Stands in for the connection, and records what is sent."""

    def __init__(self):
        self.messages = []

    def send(self, message):
        self.messages.append(message)

    @property
    def last(self):
        message = self.messages[-1]
        assert isinstance(message, SticksInput)
        return list(message.translation), list(message.rotation)


@pytest.fixture
def kept():
    return Kept()


@pytest.fixture
def sticks(kept):
    return MouseSticks(kept)


def middle(index):
    box = stick_boxes(SIZE)[index]
    return box.left + box.width // 2, box.top + box.height // 2


def drag(sticks, kind, place, **members):
    return sticks.take(pygame.event.Event(kind, pos=place, **members), SIZE)


def test_a_drag_on_each_stick_moves_the_tip_until_the_button_is_released(sticks, kept):
    x, y = middle(0)
    assert drag(sticks, pygame.MOUSEBUTTONDOWN, (x, y - 20), button=LEFT)
    translation, rotation = kept.last
    assert translation[1] > 0.1
    assert rotation == [0.0, 0.0]
    drag(sticks, pygame.MOUSEMOTION, (x + 900, y))
    assert kept.last[0] == pytest.approx([1.0, 0.0, 0.0], abs=0.02)
    drag(sticks, pygame.MOUSEBUTTONUP, (x, y), button=LEFT)
    assert kept.last == ([0.0, 0.0, 0.0], [0.0, 0.0])
    x, y = middle(1)
    assert drag(sticks, pygame.MOUSEBUTTONDOWN, (x, y + 30), button=LEFT)
    assert kept.last[0][2] < -0.2
    sticks.take(pygame.event.Event(pygame.WINDOWFOCUSLOST), SIZE)
    assert kept.last[0] == [0.0, 0.0, 0.0]


def test_a_click_outside_the_sticks_is_ignored_by_them(sticks, kept):
    assert not drag(sticks, pygame.MOUSEBUTTONDOWN, (640, 100), button=LEFT)
    drag(sticks, pygame.MOUSEMOTION, (700, 120))
    assert kept.messages == []


@pytest.mark.parametrize("size", [(960, 540), (1280, 720), (1920, 1080)], ids=str)
def test_the_sticks_lie_apart_within_the_window(size):
    left, right = stick_boxes(size)
    assert left.left > 0
    assert left.top > size[1] / 3
    assert left.left + left.width < right.left
    assert right.left + right.width < size[0]
    assert left.top + left.height < size[1]
    assert left.width >= 120


@pytest.fixture
def mouse(kept):
    return ViewMouse(kept)


def press(mouse, button, is_down=True):
    kind = pygame.MOUSEBUTTONDOWN if is_down else pygame.MOUSEBUTTONUP
    mouse.take(pygame.event.Event(kind, button=button, pos=(0, 0)), HEIGHT)


def move(mouse, right, down):
    mouse.take(pygame.event.Event(pygame.MOUSEMOTION, rel=(right, down), pos=(0, 0)), HEIGHT)


def test_a_drag_with_the_right_button_is_sent_once_per_frame_until_its_release(mouse, kept):
    press(mouse, RIGHT)
    move(mouse, 30, 0)
    move(mouse, 42, 36)
    mouse.tell(is_wanted=True)
    mouse.tell(is_wanted=True)
    (turn,) = kept.messages
    assert isinstance(turn, OrbitInput)
    # The scene follows the pointer to the right and down: the eye goes left and up.
    assert turn.around_deg == pytest.approx(-DEG_PER_HEIGHT / 10)
    assert turn.higher_deg == pytest.approx(DEG_PER_HEIGHT / 20)
    assert turn.zoom == 1.0
    press(mouse, RIGHT, is_down=False)
    move(mouse, 100, 0)
    press(mouse, LEFT)
    move(mouse, 100, 0)
    mouse.tell(is_wanted=True)
    assert len(kept.messages) == 1


def test_wheel_and_pinch_zoom_in_and_out(mouse, kept):
    for event in (
        pygame.event.Event(pygame.MOUSEWHEEL, y=2),
        pygame.event.Event(pygame.MULTIGESTURE, pinched=-0.2),
    ):
        mouse.take(event, HEIGHT)
        mouse.tell(is_wanted=True)
    nearer, farther = (turn.zoom for turn in kept.messages)
    assert nearer < 1.0 < farther


def test_mouse_motion_over_a_menu_turns_nothing_later(mouse, kept):
    press(mouse, RIGHT)
    move(mouse, 500, 0)
    mouse.tell(is_wanted=False)
    mouse.tell(is_wanted=True)
    assert kept.messages == []


def test_the_simulator_accepts_the_message_however_wild_the_mouse_motion(mouse, kept):
    press(mouse, RIGHT)
    move(mouse, 10_000, -10_000)
    mouse.take(pygame.event.Event(pygame.MOUSEWHEEL, y=100), HEIGHT)
    mouse.tell(is_wanted=True)
    assert kept.messages == [OrbitInput(-180.0, -180.0, 0.25)]
