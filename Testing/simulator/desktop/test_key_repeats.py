"""A window that draws slowly types no row of letters."""

from __future__ import annotations

import pygame
import pytest

from rastrainer_simulator.desktop.keyboard_and_mouse import without_late_repeats

A, B = pygame.KSCAN_A, pygame.KSCAN_B


def press(scancode):
    return pygame.event.Event(pygame.KEYDOWN, scancode=scancode)


def release(scancode):
    return pygame.event.Event(pygame.KEYUP, scancode=scancode)


@pytest.mark.parametrize(
    ("held", "events", "left"),
    [
        ([], [press(A), release(A), press(B), release(B)], [0, 1, 2, 3]),
        ([], [press(A), press(A), press(A), release(A)], [0, 3]),
        ([A], [press(A), press(A), release(A), press(A)], [2, 3]),
        ([A], [press(A), press(A), press(B), press(A)], [0, 2]),
        ([A], [press(B), press(A), release(A), press(B)], [0, 2, 3]),
    ],
    ids=["taps", "tap in one look", "tap over two looks", "held", "two keys"],
)
def test_of_a_held_key_one_repeat_a_look_is_left_and_none_of_one_that_was_let_go(
    held, events, left
):
    kept = without_late_repeats(events, held.__contains__)
    assert [id(event) for event in kept] == [id(events[index]) for index in left]


def test_everything_else_is_left_as_it_came():
    others = [pygame.event.Event(kind) for kind in (pygame.QUIT, pygame.MOUSEMOTION)]
    assert without_late_repeats(others, lambda _scancode: True) == others
