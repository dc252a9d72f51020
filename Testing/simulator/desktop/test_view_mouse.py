"""What the window sends of the mouse and the touch pad that turn the view."""

import pygame
import pytest

from rastrainer_simulator.desktop.keyboard_and_mouse import DEG_PER_HEIGHT, ViewMouse
from rastrainer_simulator.net.views.messages import ORBIT

HEIGHT = 720
RIGHT, LEFT = 3, 1


class Sent:
    """Stands where the connection is, and keeps what is sent."""

    def __init__(self):
        self.messages = []

    def send(self, kind, **members):
        self.messages.append((kind, members))


@pytest.fixture
def sent():
    return Sent()


@pytest.fixture
def mouse(sent):
    return ViewMouse(sent)


def press(mouse, button, is_down=True):
    kind = pygame.MOUSEBUTTONDOWN if is_down else pygame.MOUSEBUTTONUP
    mouse.take(pygame.event.Event(kind, button=button, pos=(0, 0)), HEIGHT)


def move(mouse, right, down):
    mouse.take(pygame.event.Event(pygame.MOUSEMOTION, rel=(right, down), pos=(0, 0)), HEIGHT)


def test_a_drag_with_the_right_button_is_sent_once_a_picture_and_ends_with_the_button(mouse, sent):
    press(mouse, RIGHT)
    move(mouse, 30, 0)
    move(mouse, 42, 36)
    mouse.tell(is_wanted=True)
    mouse.tell(is_wanted=True)
    ((kind, members),) = sent.messages
    assert kind == ORBIT
    # What is seen follows the pointer to the right and down: the eye goes left and up.
    assert members["aroundDeg"] == pytest.approx(-DEG_PER_HEIGHT / 10)
    assert members["higherDeg"] == pytest.approx(DEG_PER_HEIGHT / 20)
    assert members["zoom"] == 1.0
    press(mouse, RIGHT, is_down=False)
    move(mouse, 100, 0)
    press(mouse, LEFT)
    move(mouse, 100, 0)
    mouse.tell(is_wanted=True)
    assert len(sent.messages) == 1


def test_wheel_and_pinch_go_nearer_and_farther(mouse, sent):
    for event in (
        pygame.event.Event(pygame.MOUSEWHEEL, y=2),
        pygame.event.Event(pygame.MULTIGESTURE, pinched=-0.2),
    ):
        mouse.take(event, HEIGHT)
        mouse.tell(is_wanted=True)
    nearer, farther = (members["zoom"] for _, members in sent.messages)
    assert nearer < 1.0 < farther


def test_what_is_done_over_a_menu_turns_nothing_later(mouse, sent):
    press(mouse, RIGHT)
    move(mouse, 500, 0)
    mouse.tell(is_wanted=False)
    mouse.tell(is_wanted=True)
    assert sent.messages == []


def test_however_wild_the_hand_the_simulator_takes_the_message(mouse, sent):
    press(mouse, RIGHT)
    move(mouse, 10_000, -10_000)
    mouse.take(pygame.event.Event(pygame.MOUSEWHEEL, y=100), HEIGHT)
    mouse.tell(is_wanted=True)
    ((_, members),) = sent.messages
    assert members == {"aroundDeg": -180.0, "higherDeg": -180.0, "zoom": 0.25}
