"""The lab's settings say which platforms may launch; errors in them are reported."""

from __future__ import annotations

import json
import os
import stat
import sys

import pytest
from cryptography.hazmat.primitives.asymmetric import rsa

from rastrainer.errors import InputError
from rastrainer_simulator.cli.main import main
from rastrainer_simulator.lti.settings import KEY_FILE, SETTINGS_FILE, ToolKey, read_lti_settings

ADDRESS = "https://rastrainer.example.org"
PLATFORM = {
    "name": "University",
    "issuer": "https://courses.example.org",
    "clientId": "tool-1",
    "deploymentIds": ["1"],
    "authenticationUrl": "https://courses.example.org/auth",
    "tokenUrl": "https://courses.example.org/token",
    "keySetUrl": "https://courses.example.org/jwks",
}


def write(folder, **values):
    (folder / SETTINGS_FILE).write_text(json.dumps({"address": ADDRESS, "platforms": [], **values}))


def test_settings_are_read_with_their_defaults(tmp_path):
    write(tmp_path, address=f"{ADDRESS}/", platforms=[PLATFORM, {**PLATFORM, "clientId": "tool-2"}])
    settings = read_lti_settings(tmp_path)
    assert settings.launch_url == f"{ADDRESS}/launch"
    platform = settings.platform(PLATFORM["issuer"], "tool-2")
    assert platform.sends_grades
    assert settings.platform(PLATFORM["issuer"], "") is None, "two of them"
    assert settings.platform("https://elsewhere.example.org", "") is None


def test_grades_go_only_to_the_platforms_own_servers(tmp_path):
    further = ["https://grades.example.org"]
    write(tmp_path, platforms=[{**PLATFORM, "lineItemOrigins": further}])
    (platform,) = read_lti_settings(tmp_path).platforms
    assert platform.takes_grades_at("https://courses.example.org/1/lineitem?type=1")
    assert platform.takes_grades_at("https://grades.example.org:443/2")
    for address in (
        "https://courses.example.org.example.net/1",
        "https://courses.example.org:8443/1",
        "http://courses.example.org/1",
        "https://lab:secret@courses.example.org/1",
        "https://:secret@courses.example.org/1",
        "https://courses.example.org:x/1",
        None,
    ):
        assert not platform.takes_grades_at(address), address


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"address": "http://rastrainer.example.org"}, "address must be an address such as"),
        ({"address": f"{ADDRESS}?x=1"}, "without a query"),
        ({"platforms": {}}, "a list of up to 20"),
        ({"platforms": [PLATFORM] * 21}, "a list of up to 20"),
        ({"platforms": [PLATFORM, PLATFORM]}, "the same issuer and clientId"),
        ({"platforms": ["x"]}, "platform 1 must be a JSON object"),
        ({"platforms": [{}]}, 'needs the key "name"'),
        ({"plattforms": []}, "there is no plattforms"),
        ({"platforms": [{**PLATFORM, "sendGrade": False}]}, "there is no sendGrade"),
        ({"platforms": [{**PLATFORM, "tokenUrl": "http://a.example.org/"}]}, "tokenUrl must be"),
        ({"platforms": [{**PLATFORM, "keySetUrl": "file:///etc/passwd"}]}, "keySetUrl must be"),
        ({"platforms": [{**PLATFORM, "deploymentIds": []}]}, "deploymentIds must be a list of 1"),
        ({"platforms": [{**PLATFORM, "lineItemOrigins": ["x"]}]}, "each of lineItemOrigins"),
        ({"platforms": [{**PLATFORM, "sendGrades": 1}]}, "sendGrades must be true or false"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_unusable_settings_are_named(tmp_path, values, words):
    write(tmp_path, **values)
    with pytest.raises(InputError, match=words):
        read_lti_settings(tmp_path)


def test_the_private_key_is_created_once_and_readable_by_its_owner_only(tmp_path):
    key = ToolKey(tmp_path)
    path = tmp_path / KEY_FILE
    assert ToolKey(tmp_path).key_set() == key.key_set()
    (public,) = key.key_set()["keys"]
    assert set(public) == {"kty", "key_ops", "n", "e", "kid", "alg", "use"}
    if os.name == "posix":
        assert stat.S_IMODE(path.stat().st_mode) == 0o600
        path.chmod(0o644)
        with pytest.raises(InputError, match="Others can read"):
            ToolKey(tmp_path)
    path.chmod(0o600)
    path.write_text('{"privateKey": "none"}')
    with pytest.raises(InputError, match="contains no private key"):
        ToolKey(tmp_path)


def test_two_simultaneous_first_starts_use_the_same_stored_key(tmp_path, monkeypatch):
    generate, others = rsa.generate_private_key, []

    def generate_while_another_starts(**terms):
        monkeypatch.undo()
        others.append(ToolKey(tmp_path))
        return generate(**terms)

    monkeypatch.setattr(rsa, "generate_private_key", generate_while_another_starts)
    key = ToolKey(tmp_path)
    assert key.key_set() == others[0].key_set() == ToolKey(tmp_path).key_set()
    assert [path.name for path in tmp_path.iterdir()] == [KEY_FILE]


def test_the_command_shows_what_the_administrator_enters(tmp_path, capsys):
    words = ["lti", "--config", str(tmp_path)]
    assert main([*words, "--show"]) == 2
    assert "There is no" in capsys.readouterr().err
    write(tmp_path, platforms=[PLATFORM])
    assert main([*words, "--show"]) == 0
    said = capsys.readouterr().out
    for shown in (f"{ADDRESS}/login", f"{ADDRESS}/launch", f"{ADDRESS}/jwks", "BEGIN PUBLIC KEY"):
        assert shown in said
    assert "PRIVATE" not in said
    assert main(words) == 2
    assert main([*words, str(tmp_path / "none.db"), "--port", "0"]) == 2
    assert "There is no study" in capsys.readouterr().err
    assert main([*words, "none.db", "--lan", "--certificate", str(tmp_path / "none.pem")]) == 2
    assert "is no certificate" in capsys.readouterr().err


def test_without_the_optional_package_the_command_says_what_to_install(
    tmp_path, capsys, monkeypatch
):
    monkeypatch.setitem(sys.modules, "jwt", None)
    assert main(["lti", "--config", str(tmp_path), "--show"]) == 2
    assert "pip install 'rastrainer[lti]'" in capsys.readouterr().err
