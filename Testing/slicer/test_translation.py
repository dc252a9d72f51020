"""Each text is translated once for each file, as Slicer would translate it."""

import importlib.util
import sys
from types import ModuleType

import pytest

from rastrainer.slicer import translation

GERMAN = {
    ("module.panel", "Connect"): "Verbinden",
    ("module.desk", "Connect"): "Anschließen",
    ("module.panel", "{count} of {total}"): "{total}, davon {count}",
    ("module.panel", "{count} points"): "{anzahl} Punkte",
}


@pytest.fixture
def asked():
    """The texts that Slicer was asked to translate."""
    return []


@pytest.fixture
def tr(asked, monkeypatch):
    """Our translation in a Slicer that speaks German: `tr(file, text)`."""
    slicers = ModuleType("slicer.i18n")
    slicers.getContext = lambda file: f"module.{file}"

    def translate(context, text):
        asked.append((context, text))
        return GERMAN.get((context, text), text)

    slicers.translate = translate
    monkeypatch.setitem(sys.modules, "slicer.i18n", slicers)
    spec = importlib.util.spec_from_file_location("translation_in_slicer", translation.__file__)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return lambda file, text: eval(compile("_(text)", file, "eval"), {"_": module._, "text": text})


def test_each_text_is_translated_once_for_each_file_and_not_without_slicer(tr, asked):
    assert translation._("Connect") == "Connect"
    for _ in range(3):
        assert tr("panel", "Connect") == "Verbinden"
        assert tr("desk", "Connect") == "Anschließen"
    assert asked == [("module.panel", "Connect"), ("module.desk", "Connect")]


def test_placeholders_may_change_their_places_and_others_are_refused_once(tr, asked, caplog):
    text = tr("panel", "{count} of {total}")
    assert text.format(count=3, total=15) == "15, davon 3"
    asked.clear()
    for _ in range(2):
        assert tr("panel", "{count} points").format(count=3) == "3 points"
    assert len(asked) == len(caplog.records) == 1
    assert "lacks a placeholder" in caplog.text
