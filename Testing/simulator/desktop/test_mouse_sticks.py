"""What the window sends of the sticks that the mouse drags."""

import pygame
import pytest

from rastrainer_simulator.desktop.keyboard_and_mouse import MouseSticks
from rastrainer_simulator.desktop.panels.controls_picture import stick_boxes
from rastrainer_simulator.net.views.messages import STICKS

SIZE = (1280, 720)
LEFT = 1


class Kept:
    """Stands where the connection is, and keeps what is sent."""

    def __init__(self):
        self.messages = []

    def send(self, kind, **members):
        self.messages.append((kind, members))

    @property
    def last(self):
        kind, members = self.messages[-1]
        assert kind == STICKS
        return members["translation"], members["rotation"]


@pytest.fixture
def kept():
    return Kept()


@pytest.fixture
def sticks(kept):
    return MouseSticks(kept)


def middle(index):
    box = stick_boxes(SIZE)[index]
    return box.left + box.width // 2, box.top + box.height // 2


def mouse(sticks, kind, place, **members):
    return sticks.take(pygame.event.Event(kind, pos=place, **members), SIZE)


def test_a_drag_on_each_stick_moves_the_tip_and_ends_with_the_button(sticks, kept):
    x, y = middle(0)
    assert mouse(sticks, pygame.MOUSEBUTTONDOWN, (x, y - 20), button=LEFT)
    translation, rotation = kept.last
    assert translation[1] > 0.1
    assert rotation == [0.0, 0.0]
    mouse(sticks, pygame.MOUSEMOTION, (x + 900, y))
    assert kept.last[0] == pytest.approx([1.0, 0.0, 0.0], abs=0.02)
    mouse(sticks, pygame.MOUSEBUTTONUP, (x, y), button=LEFT)
    assert kept.last == ([0.0, 0.0, 0.0], [0.0, 0.0])
    x, y = middle(1)
    assert mouse(sticks, pygame.MOUSEBUTTONDOWN, (x, y + 30), button=LEFT)
    assert kept.last[0][2] < -0.2
    sticks.take(pygame.event.Event(pygame.WINDOWFOCUSLOST), SIZE)
    assert kept.last[0] == [0.0, 0.0, 0.0]


def test_a_click_beside_the_sticks_is_not_theirs(sticks, kept):
    assert not mouse(sticks, pygame.MOUSEBUTTONDOWN, (640, 100), button=LEFT)
    mouse(sticks, pygame.MOUSEMOTION, (700, 120))
    assert kept.messages == []


@pytest.mark.parametrize("size", [(960, 540), (1280, 720), (1920, 1080)], ids=str)
def test_the_sticks_lie_within_the_window_apart_from_each_other(size):
    left, right = stick_boxes(size)
    assert left.left > 0
    assert left.top > size[1] / 3
    assert left.left + left.width < right.left
    assert right.left + right.width < size[0]
    assert left.top + left.height < size[1]
    assert left.width >= 120
