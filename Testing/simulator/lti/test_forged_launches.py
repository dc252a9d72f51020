"""Forged, foreign, repeated and oversized launches: none makes a trainee."""

from __future__ import annotations

import base64
import json
import time

import jwt
import pytest
from aiohttp import web
from cryptography.hazmat.primitives import serialization
from cryptography.hazmat.primitives.asymmetric import rsa

from rastrainer_simulator.lti.launch_message import (
    LARGEST_TOKEN,
    MOST_LOGINS,
    VALID_S,
    OpenLogins,
    RefusedLaunchError,
)
from Testing.simulator.lti.conftest import ADDRESS
from Testing.simulator.lti.platform_double import (
    CLAIM,
    GRADES,
    KEY,
    KEY_ID,
    OTHER_KEY,
    public_key,
)

TEACHER = {f"{CLAIM}roles": ["http://purl.imsglobal.org/vocab/lis/v2/membership#Instructor"]}
"""Whose launch succeeds without a trainee."""


@pytest.fixture
def restarted(lab):
    """The lab with a tool that has asked for no keys yet."""
    keys = lab.platform.keys
    lab.start()
    yield lab
    lab.platform.keys = keys
    lab.start()


def unsigned(claims: dict, algorithm: str = "none") -> str:
    head = {"alg": algorithm, "kid": KEY_ID}
    parts = [base64.urlsafe_b64encode(json.dumps(each).encode()) for each in (head, claims)]
    return f"{b'.'.join(parts).replace(b'=', b'').decode()}."


def test_a_token_without_a_signature_is_refused(lab, browser, platform):
    asked = browser.login()
    for name in ("none", "None", "RS256"):
        asked = browser.login()
        token = unsigned(platform.claims(asked["nonce"], browser.launch_url), name)
        assert browser.post(asked["state"], token)[0] == 400
    assert lab.trainees() == []


def test_a_token_signed_with_the_public_key_as_a_password_is_refused(lab, browser, platform):
    public = KEY.public_key().public_bytes(
        serialization.Encoding.PEM, serialization.PublicFormat.SubjectPublicKeyInfo
    )
    asked = browser.login()
    claims = platform.claims(asked["nonce"], browser.launch_url)
    body = unsigned(claims, "HS256")[:-1]
    signature = jwt.algorithms.HMACAlgorithm(jwt.algorithms.HMACAlgorithm.SHA256)
    signed = base64.urlsafe_b64encode(signature.sign(body.encode(), public)).rstrip(b"=")
    assert browser.post(asked["state"], f"{body}.{signed.decode()}")[0] == 400
    assert lab.trainees() == []


def test_a_token_signed_by_another_key_is_refused(lab, browser):
    assert browser.launch(key=OTHER_KEY)[0] == 400
    assert lab.trainees() == []


@pytest.mark.parametrize("key_id", ["other", "", "../../jwks", "k" * 300])
def test_a_token_with_an_unknown_key_id_is_refused(lab, browser, key_id):
    assert browser.launch(headers={"kid": key_id})[0] == 400
    assert lab.trainees() == []


def test_made_up_key_ids_do_not_make_the_tool_query_the_platform_repeatedly(lab, browser):
    assert browser.launch(**TEACHER)[0] == 200
    asked = lab.platform.asked_for_keys
    key_sets = lab.tool.server._key_sets
    (just_now,) = key_sets._asked.values()
    key_sets._clock = lambda: just_now
    for number in range(5):
        assert browser.launch(headers={"kid": f"made-up-{number}"})[0] == 400
    assert lab.platform.asked_for_keys == asked
    assert browser.launch(**TEACHER)[0] == 200


def test_a_key_embedded_in_or_referenced_by_the_token_is_not_used(lab, browser, platform):
    place = f"{platform.address}/attacker"
    for headers in (
        {"jwk": public_key(OTHER_KEY)},
        {"jku": place, "x5u": place},
        {"jku": place, "jwk": public_key(OTHER_KEY), "kid": "attacker"},
    ):
        assert browser.launch(key=OTHER_KEY, headers=headers)[0] == 400
    assert lab.trainees() == []


NOW = int(time.time())


@pytest.mark.parametrize(
    "changes",
    [
        {"iss": "https://elsewhere.example.org"},
        {"iss": None},
        {"aud": "tool-2"},
        {"aud": ["tool-1", "tool-2"]},
        {"aud": None},
        {"azp": "tool-2"},
        {"nonce": "another"},
        {"nonce": None},
        {"exp": NOW - 3600},
        {"exp": None},
        {"exp": "soon"},
        {"iat": NOW - 7200},
        {"iat": NOW + 36_000},
        {"iat": None},
        {"nbf": NOW + 36_000},
        {"sub": None},
        {"sub": ""},
        {"sub": 7},
        {"sub": "u" * 300},
        {f"{CLAIM}deployment_id": "d-2"},
        {f"{CLAIM}deployment_id": None},
        {f"{CLAIM}deployment_id": ["d-1"]},
        {f"{CLAIM}version": "1.2.0"},
        {f"{CLAIM}message_type": "LtiDeepLinkingRequest"},
        {f"{CLAIM}target_link_uri": "https://elsewhere.example.org/launch"},
        {f"{CLAIM}target_link_uri": None},
        {f"{CLAIM}resource_link": {}},
        {f"{CLAIM}resource_link": "link-1"},
        {f"{CLAIM}custom": {"rule": "worst"}},
        {f"{CLAIM}custom": {"mode": ["desktop"]}},
    ],
    ids=lambda changes: "-".join(f"{key.rpartition('/')[2]}" for key in changes),
)
def test_a_token_for_somebody_else_or_of_another_kind_is_refused(lab, browser, changes):
    status, text = browser.launch(**changes)
    assert status == 400
    assert "This launch cannot be used" in text
    assert lab.trainees() == []


def test_a_launch_can_be_used_only_once(browser, platform):
    asked = browser.login()
    claims = platform.claims(asked["nonce"], browser.launch_url, **TEACHER)
    token = jwt.encode(claims, KEY, "RS256", {"kid": KEY_ID})
    assert browser.post(asked["state"], token)[0] == 200
    assert browser.post(asked["state"], token)[0] == 400
    # Nor in a new login, which has another nonce.
    assert browser.post(browser.login()["state"], token)[0] == 400
    assert browser.post("made-up", token)[0] == 400


def test_a_launch_begun_in_another_browser_is_refused(browser, lab, platform):
    victim = lab.new_browser()
    victim.login()
    asked = browser.login()
    token = jwt.encode(
        platform.claims(asked["nonce"], browser.launch_url), KEY, "RS256", {"kid": KEY_ID}
    )
    assert victim.post(asked["state"], token)[0] == 400
    without_cookie = lab.new_browser()
    assert without_cookie.post(browser.login()["state"], token)[0] == 400


@pytest.mark.parametrize(
    "changes",
    [
        {"iss": "https://elsewhere.example.org"},
        {"client_id": "tool-2"},
        {"target_link_uri": "https://elsewhere.example.org/launch"},
        {"target_link_uri": f"{ADDRESS}/launch/../elsewhere"},
        {"target_link_uri": None},
        {"login_hint": None},
        {"login_hint": "h" * 5000},
    ],
    ids=str,
)
def test_nobody_is_redirected_anywhere_but_to_a_registered_platform(browser, changes):
    status, headers, _text = browser.begin(**changes)
    assert status == 400
    assert "Location" not in headers


def test_overlong_deeply_nested_or_empty_tokens_are_refused(lab, browser):
    deep = base64.urlsafe_b64encode(b"[" * 9000).rstrip(b"=").decode()
    for token in ("", "a.b.c", "." * 50, "x" * (LARGEST_TOKEN + 1), f"{deep}.{deep}.x"):
        assert browser.post(browser.login()["state"], token)[0] == 400, token[:20]
    assert browser.launch(**TEACHER, padding="x" * LARGEST_TOKEN)[0] == 400, "though it is signed"
    assert browser.post(browser.login()["state"], "x" * 40_000)[0] in (400, 413)
    assert browser.ask("/launch", "POST", b"{}")[0] == 400
    form = {"Content-Type": "application/x-www-form-urlencoded; charset=unknown"}
    assert browser.ask("/launch", "POST", b"state=1", **form)[0] == 400
    assert browser.ask("/launch")[0] == 405
    assert browser.launch(**TEACHER)[0] == 200
    assert lab.trainees() == []


@pytest.mark.parametrize(
    "answer",
    [
        [],
        {"keys": "none"},
        {"keys": [public_key(KEY)] * 31},
        {"keys": [{"kty": "RSA", "kid": KEY_ID, "n": "AQAB", "e": "AQAB"}]},
        {"keys": [{"kty": "oct", "kid": KEY_ID, "k": "c2VjcmV0"}]},
        {"keys": [public_key(OTHER_KEY)]},
        {"keys": [3, {"kid": 7}]},
        {"keys": [public_key(KEY)], "padding": "x" * 200_000},
    ],
    ids=["list", "text", "many", "short", "symmetric", "another", "nothing", "huge"],
)
def test_unusable_or_huge_keys_let_nobody_in(restarted, answer):
    restarted.platform.keys = answer
    assert restarted.new_browser().launch()[0] in (400, 503)
    assert restarted.trainees() == []


def test_a_platform_key_that_is_too_short_lets_nobody_in(restarted):
    key = rsa.generate_private_key(public_exponent=65_537, key_size=1024)
    restarted.platform.keys = {"keys": [public_key(key)]}
    with pytest.warns(jwt.InsecureKeyLengthWarning):
        assert restarted.new_browser().launch(key=key)[0] == 400
    assert restarted.trainees() == []


def test_the_tool_does_not_wait_forever_for_keys(restarted):
    restarted.platform.keys = None
    restarted.start(timeout_s=0.2)
    assert restarted.new_browser().launch()[0] == 503
    assert restarted.trainees() == []


def test_repeatedly_begun_logins_do_not_exhaust_memory():
    logins = OpenLogins(lambda: 0.0)
    first, _nonce = logins.begin(None, "browser")
    for _number in range(MOST_LOGINS):
        last, _nonce = logins.begin(None, "browser")
    assert len(logins._logins) == MOST_LOGINS
    with pytest.raises(RefusedLaunchError):
        logins.end(first, "browser")
    assert logins.end(last, "browser").browser == "browser"


def test_a_login_expires_after_ten_minutes():
    now = [0.0]
    logins = OpenLogins(lambda: now[0])
    state, _nonce = logins.begin(None, "browser")
    now[0] = VALID_S + 1.0
    with pytest.raises(RefusedLaunchError, match="too long"):
        logins.end(state, "browser")


def test_a_redirect_to_keys_elsewhere_is_not_followed(restarted):
    platform = restarted.platform
    asked = platform.asked_for_keys
    platform.keys = web.Response(status=302, headers={"Location": f"{platform.address}/jwks"})
    assert restarted.new_browser().launch()[0] == 503
    assert platform.asked_for_keys == asked + 1


def test_a_gradebook_on_a_foreign_server_is_refused(lab, browser, platform):
    foreign = "http://127.0.0.1:9/lineitems/1"
    scope = platform.claims("", "")[GRADES]["scope"]
    for address in (foreign, "https://elsewhere.example.org/1", "file:///etc/passwd"):
        assert browser.launch(**{GRADES: {"scope": scope, "lineitem": address}})[0] == 400
    assert lab.trainees() == []
