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

pytestmark = pytest.mark.usefixtures("host")


@pytest.fixture
def qt():
    return importlib.import_module("qt")


def test_a_property_is_an_attribute(qt):
    button = qt.QPushButton("a")
    assert button.text == "a"
    with pytest.raises(TypeError):
        button.text()
    button.text = "b"
    assert button.text == "b"
    button.setText("c")
    assert (button.text, button.enabled, button.isEnabled()) == ("c", True, True)


def test_an_unknown_member_raises_on_reading_and_on_assigning(qt):
    button = qt.QPushButton()
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


def test_an_exception_in_a_slot_is_recorded_and_the_click_continues(qt, host):
    heard = []
    button = qt.QPushButton()
    button.connect("clicked()", lambda: 1 / 0)
    button.connect("clicked()", lambda: heard.append(1))
    button.click()
    assert heard == [1]
    assert "ZeroDivisionError" in host.errors.pop()


@pytest.mark.parametrize("kind", [InputError, KeyError])
def test_what_a_slot_raises_is_a_failure_although_a_message_box_has_shown_it(
    qt, host, caplog, kind
):
    import slicer

    def fail():
        with slicer.util.tryWithErrorDisplay("It failed."):
            raise kind("Enter a number.")

    button = qt.QPushButton()
    button.connect("clicked()", fail)
    with caplog.at_level(logging.CRITICAL):
        button.click()
    assert kind.__name__ in host.errors.pop()
    assert host.messages[0].text.startswith("It failed.\n\n")


def test_keyword_arguments_and_numpy_numbers_are_refused(qt):
    with pytest.raises(TypeError, match="keyword"):
        qt.QPushButton().setText(text="a")
    with pytest.raises(TypeError, match="int64"):
        qt.QSpinBox().setValue(np.int64(3))


def test_a_missing_ui_file_or_child_raises():
    import slicer

    with pytest.raises(RuntimeError):
        slicer.util.loadUI("/nosuch.ui")
    with pytest.raises(RuntimeError):
        slicer.util.findChild(slicer.util.mainWindow(), "nosuch")


def test_a_ui_file_with_a_widget_or_property_that_slicer_lacks_is_refused(tmp_path):
    import slicer

    path = tmp_path / "a.ui"
    path.write_text('<ui version="4.0"><widget class="QLabel" name="a"/></ui>')
    assert slicer.util.loadUI(str(path)).className() == "QLabel"
    path.write_text('<ui version="4.0"><widget class="QNoSuch" name="a"/></ui>')
    with pytest.raises(AttributeError, match="QNoSuch"):
        slicer.util.loadUI(str(path))
    prop = '<property name="nosuch"><bool>true</bool></property>'
    path.write_text(f'<ui version="4.0"><widget class="QLabel" name="a">{prop}</widget></ui>')
    with pytest.raises(AttributeError, match="nosuch"):
        slicer.util.loadUI(str(path))


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
