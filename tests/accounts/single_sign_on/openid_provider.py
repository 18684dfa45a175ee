"""An OpenID provider on this machine that answers as a test says, also falsely; it checks what a provider must: secret, redirect, PKCE."""

import base64
import hashlib
import json
import re
import secrets
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from html import unescape
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from threading import Thread
from typing import Any
from urllib.parse import parse_qs, urlencode, urlsplit

import jwt
from cryptography.hazmat.primitives.asymmetric import rsa
from django.test import Client

from workspace.models import User

CLIENT_ID, CLIENT_SECRET = "spanwise", "a secret: with signs+"
Claims = dict[str, Any]


def new_key() -> rsa.RSAPrivateKey:
    return rsa.generate_private_key(public_exponent=65_537, key_size=2048)


@dataclass
class OpenIdProvider:
    """`claims` are of the user who signs in there; `sign` makes the ID token; `answers` replace those of paths: (status, content)."""

    port: int
    claims: Claims = field(default_factory=lambda: {"sub": "anna"})
    userinfo: Claims = field(default_factory=dict)
    key: rsa.RSAPrivateKey = field(default_factory=new_key)
    kid: str = field(default_factory=lambda: secrets.token_hex(4))
    methods: list[str] | None = field(default_factory=lambda: ["client_secret_post"])
    sign: Callable[[Claims], str] | None = None
    answers: dict[str, tuple[int, bytes]] = field(default_factory=dict)
    asked: list[str] = field(default_factory=list)
    codes: dict[str, Claims] = field(default_factory=dict)  # by code: what was asked for

    @property
    def issuer(self) -> str:
        return f"http://127.0.0.1:{self.port}"

    def changes_key(self) -> None:
        self.key, self.kid = new_key(), secrets.token_hex(4)

    def jwk(self) -> Claims:
        return json.loads(jwt.algorithms.RSAAlgorithm.to_jwk(self.key.public_key())) | {"kid": self.kid, "use": "sig"}

    def signed(self, claims: Claims, **options: Any) -> str:
        options = {"key": self.key, "algorithm": "RS256", "headers": {"kid": self.kid}} | options
        return jwt.encode(claims, **options)

    def authorises(self, address: str) -> str:
        """The path with which the browser comes back from an address of /authorize."""
        asked = {name: values[0] for name, values in parse_qs(urlsplit(address).query).items()}
        assert urlsplit(address).netloc == f"127.0.0.1:{self.port}"
        assert (asked["response_type"], asked["client_id"], asked["code_challenge_method"]) == ("code", CLIENT_ID, "S256")
        code = secrets.token_urlsafe(16)
        self.codes[code] = asked
        parts = urlsplit(asked["redirect_uri"])
        return f"{parts.path}?{urlencode({'code': code, 'state': asked['state'], 'iss': self.issuer})}"

    def discovery(self) -> Claims:
        found: Claims = {
            "issuer": self.issuer, "authorization_endpoint": f"{self.issuer}/authorize", "token_endpoint": f"{self.issuer}/token",
            "userinfo_endpoint": f"{self.issuer}/userinfo", "jwks_uri": f"{self.issuer}/keys",
        }  # fmt: skip
        return found | ({"token_endpoint_auth_methods_supported": self.methods} if self.methods else {})

    def token(self, form: dict[str, str], authorization: str) -> tuple[int, Claims]:
        """Answer the exchange of a code, once."""
        asked = self.codes.pop(form.get("code", ""), None)
        if authorization:
            pair = base64.b64decode(authorization.removeprefix("Basic ")).decode()
            is_client = pair == "spanwise:a+secret%3A+with+signs%2B"
        else:
            is_client = (form.get("client_id"), form.get("client_secret")) == (CLIENT_ID, CLIENT_SECRET)
        if not is_client:
            return 401, {"error": "invalid_client"}
        digest = hashlib.sha256(form.get("code_verifier", "").encode()).digest()
        challenge = base64.urlsafe_b64encode(digest).decode().rstrip("=")
        if asked is None or asked["redirect_uri"] != form.get("redirect_uri") or asked["code_challenge"] != challenge:
            return 400, {"error": "invalid_grant"}
        now = int(time.time())
        claims = {"iss": self.issuer, "aud": CLIENT_ID, "iat": now, "exp": now + 300, "nonce": asked["nonce"]} | self.claims
        if "max_age" in asked:
            claims = {"auth_time": now} | claims
        id_token = self.sign(claims) if self.sign else self.signed({name: value for name, value in claims.items() if value is not None})
        return 200, {"access_token": "an-access-token", "token_type": "Bearer", "id_token": id_token}


def settings_of_provider(port: int) -> dict[str, str]:
    """The environment of an installation that uses the provider at this port."""
    return {
        "SPANWISE_OIDC_ISSUER": f"http://127.0.0.1:{port}",
        "SPANWISE_OIDC_CLIENT_ID": CLIENT_ID,
        "SPANWISE_OIDC_CLIENT_SECRET": CLIENT_SECRET,
        "SPANWISE_OIDC_NAME": "Grid ID",
        "SPANWISE_OIDC_ROLE_CLAIM": "groups",
        "SPANWISE_OIDC_ROLES": "pilots=operator",
    }


@contextmanager
def openid_provider(port: int = 0) -> Iterator[OpenIdProvider]:
    """Run a provider; its /authorize signs in at once."""
    provider = OpenIdProvider(port=0)

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            self._answer({})

        def do_POST(self) -> None:
            sent = self.rfile.read(int(self.headers["Content-Length"])).decode()
            self._answer({name: values[0] for name, values in parse_qs(sent).items()})

        def _answer(self, form: dict[str, str]) -> None:
            path = urlsplit(self.path).path
            provider.asked.append(path)
            if path in provider.answers:
                self._send(*provider.answers[path])
            elif path == "/.well-known/openid-configuration":
                self._send(200, provider.discovery())
            elif path == "/keys":
                self._send(200, {"keys": [provider.jwk()]})
            elif path == "/token":
                self._send(*provider.token(form, self.headers.get("Authorization", "")))
            elif path == "/userinfo":
                assert self.headers["Authorization"] == "Bearer an-access-token"
                self._send(200, {"sub": provider.claims["sub"]} | provider.userinfo)
            else:
                asked = {name: values[0] for name, values in parse_qs(urlsplit(self.path).query).items()}
                site = urlsplit(asked["redirect_uri"])
                self.send_response(302)
                self.send_header("Location", f"{site.scheme}://{site.netloc}{provider.authorises(f'{provider.issuer}{self.path}')}")
                self.end_headers()

        def _send(self, status: int, content: Any) -> None:
            body = content if isinstance(content, bytes) else json.dumps(content).encode()
            self.send_response(status)
            self.send_header("Content-Type", "application/json")
            self.send_header("Content-Length", str(len(body)))
            if status in {301, 302, 307}:
                self.send_header("Location", body.decode())
            self.end_headers()
            self.wfile.write(body)

        def log_message(self, *_args: Any) -> None:
            pass

    server = ThreadingHTTPServer(("127.0.0.1", port), Handler)
    provider.port = server.server_address[1]
    thread = Thread(target=server.serve_forever, kwargs={"poll_interval": 0.02}, daemon=True)
    thread.start()
    try:
        yield provider
    finally:
        server.shutdown()
        server.server_close()
        thread.join()


def comes_back(client: Client, provider: OpenIdProvider, start: str = "/single-sign-on") -> Any:
    """Go to the provider, sign in there, and come back: the answer of Spanwise."""
    there = client.get(start)
    assert there.status_code == 302, unescape(there.content.decode())
    return client.get(provider.authorises(there.headers["Location"]))


def signs_in(provider: OpenIdProvider, **claims: Any) -> Client:
    provider.claims = {"sub": "anna", "groups": ["pilots"]} | claims
    client = Client()
    answer = comes_back(client, provider)
    assert answer.status_code == 302, heading(answer)
    return client


def heading(answer: Any) -> str:
    found = re.search(r"<h1>(.*?)</h1>", answer.content.decode())
    return unescape(found[1]) if found else ""


def user_of(client: Client) -> User:
    return User.objects.get(pk=client.get("/api/v1/account").json()["id"])
