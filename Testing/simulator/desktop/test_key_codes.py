import pygame
import pytest

from rastrainer_simulator.desktop.keyboard_and_mouse import CODES
from rastrainer_simulator.input.bindings import DEFAULT_BINDINGS

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
def test_a_key_is_named_by_its_place(scancode, code):
    assert CODES[scancode] == code


def test_every_key_that_does_something_can_be_pressed_in_the_window():
    bound = {code for codes in DEFAULT_BINDINGS.keyboard.values() for code in codes}
    assert bound <= set(CODES.values())
