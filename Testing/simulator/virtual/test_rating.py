"""Replays are rated blinded: under numbers, in any view, stored mark by mark, resumed."""

from __future__ import annotations

import random
import re
import sqlite3
import uuid
from concurrent.futures import Future

import pytest

from rastrainer.errors import InputError
from rastrainer.journal.folder import journals
from rastrainer.study.database.study import STUDY_FILE, Study
from rastrainer.study.database.values import day_of
from rastrainer.study.ratings import GEARS, OSATS, RatingStore
from rastrainer_simulator.cli.main import main
from rastrainer_simulator.net.views.outgoing import scene_news, screen_text, state_news
from rastrainer_simulator.presentation.messages import (
    CoveringBodies,
    Feedback,
    Hello,
    Seat,
    message_text,
)
from rastrainer_simulator.presentation.screen import Screen
from rastrainer_simulator.rating.rating_presenter import RatingPresenter
from rastrainer_simulator.rating.rating_work import RatingWork
from rastrainer_simulator.server.replay_server import ReplayLoader, trials_to_show
from rastrainer_simulator.virtual.cohort import RECORDS

VIEW = 1
PRESSED, AT_REST = 1.0, (0.0,) * 17


class Rater:
    """A rater at the presenter, with the replays of a study."""

    def __init__(self, folder, study, loader):
        self.records = folder / RECORDS
        store = RatingStore(study)
        trials = trials_to_show(study, self.records)
        order = store.assign("R1", trials, 3, random.Random("R1"))
        self.work = RatingWork(store, "R1", order, (GEARS, OSATS))
        self.store, self.messages, self.left = store, [], []
        self.loaded: list[str] = []
        self._loader = loader
        first = loader.load(self.work.trial_id)
        self.presenter = RatingPresenter(
            self.work, first, self._load, "en", lambda: self.left.append(True)
        )
        self.presenter.updates.add(self.messages.append)
        self.presenter.view_joined(VIEW, Hello("page"))

    def _load(self, trial_id):
        self.loaded.append(trial_id)
        loading: Future = Future()
        try:
            loading.set_result(self._loader.load(trial_id))
        except InputError as error:
            loading.set_exception(error)
        return loading

    def key(self, *codes):
        for code in codes:
            for is_down in (True, False):
                self.presenter.on_key(VIEW, code, is_down, "")

    def click(self, *items):
        for item in items:
            menu = self.presenter.screen.menu
            hints = [hint.item for hint in self.presenter.screen.hints]
            assert item in [*hints, *([] if menu is None else [each.name for each in menu.items])]
            self.presenter.on_item(VIEW, item)

    @property
    def menu(self):
        return self.presenter.screen.menu


@pytest.fixture
def study(copied):
    with Study.open(copied / STUDY_FILE) as opened:
        yield opened


@pytest.fixture(scope="module")
def setups():
    """Return the set-ups that loaders have made: each takes a second."""
    return {}


@pytest.fixture
def loader(copied, setups):
    loader = ReplayLoader(copied / RECORDS, None)
    loader._setups = setups
    return loader


@pytest.fixture
def rater(copied, study, loader):
    return Rater(copied, study, loader)


def test_a_replay_is_watched_and_rated_by_keys_one_domain_after_the_other(rater):
    assert rater.menu is None
    assert rater.presenter.screen.instruction.text == "Replay 1 of 3: watch it, then rate it"
    rater.key("Escape")
    assert not rater.presenter.shown.playback.is_playing
    titles = []
    for mark in (1, 2, 3, 4, 5, 4, 3, 2):
        titles.append(rater.menu.title)
        rater.key(f"Digit{mark}" if mark % 2 else f"Numpad{mark}")
    assert titles[0] == "GEARS: Depth perception"
    assert titles[-1] == "OSATS global rating: Flow of operation and forward planning"
    assert rater.menu.name == "rated"
    assert [fact.value for fact in rater.menu.facts] == list("12345432")
    assert rater.work.rated == 1


def test_marks_are_given_by_clicks_and_a_held_key_or_button_counts_once(rater):
    rater.click("rate")
    labels = [item.label for item in rater.menu.items if item.name.startswith("mark")]
    assert labels[0] == "1: Misjudges depth repeatedly; far off or pressed in"
    assert rater.menu.focus == "watch"
    rater.click("mark 4", "mark 2", "undo", "mark 5")
    assert rater.work.marks == {"gears_depth": 4, "gears_efficiency": 5}
    for _ in range(5):
        rater.presenter.on_key(VIEW, "Digit3", True, "")
    assert rater.work.marks == {"gears_depth": 4, "gears_efficiency": 5, "gears_force": 3}
    rater.presenter.on_key(VIEW, "Digit3", False, "")
    back = tuple(PRESSED if number == 1 else 0.0 for number in range(17))
    for _ in range(5):
        rater.presenter.on_pad(VIEW, (0.0,) * 4, back)
    assert rater.menu is None
    assert rater.presenter.shown.playback.is_playing


def test_marks_are_given_by_a_gamepad_and_by_controllers(rater):
    def press(button):
        held = tuple(PRESSED if number == button else 0.0 for number in range(17))
        rater.presenter.on_pad(VIEW, (0.0,) * 4, held)
        rater.presenter.on_pad(VIEW, (0.0,) * 4, AT_REST)

    press(9)
    assert rater.menu.name == "rating"
    # From "watch" over the end to the first mark, and one on.
    for _ in range(3):
        press(13)
    press(0)
    assert rater.work.marks == {"gears_depth": 2}
    for control in ("down", "down", "touch"):
        rater.presenter.on_press(VIEW, control)
    assert rater.work.marks == {"gears_depth": 2, "gears_efficiency": 1}
    press(1)
    assert rater.menu is None


def rate_all(rater, mark=3):
    for _ in rater.work.trial_ids:
        rater.key("Escape")
        while rater.menu.name == "rating":
            rater.key(f"Digit{mark}")
        if "next" in {item.name for item in rater.menu.items}:
            rater.click("next")
            rater.presenter.advance(0.01)


def test_each_replay_is_followed_by_the_next_and_the_last_by_thanks(rater):
    first = rater.presenter.shown.playback
    rate_all(rater)
    assert rater.presenter.shown.playback is not first
    # A view loads the scene of another set-up anew.
    assert rater.presenter.shown.setup is first.setup
    assert rater.loaded == list(rater.work.trial_ids[1:])
    assert rater.menu.title == "All 3 replays are rated"
    rater.click("previous")
    rater.presenter.advance(0.01)
    assert rater.presenter.screen.instruction.text.startswith("Replay 2 of 3")
    rater.key("Escape")
    rater.click("undo")
    assert rater.work.rated == 2
    rater.click("leave")
    assert rater.left == [True]
    assert len(rater.store.ratings()) == 5


def everything_shown(rater):
    """Return all that a view could have been sent."""
    presenter = rater.presenter
    found = [screen_text(m) for m in rater.messages if isinstance(m, Screen)]
    found += [message_text(m) for m in rater.messages if isinstance(m, Feedback)]
    state = presenter.shown.latest
    found.append(message_text(state_news(state, 0, presenter.pictures(state), CoveringBodies())))
    setup = presenter.shown.setup
    found.append(
        message_text(scene_news("0" * 64, setup.scenario, state.training.task, setup.settings.axes))
    )
    # A member of every state; its value would tell.
    return "\n".join(found).replace('"headset":', "")


def test_nothing_reveals_whose_trial_it_is_when_it_was_how_good_or_in_which_mode(rater, study):
    rater.presenter.advance(0.1)
    for code in ("ArrowUp", "KeyT", "ArrowRight", "KeyC", "Space"):
        rater.key(code)
        rater.presenter.shown.playback.advance(1.0)
    assert rater.presenter.shown.playback.speed == 1.0
    rater.presenter.shown.playback.play_from(1e6)
    rater.presenter.shown.playback.advance(1.0)
    rate_all(rater)
    shown = everything_shown(rater)
    for trial_id in rater.work.trial_ids:
        record = study.trial(trial_id).record
        for secret in (record.trial_id, record.trainee, day_of(record.started_utc)):
            assert secret not in shown, secret
    for name in ("trainee", "score", "mode", "startedUtc", "trialId", "trueTreMm"):
        assert f'"{name}"' not in shown, name
    assert not re.search(r"\b(hmd|headset|Worst touch)\b", shown)
    assert rater.presenter.seat() == Seat()


def test_a_replay_whose_journal_is_damaged_says_so_without_naming_it(rater):
    rater.key("Escape", *["Digit3"] * 8)
    following = rater.work.trial_ids[1]
    (path,) = rater.records.glob(f"*{following}*")
    path.write_bytes(b"nothing")
    rater.click("next")
    rater.presenter.advance(0.01)
    (text,) = rater.menu.paragraphs
    assert text.startswith("This replay cannot be shown: its journal is damaged")
    assert following not in text
    rater.click("leave")
    assert rater.left == [True]


def test_a_mark_that_cannot_be_stored_is_reported_and_can_be_given_again(rater, study):
    rater.key("Escape")
    other = sqlite3.connect(study.database.path, isolation_level=None)
    other.execute("BEGIN IMMEDIATE")
    study.database._lock_wait._most_s = 0.0
    rater.key("Digit4")
    (warning,) = rater.presenter.screen.warnings
    assert rater.work.marks == {}
    assert warning.text
    other.execute("ROLLBACK")
    other.close()
    rater.key("Digit4")
    assert rater.work.marks == {"gears_depth": 4}
    assert rater.presenter.screen.warnings == ()


def test_the_program_accepts_marks_and_resumes_where_it_was(copied, serving, tmp_path, study):
    store = RatingStore(study)
    trials = trials_to_show(study, copied / RECORDS)
    (first, *_) = store.assign("R1", trials, 2, random.Random("R1"))
    store.give(str(uuid.uuid4()), "R1", first, GEARS, "gears_depth", 4)
    words = ("rate", copied / STUDY_FILE, "--records", copied / RECORDS)
    process, lines, view = serving(*words, "--rater", "R1", "--replays", "2")
    assert lines[0] == "RASTrainer rating has 2 replays for R1, 0 rated\n"

    def press(code, is_released=True):
        for is_down in (True, False)[: 1 + is_released]:
            view.send({"type": "key", "code": code, "isDown": is_down, "text": ""})

    def until(part, text):
        view.all_until(lambda m: m["type"] == "screen" and text in str(m["screen"][part]))

    until("instruction", "Replay 1 of 2")
    press("Escape")
    until("menu", "Efficiency")
    for _ in range(7):
        press("Digit3")
    until("menu", "is rated")
    # The focus moves from the first item over the end to the last.
    press("ArrowUp")
    until("menu", "'focus': 'leave'")
    # Not released: it ends the program.
    press("Enter", is_released=False)
    assert process.wait(60) == 0
    assert "1 of 2 replays are rated" in process.stdout.read()
    data = store.ratings()
    assert {each.form: each.total for each in data} == {"gears": 13, "osats": 12}
    words = ["export", copied / STUDY_FILE, "-o", tmp_path / "out", "--format", "csv"]
    assert main([str(word) for word in words]) == 0
    rows = (tmp_path / "out" / "csv" / "ratings.csv").read_text(encoding="utf-8").splitlines()
    assert rows[0] == "trial_id,rater,form,domain,mark"
    assert f"{data[0].trial_id},R1,gears,gears_depth,4" in rows
    assert len(rows) == 9


def test_only_trials_with_consent_and_a_journal_are_rated(copied, study):
    every = trials_to_show(study, copied / RECORDS)
    assert len(every) == 4
    journals(copied / RECORDS)[0].unlink()
    assert len(trials_to_show(study, copied / RECORDS)) == 3
    for trainee in study.trainees():
        study.change_trainee(trainee.pseudonym, consent=False)
    with pytest.raises(InputError, match="There is nothing to rate"):
        trials_to_show(study, copied / RECORDS)
