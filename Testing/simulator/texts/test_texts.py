"""Every sentence exists in every language, and can be repeated in another."""

import json
import re
from pathlib import Path
from string import Formatter

import pytest

from rastrainer.commands import CommandName
from rastrainer_simulator.flow.session.preferences import OPTIONS
from rastrainer_simulator.input.bindings import DEFAULT_BINDINGS
from rastrainer_simulator.input.gamepads import GAMEPAD_INPUTS
from rastrainer_simulator.input.inputs import ControlName, InputDevice, SourceKind
from rastrainer_simulator.texts.texts import (
    ENGLISH,
    LANGUAGES,
    NO_BREAK_SPACE,
    Texts,
)

SERVER = Path(__file__).parents[3] / "RASTrainerSimulatorServer"
FOLDER = SERVER / "rastrainer_simulator" / "texts"
WEB = SERVER / "web" / "src" / "texts"


def sections(language):
    """The sections of a language's file, in their order: titles, and the keys below each."""
    content = (FOLDER / f"{language}.json").read_text(encoding="utf-8")
    read = json.loads(content, object_pairs_hook=lambda pairs: [*pairs])
    return {title: [key for key, _text in pairs] for title, pairs in read}


def fields(sentence):
    return {(name, spec) for _, name, spec, _ in Formatter().parse(sentence) if name}


@pytest.mark.parametrize("language", sorted(LANGUAGES))
def test_a_language_has_every_sentence_with_the_same_placeholders(language):
    table = LANGUAGES[language]
    assert set(table) == set(ENGLISH)
    assert [key for key in ENGLISH if fields(table[key]) != fields(ENGLISH[key])] == []
    assert [key for key in table if not table[key].strip()] == []


@pytest.mark.parametrize("language", sorted(LANGUAGES))
def test_no_text_has_the_name_of_a_command(language):
    """A name of one word is also a verb or a noun, but not with a capital within a sentence."""
    names = {value for name, value in vars(CommandName).items() if name.isupper()}
    names -= {"Curriculum"} | ({"Pause"} if language == "de" else set())
    within = "|".join(name for name in names if sum(map(str.isupper, name)) == 1)
    whole = "|".join(name for name in names if sum(map(str.isupper, name)) > 1)
    named = re.compile(rf"\b(?:{whole})\b|(?<![.!?:]) (?:{within})\b")
    page = json.loads((WEB / f"{language}.json").read_text(encoding="utf-8"))
    texts = (*LANGUAGES[language].values(), *page["page"].values(), *page["board"].values())
    assert [text for text in texts if named.search(text.replace(NO_BREAK_SPACE, " "))] == []


def test_every_refusal_of_the_rules_is_among_the_codes_for_clients():
    written = (SERVER.parent / "docs" / "openigtlink.md").read_text(encoding="utf-8")
    rows = written.partition("### Refusals")[2].partition("\n## ")[0].splitlines()
    codes = {code for row in rows for code in re.findall("`([^`]*)`", row.split(" | ")[0])}
    of_rules = ("Refused in", "Touches that", "Commands in")
    keys = [
        key for title, keys in sections("en").items() if title.startswith(of_rules) for key in keys
    ]
    assert [key for key in (*keys, "tutorial is open") if key not in codes] == []


def test_every_key_that_the_code_builds_from_a_name_has_its_sentence():
    made = [f"control.{control.value}" for control in ControlName]
    made += [f"gamepad.{name}" for name in GAMEPAD_INPUTS]
    made += [f"source.{kind.value}" for kind in SourceKind]
    made += [f"device.{device.value}" for device in InputDevice]
    made += [f"settings.{name}{end}" for name in OPTIONS for end in ("", " help")]
    for name, options in OPTIONS.items():
        made += [f"settings.{name}.{option}" for option in options if isinstance(option, str)]
    keys = (
        name for inputs in DEFAULT_BINDINGS.table(InputDevice.KEYBOARD).values() for name in inputs
    )
    made += [f"keyboard.{name}" for name in keys if not name.startswith(("Key", "F1"))]
    assert [key for key in made if key not in ENGLISH] == []


def test_a_sentence_of_the_simulation_can_be_restated_in_another_language():
    english, german = Texts(), Texts(LANGUAGES["de"])
    said = english.say("above the skin", point="5", height=12.34)
    assert said == "12.3 mm above the skin: lower the tip onto point 5."
    assert german.again(said) == "12,3 mm über der Haut: Senke die Spitze auf Punkt 5."
    assert german.again("what others say") == "what others say"
    assert german.say("tutorial.mm", error=-3.25) == "−3,2 mm"
    verbatim = english.say("start", trainee="{point} P-01", point="1")
    assert verbatim == "{point} P-01, touch point 1."
