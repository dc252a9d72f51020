"""A learning platform for tests, over real sockets: keys, access tokens and a gradebook."""

from __future__ import annotations

import asyncio
import time
import uuid
from urllib.parse import parse_qsl, urlsplit

import jwt
from aiohttp import web
from cryptography.hazmat.primitives.asymmetric import rsa
from jwt.algorithms import RSAAlgorithm

from rastrainer_simulator.lti.launch_message import SCORE_SCOPE
from rastrainer_simulator.lti.lti_server import COOKIE
from Testing.simulator.net.igtl.servers import HOST, PATIENCE_S
from Testing.simulator.net.views.served import answered

CLAIM = "https://purl.imsglobal.org/spec/lti/claim/"
GRADES = "https://purl.imsglobal.org/spec/lti-ags/claim/endpoint"
LEARNER = "http://purl.imsglobal.org/vocab/lis/v2/membership#Learner"
CLIENT_ID, DEPLOYMENT, KEY_ID = "tool-1", "d-1", "key-1"
OTHER_KEY = rsa.generate_private_key(public_exponent=65_537, key_size=2048)
KEY = rsa.generate_private_key(public_exponent=65_537, key_size=2048)


def public_key(key: rsa.RSAPrivateKey, key_id: str = KEY_ID) -> dict:
    return {**RSAAlgorithm.to_jwk(key.public_key(), as_dict=True), "kid": key_id, "alg": "RS256"}


class PlatformDouble:
    """Serves what a platform does.

    Attributes:
        keys: what its key set answers; None for never.
        asked_for_keys: how often it was asked for them.
        scores: bodies of the scores that it was sent.
        planned: statuses with which the next scores are answered, instead of being processed.
        stored_first: whether a planned status comes after the score was stored.
        assertions: claims of the requests for access.
        address: of the platform.
        lasts: for how many s it says that access is given.
        audience: that the requests for access must be addressed to.
        tool: address of the tool, whose assertions it checks.
    """

    def __init__(self, thread):
        self.keys: object = {"keys": [public_key(KEY)]}
        self.asked_for_keys = 0
        self.scores: list[dict] = []
        self.planned: list[int] = []
        self.stored_first = False
        self.assertions: list[dict] = []
        self.tool = ""
        self.token = str(uuid.uuid4())
        self.lasts: object = 3600
        self._thread = thread
        self.address = f"http://{HOST}:{thread.run(self._listen())}"
        self.audience = f"{self.address}/token"

    async def _listen(self) -> int:
        app = web.Application()
        app.add_routes(
            [
                web.get("/auth", self._identify),
                web.get("/jwks", self._send_keys),
                web.post("/token", self._give_token),
                web.post("/lineitems/{number}/scores", self._take_score),
            ]
        )
        self._runner = web.AppRunner(app, shutdown_timeout=0.1)
        await self._runner.setup()
        site = web.TCPSite(self._runner, HOST, 0)
        await site.start()
        return self._runner.addresses[0][1]

    def close(self):
        self._thread.run(self._runner.cleanup())

    def settings(self, **changes) -> dict:
        """Return its entry in the tool's settings."""
        return {
            "name": "University",
            "issuer": self.address,
            "clientId": CLIENT_ID,
            "deploymentIds": [DEPLOYMENT],
            "authenticationUrl": f"{self.address}/auth?site=1",
            "tokenUrl": f"{self.address}/token",
            "keySetUrl": f"{self.address}/jwks",
            **changes,
        }

    def claims(self, nonce: str, launch_url: str, subject: str = "user-1", /, **changes) -> dict:
        """Return a launch's claims; a claim that is changed to None is left out."""
        now = int(time.time())
        claims = {
            "iss": self.address,
            "aud": CLIENT_ID,
            "sub": subject,
            "iat": now,
            "exp": now + 300,
            "nonce": nonce,
            "name": "Jo Doe",
            "email": "jo@example.org",
            f"{CLAIM}version": "1.3.0",
            f"{CLAIM}message_type": "LtiResourceLinkRequest",
            f"{CLAIM}deployment_id": DEPLOYMENT,
            f"{CLAIM}target_link_uri": launch_url,
            f"{CLAIM}resource_link": {"id": "link-1"},
            f"{CLAIM}roles": [LEARNER],
            f"{CLAIM}custom": {"task": "task-1", "mode": "desktop"},
            GRADES: {"scope": [SCORE_SCOPE], "lineitem": self.line_item(1)},
            **changes,
        }
        return {name: value for name, value in claims.items() if value is not None}

    def line_item(self, number: int) -> str:
        return f"{self.address}/lineitems/{number}?type=1"

    async def _identify(self, request):
        """Post a launch to the tool, as the page of a platform does."""
        asked = request.query
        claims = self.claims(asked["nonce"], asked["redirect_uri"], asked["login_hint"])
        token = jwt.encode(claims, KEY, "RS256", headers={"kid": KEY_ID})
        values = {"state": asked["state"], "id_token": token}
        inputs = "".join(f'<input name="{name}" value="{values[name]}">' for name in values)
        page = (
            f'<form action="{asked["redirect_uri"]}" method="post">{inputs}</form>'
            "<script>document.forms[0].submit()</script>"
        )
        return web.Response(text=page, content_type="text/html")

    async def _send_keys(self, _request):
        self.asked_for_keys += 1
        if self.keys is None:
            await asyncio.sleep(PATIENCE_S)
        if isinstance(self.keys, web.StreamResponse):
            return self.keys
        return web.json_response(self.keys)

    async def _give_token(self, request):
        form = await request.post()
        assert form["grant_type"] == "client_credentials"
        assert form["scope"] == SCORE_SCOPE
        _status, _headers, answer = await answered(self.tool, "/jwks")
        key_set = jwt.PyJWKSet.from_json(answer.decode())
        assertion = form["client_assertion"]
        key = key_set[jwt.get_unverified_header(assertion)["kid"]]
        claims = jwt.decode(assertion, key, ["RS256"], audience=self.audience)
        assert claims["iss"] == claims["sub"] == CLIENT_ID
        self.assertions.append(claims)
        return web.json_response({"access_token": self.token, "expires_in": self.lasts})

    async def _take_score(self, request):
        assert request.query == {"type": "1"}
        assert request.content_type == "application/vnd.ims.lis.v1.score+json"
        status = self.planned.pop(0) if self.planned else 200
        if request.headers["Authorization"] != f"Bearer {self.token}":
            return web.Response(status=401)
        if status == 200 or self.stored_first:
            self.scores.append({"item": request.match_info["number"], **await request.json()})
        return web.Response(status=status, headers={"Location": f"{self.address}/elsewhere"})


class Browser:
    """Follows a launch as a browser does, with a cookie of its own."""

    def __init__(self, thread, tool: str, platform: PlatformDouble, launch_url: str):
        self._thread, self._tool, self._platform = thread, tool, platform
        self.launch_url = launch_url
        self.cookie = ""

    def ask(self, path: str, method: str = "GET", data=None, **headers):
        """Return status, headers and text of an answer."""
        headers = {"Cookie": f"{COOKIE}={self.cookie}", **headers} if self.cookie else headers
        asking = answered(
            self._tool, path, method, data=data, headers=headers, allow_redirects=False
        )
        status, found, body = self._thread.run(asking)
        return status, found, body.decode()

    def begin(self, **changes):
        """Begin a login; return the answer."""
        values = {
            "iss": self._platform.address,
            "client_id": CLIENT_ID,
            "login_hint": "hint",
            "lti_message_hint": "message",
            "target_link_uri": self.launch_url,
            **changes,
        }
        values = {name: value for name, value in values.items() if value is not None}
        answer = self.ask("/login", "POST", values)
        cookie = answer[1].get("Set-Cookie", "")
        if cookie:
            self.cookie = cookie.partition(";")[0].partition("=")[2]
        return answer

    def login(self) -> dict[str, str]:
        """Return what the platform is asked."""
        status, headers, text = self.begin()
        assert status == 302, text
        return dict(parse_qsl(urlsplit(headers["Location"]).query))

    def post(self, state: str, token: str, **headers):
        """Post a token as the platform's page does; return status and text."""
        status, _headers, text = self.ask(
            "/launch", "POST", {"state": state, "id_token": token}, **headers
        )
        return status, text

    def launch(self, subject: str = "user-1", /, key=KEY, headers=None, language="", **changes):
        """Launch with a token whose claims are changed; return status and text."""
        asked = self.login()
        claims = self._platform.claims(asked["nonce"], self.launch_url, subject, **changes)
        token = jwt.encode(claims, key, "RS256", headers={"kid": KEY_ID, **(headers or {})})
        return self.post(asked["state"], token, **{"Accept-Language": language})
