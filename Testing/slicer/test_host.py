"""The host behaves as PythonQt does, as measured in Slicer 5.13."""

import importlib
import json
import logging
import os
from pathlib import Path

import numpy as np
import pytest

from rastrainer.errors import InputError
from Testing.slicer.host.members import (
    FACTS,
    MODULES,
    OFFERED,
    TARGET,
    reduced,
    text_of,
)


@pytest.fixture
def host(lasting_host):
    lasting_host.messages.clear()
    return lasting_host


@pytest.fixture
def qt(host):  # noqa: ARG001 (it brings Slicer's modules)
    return importlib.import_module("qt")


def test_a_property_is_an_attribute_and_an_unknown_member_or_signal_is_refused(qt):
    button = qt.QPushButton("a")
    assert button.text == "a"
    with pytest.raises(TypeError):
        button.text()
    button.setText("c")
    assert (button.text, button.enabled, button.isEnabled()) == ("c", True, True)
    with pytest.raises(AttributeError, match="QPushButton has no nosuch"):
        button.nosuch  # noqa: B018
    with pytest.raises(AttributeError, match="QPushButton has no nosuch"):
        button.nosuch = 1
    with pytest.raises(AttributeError):
        qt.QNoSuchWidget  # noqa: B018
    with pytest.raises(AttributeError):  # Qt 6 has it, Slicer's Qt 5.15 does not.
        qt.QCheckBox().checkStateChanged  # noqa: B018
    assert button.connect("clicked()", print) is True
    assert button.connect("nosuch()", print) is False


def test_keyword_arguments_and_numpy_numbers_are_refused(qt):
    with pytest.raises(TypeError, match="keyword"):
        qt.QPushButton().setText(text="a")
    with pytest.raises(TypeError, match="int64"):
        qt.QSpinBox().setValue(np.int64(3))


def test_an_exception_in_a_slot_is_recorded_and_the_click_continues(qt, host, caplog):
    import slicer

    def show():
        with slicer.util.tryWithErrorDisplay("It failed."):
            raise InputError("Enter a number.")

    heard, button = [], qt.QPushButton()
    button.connect("clicked()", lambda: 1 / 0)
    button.connect("clicked()", show)
    button.connect("clicked()", lambda: heard.append(1))
    with caplog.at_level(logging.CRITICAL):
        button.click()
    assert heard == [1]
    # It is a failure although a message box has shown it.
    assert "InputError" in host.errors.pop()
    assert host.messages[0].text.startswith("It failed.\n\n")
    assert "ZeroDivisionError" in host.errors.pop()


def test_an_unanswered_question_fails_the_test(host):
    import slicer

    assert slicer.util.confirmYesNoDisplay("Delete all?") is False
    assert "Delete all?" in host.errors.pop()
    host.answer("Delete", "Yes")
    assert slicer.util.confirmYesNoDisplay("Delete all?") is True


def test_the_table_covers_what_the_host_offers():
    for module in MODULES:
        assert list(FACTS[module]) == list(OFFERED[module])


def test_the_table_matches_the_measurement_if_available():
    full = os.environ.get("RASTRAINER_SLICER_API")
    measured = json.loads(Path(full).read_text()) if full else FACTS
    assert TARGET.read_text() == text_of(reduced(measured))
