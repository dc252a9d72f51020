"""Every sentence exists in every language, and can be repeated in another."""

import copy
import json
import pickle
import re
from pathlib import Path
from string import Formatter

import pytest

from rastrainer.commands import CommandName
from rastrainer_simulator.flow.session.preferences import OPTIONS
from rastrainer_simulator.input.bindings import DEFAULT_BINDINGS
from rastrainer_simulator.input.gamepads import GAMEPAD_INPUTS
from rastrainer_simulator.input.inputs import ControlName, InputDevice, SourceKind
from rastrainer_simulator.net.views.outgoing import screen_text
from rastrainer_simulator.presentation.screen import Screen, ScreenMessage
from rastrainer_simulator.texts.texts import (
    ENGLISH,
    LANGUAGES,
    NO_BREAK_SPACE,
    Texts,
    input_label,
    pair_label,
)

SERVER = Path(__file__).parents[3] / "RASTrainerSimulatorServer"
FOLDER = SERVER / "rastrainer_simulator" / "texts"
WEB = SERVER / "web" / "src" / "texts"
FEEDBACK = "What 3D Slicer says too (in English in rastrainer/trial/wording.json)"


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
def test_a_language_has_the_sections_of_english_in_their_order_and_each_key_once(language):
    found = sections(language)
    assert (FEEDBACK in found) == (language != "en")
    found.pop(FEEDBACK, None)
    assert list(found.items()) == list(sections("en").items())
    keys = [key for each in found.values() for key in each]
    assert len(keys) == len(set(keys))


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


def test_every_language_is_offered_by_its_own_name_in_all_of_them():
    for tag in LANGUAGES:
        assert len({table[f"settings.language.{tag}"] for table in LANGUAGES.values()}) == 1


def test_french_has_nonbreaking_spaces_before_double_punctuation_and_curly_apostrophes():
    for text in LANGUAGES["fr"].values():
        said = "".join(written for written, *_ in Formatter().parse(text))
        assert re.findall(r"[^\u202f][;:!?%»]|«[^\u202f]|'", f" {said}") == [], text
    assert LANGUAGES["fr"]["waiting.problem"].endswith("lui-même\u202f: {reason}")


def test_spanish_questions_and_exclamations_have_opening_marks():
    for text in LANGUAGES["es"].values():
        assert (text.count("?"), text.count("!")) == (text.count("¿"), text.count("¡"))


def test_chinese_has_full_width_punctuation_and_spaces_beside_numbers_and_latin_letters():
    wide = "[\u4e00-\u9fff]"
    for text in LANGUAGES["zh-Hans"].values():
        said = re.sub(r"{\w+:[^}]*}", "0", text)
        assert re.findall(rf"{wide}[0-9A-Za-z,;:?!()]|[0-9A-Za-z,;:?!()]{wide}", said) == [], text
        assert re.findall(r"\s[。，、；：？！）]|[。，、；：？！（]\s", said) == [], text


@pytest.mark.parametrize("language", LANGUAGES)
def test_two_directions_of_a_stick_or_of_arrow_keys_share_the_name_of_the_stick(language):
    texts = Texts(LANGUAGES[language])
    for device, name, pairs in (
        (InputDevice.GAMEPAD, "leftx", ("-leftx", "+leftx", "-lefty", "+lefty")),
        (InputDevice.GAMEPAD, "rightx", ("-rightx", "+rightx", "-righty", "+righty")),
        (InputDevice.KEYBOARD, "Arrow", ("ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown")),
    ):
        first, second, up, down = (input_label(texts, device.value, each) for each in pairs)
        assert len(pair_label(first, second)) < len(f"{first} / {second}"), name
        assert len(pair_label(up, down)) < len(f"{up} / {down}"), name


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


def test_slicers_feedback_is_shown_in_the_language_with_its_decimal_sign():
    german = Texts(LANGUAGES["de"])
    assert german.say("feedback.touch above", depth=1.25).startswith(
        ", vor allem in der Tiefe (1,2"
    )
    assert german.say("feedback.passed", mark=70.0) == "Bestanden: die Marke ist 70."


def test_a_negative_number_has_a_true_minus_sign_and_a_text_keeps_its_hyphens():
    assert Texts(LANGUAGES["de"]).say("tutorial.mm", error=-3.25) == "−3,2 mm"
    assert Texts().say("start", trainee="P-01", point="1") == "P-01, touch point 1."


@pytest.mark.parametrize("language", sorted(LANGUAGES))
def test_no_line_of_a_view_ends_between_a_number_and_its_unit(language):
    texts, values = Texts(LANGUAGES[language]), {"f": 12.5, "g": 10.0}
    for key, text in LANGUAGES[language].items():
        filled = {name: values.get(spec[-1:], 10) for name, spec in fields(text)}
        said = texts.say(key, **filled)
        sent = json.loads(screen_text(Screen(instruction=ScreenMessage(said))))
        shown = sent["screen"]["instruction"]["text"]
        assert shown.replace(NO_BREAK_SPACE, " ") == said.replace(NO_BREAK_SPACE, " ")
        assert re.findall(r"\d (?:mm|cm|s|min|MB|%|/ \d)(?!\w)|\d / (?=\d)", shown) == [], key


def test_a_value_with_braces_is_filled_in_verbatim():
    assert Texts().say("start", trainee="{point} {0}", point="1") == "{point} {0}, touch point 1."


def test_a_sentence_can_be_copied_and_sent_to_another_process():
    said = Texts().say("start", trainee="P01", point="1")
    for copied in (copy.copy(said), copy.deepcopy(said), pickle.loads(pickle.dumps(said))):
        assert (copied, copied.key, copied.values) == (said, said.key, said.values)


@pytest.mark.parametrize(
    ("first", "second", "together"),
    [
        ("Stick left", "Stick right", "Stick left / right"),
        ("Arrow up", "Tab", "Arrow up / Tab"),
        ("A", "D", "A / D"),
        ("Page up", "Arrow down", "Page up / Arrow down"),
    ],
)
def test_what_two_inputs_share_is_stated_once(first, second, together):
    assert pair_label(first, second) == together
