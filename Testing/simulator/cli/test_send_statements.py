"""Statements reach a learning record store: each once, none lost while it is unreachable."""

import json

import pytest

from rastrainer.errors import InputError
from rastrainer.study.study_data import read_study_data
from rastrainer_simulator.cli.main import main
from rastrainer_simulator.cli.send_statements import Sender, SentStatements
from rastrainer_simulator.export.xapi import statements
from rastrainer_simulator.net.record_store import (
    BATCH,
    RECORD_STORE_FILE,
    RecordStore,
    read_record_store_settings,
)
from Testing.domain.study.played_study import study_with_trials
from Testing.free_port import free_port
from Testing.simulator.cli.record_store_double import CREDENTIALS, RecordStoreDouble

HOME = "https://lab.example.org"
COUNT = 2 * BATCH + 7


def statement(number, score=80.0):
    return {
        "id": f"00000000-0000-4000-8000-{number:012d}",
        "actor": {"account": {"homePage": HOME, "name": f"T{number:03d}"}},
        "result": {"score": {"raw": score}},
    }


STATEMENTS = [statement(number) for number in range(COUNT)]


@pytest.fixture
def store():
    with RecordStoreDouble() as store:
        yield store


@pytest.fixture
def sender(store, tmp_path):
    return sender_of(store, tmp_path, STATEMENTS)


def sender_of(store, folder, found, pause=None):
    client = RecordStore(store.url, CREDENTIALS)
    return Sender(
        lambda: found, client, SentStatements(folder / "study.db", store.url, HOME), pause
    )


class EndedError(Exception):
    pass


def test_each_statement_is_sent_once_and_a_new_one_later(store, sender, tmp_path):
    assert sender.send() == 0
    assert len(store.statements) == COUNT
    assert store.requests == [BATCH, BATCH, 7]
    sender.send()
    assert len(store.requests) == 3
    sender_of(store, tmp_path, [*STATEMENTS, statement(COUNT)]).send()
    assert store.requests[3:] == [1]
    assert len(store.statements) == COUNT + 1


def test_nothing_is_lost_or_duplicated_while_the_store_is_unreachable(store, tmp_path, capsys):
    store.planned = [503, 429, 500]
    store.crashes = 2
    pauses = []

    def pause(seconds):
        pauses.append(seconds)
        if len(store.statements) == COUNT and not store.crashes and seconds == 60.0:
            raise EndedError

    with pytest.raises(EndedError):
        sender_of(store, tmp_path, STATEMENTS, pause).watch(60.0)
    assert list(store.statements.values()) == STATEMENTS
    assert pauses == [2.0, 4.0, 8.0, 16.0, 32.0, 60.0]
    assert capsys.readouterr().out.count("Nothing is lost") == 5


def test_a_store_that_is_not_running_is_named_and_everything_is_sent_later(tmp_path):
    port = free_port()
    url = f"http://127.0.0.1:{port}/xAPI"
    client = RecordStore(url, CREDENTIALS)
    sender = Sender(lambda: STATEMENTS, client, SentStatements(tmp_path / "s.db", url, HOME))
    with pytest.raises(InputError, match="does not answer: Connection refused"):
        sender.send()
    with RecordStoreDouble(port) as back:
        sender.send()
        assert len(back.statements) == COUNT


def test_a_statement_that_conflicts_or_is_refused_does_not_block_the_others(store, sender, capsys):
    store.statements[STATEMENTS[3]["id"]] = statement(3, score=10.0)
    store.refused = {STATEMENTS[60]["id"]}
    assert sender.send() == 1
    assert len(store.statements) == COUNT - 1
    assert store.statements[STATEMENTS[3]["id"]]["result"]["score"]["raw"] == 10.0
    said = capsys.readouterr().out
    assert f"{STATEMENTS[3]['id']}: the store has another version" in said
    assert f"{STATEMENTS[60]['id']}: refused by the store (status 400" in said
    requests = len(store.requests)
    sender.send()
    assert len(store.requests) == requests


def test_statements_sent_again_after_a_crash_are_recognized_by_the_store(store, sender, tmp_path):
    sender.send()
    (tmp_path / "study.db.xapi-sent.json").unlink()
    sender_of(store, tmp_path, STATEMENTS).send()
    assert list(store.statements.values()) == STATEMENTS


@pytest.mark.parametrize(("status", "words"), [(401, "credentials"), (302, "no record store")])
def test_wrong_credentials_and_redirects_end_it_with_a_message(store, sender, status, words):
    store.planned = [status]
    with pytest.raises(InputError, match=words):
        sender.send()
    assert store.statements == {}


@pytest.mark.parametrize(
    ("url", "words"),
    [
        ("http://lrs.example.org/xAPI", "in the clear"),
        ("ftp://lrs.example.org", "no address of a record store"),
        ("https://lab:secret@lrs.example.org/xAPI", "no address of a record store"),
        ("https://lrs.example.org:x/xAPI", "no number"),
        ("lrs.example.org", "no address of a record store"),
        ("https://[lrs.example.org", "a host that is none"),
    ],
)
def test_an_address_that_would_reveal_something_is_refused(url, words):
    with pytest.raises(InputError, match=words):
        RecordStore(url, CREDENTIALS)


@pytest.mark.parametrize("credentials", ["", "lab", ":secret", "lab:", "lab:se\ncret"])
def test_credentials_consist_of_name_and_password(credentials):
    with pytest.raises(InputError, match="name:password"):
        RecordStore("https://lrs.example.org/xAPI", credentials)


def test_the_command_sends_a_study_and_says_what_is_missing(store, tmp_path, capsys):
    stored_study = tmp_path / "study.db"
    study_with_trials(stored_study)
    expected = {each["id"] for each in statements(read_study_data(stored_study), HOME)}
    secret = tmp_path / "credentials"
    secret.write_text(CREDENTIALS + "\n")
    secret.chmod(0o644)
    words = ["send-statements", str(stored_study), "--store", store.url]
    given = [*words, "--home-page", HOME, "--credentials", str(secret)]
    assert main(given) == 2
    assert "Others can read" in capsys.readouterr().err
    secret.chmod(0o600)
    assert main(given) == 0
    assert set(store.statements) == expected
    sent = json.loads((stored_study.parent / f"{stored_study.name}.xapi-sent.json").read_text())
    assert sorted(*sent.values()) == sorted(store.statements)
    assert main([*words, "--home-page", "https://rastrainer.invalid"]) == 2
    assert "must be the address of the lab's own system" in capsys.readouterr().err
    assert main([*words, "--home-page", HOME]) == 2
    assert "RASTRAINER_XAPI_CREDENTIALS" in capsys.readouterr().err
    store.planned = [503]
    (stored_study.parent / f"{stored_study.name}.xapi-sent.json").unlink()
    assert main(given) == 1
    assert "run the command again" in capsys.readouterr().err


def test_options_that_never_change_can_be_set_in_a_file(store, tmp_path, capsys):
    stored_study = tmp_path / "study.db"
    study_with_trials(stored_study)
    words = ["send-statements", str(stored_study), "--config", str(tmp_path)]
    assert main(words) == 2
    assert "with --store, or as store in record-store.json" in capsys.readouterr().err
    (tmp_path / "secret").write_text(CREDENTIALS)
    (tmp_path / "secret").chmod(0o600)
    settings = {"store": store.url, "homePage": f"{HOME}/", "credentials": "secret"}
    (tmp_path / RECORD_STORE_FILE).write_text(json.dumps(settings))
    assert main(words) == 0
    expected = statements(read_study_data(stored_study), HOME)
    assert list(store.statements.values()) == expected
    exported = ["export", str(stored_study), "--format", "xapi", "--config", str(tmp_path)]
    assert main([*exported, "-o", str(tmp_path / "out")]) == 0
    assert json.loads((tmp_path / "out" / "xapi" / "statements.json").read_text()) == expected


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"homePage": "https://rastrainer.invalid"}, "homePage must be the address"),
        ({"homePage": "https://["}, "homePage must be the address"),
        ({"homePage": "https://lab.example.org:99999"}, "homePage must be the address"),
        ({"homePage": "https://name:password@lab.example.org"}, "homePage must be the address"),
        ({"homePage": "https://lab.example.org/?x"}, "homePage must be the address"),
        ({"homepage": HOME}, "there is no homepage"),
        ({"password": "secret"}, "there is no password"),
        ([], "must be a JSON object"),
    ],
    ids=str,
)
def test_unusable_settings_are_named(tmp_path, settings, words):
    (tmp_path / RECORD_STORE_FILE).write_text(json.dumps(settings))
    with pytest.raises(InputError, match=words):
        read_record_store_settings(tmp_path)


def test_a_damaged_file_of_sent_statements_is_named(tmp_path):
    (tmp_path / "study.db.xapi-sent.json").write_text('{"x": [1]}')
    with pytest.raises(InputError, match="does not hold lists of UUIDs"):
        SentStatements(tmp_path / "study.db", "https://lrs.example.org/xAPI", HOME)
