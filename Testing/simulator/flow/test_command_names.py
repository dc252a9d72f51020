"""No trainee reads the name of a command, on any page and in any notice."""

from __future__ import annotations

import dataclasses
import re

import pytest

from rastrainer.commands import CommandName
from rastrainer_simulator.texts.texts import LANGUAGES
from Testing.simulator.flow.every_page import names_of_pages, screens_in

COMMANDS = [name for key, name in vars(CommandName).items() if key.isupper()]
OF_SEVERAL_WORDS = re.compile("|".join(each for each in COMMANDS if not each[1:].islower()))


def texts_of(value) -> list[str]:
    """Return every text in a record and in its members."""
    if isinstance(value, str):
        return [str(value)]
    if isinstance(value, tuple):
        return [text for each in value for text in texts_of(each)]
    if dataclasses.is_dataclass(value):
        fields = (each.name for each in dataclasses.fields(value))
        return [text for name in fields for text in texts_of(getattr(value, name))]
    return []


@pytest.mark.parametrize("language", LANGUAGES)
def test_no_page_has_the_name_of_a_command(presenter, language):
    screens = screens_in(presenter, language)
    assert names_of_pages() <= screens.keys()
    texts = [text for screen in screens.values() for text in texts_of(screen)]
    assert len(texts) > 1000
    assert [text for text in texts if OF_SEVERAL_WORDS.search(text)] == []


@pytest.mark.parametrize("language", LANGUAGES)
def test_no_notice_has_the_name_of_a_command(trainee, language):
    """Nothing that a trainee can enter gets this far, but a study in Slicer may be wrong."""
    session = trainee.presenter._session
    session.prefer(language=language)
    session.do("StartTask", {"task": "task-1", "trainee": "P 07", "mode": "neither"})
    session.do("StartTask", {"task": "no such task", "trainee": "P07", "mode": "desktop"})
    session.do("SubmitRegistration")
    session.do("LockGuide")
    session.do("UseRegistration", {"trialId": "another", "matrix": [1.0] * 16, "freMm": 1.0})
    trainee.step(20)
    notices = [message.text for message in trainee.presenter.screen.warnings]
    assert len(notices) >= 3
    assert [text for text in notices if OF_SEVERAL_WORDS.search(text)] == []
