"""Single sign-on by OpenID Connect, with providers that run beside the test: what signs in, what is refused, and who one is then."""

import base64
import hashlib
import hmac
import json
import time
import urllib.request
from collections.abc import Callable
from typing import Any
from urllib.parse import parse_qs, urlencode, urlsplit

import jwt
import oidc_provider_mock
import pytest
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.hazmat.primitives.serialization import Encoding, PublicFormat
from django.test import Client

from accounts import identity_provider
from accounts.identity_claims import IdentityProvider
from accounts.identity_provider import documents
from tests.accounts.authenticator_app import is_in
from tests.accounts.single_sign_on.openid_provider import (
    CLIENT_ID,
    CLIENT_SECRET,
    OpenIdProvider,
    comes_back,
    heading,
    new_key,
    openid_provider,
    signs_in,
    user_of,
)
from tests.accounts.users import a_user, client_of
from workspace.models import BrowserSession, SignInEntry, SignInOutcome, User

pytestmark = pytest.mark.django_db
OTHER_KEY = new_key()


# The flow


def test_a_user_signs_in_at_a_provider_made_by_others(settings: Any) -> None:
    """oidc-provider-mock: code flow with PKCE, ID token of RS256, userinfo; requests as a browser sends them."""
    user = oidc_provider_mock.User(
        sub="anna", claims={"preferred_username": "anna.keller", "email": "anna@grid.example", "groups": ["pilots"]}
    )
    with oidc_provider_mock.run_server_in_thread(user_claims=[user], require_nonce=True) as server:
        settings.IDENTITY_PROVIDER = IdentityProvider(
            issuer=f"http://localhost:{server.server_port}", client_id="spanwise", client_secret="any", name="Mock",
            role_claim="groups", roles={"pilots": "operator"},
        )  # fmt: skip
        documents.clear()
        client = Client()
        address = client.get("/single-sign-on?next=/live").headers["Location"]
        answer = _without_redirects(address, urlencode({"sub": "anna"}).encode())
        back = urlsplit(answer)
        signed_in = client.get(f"{back.path}?{back.query}")
    assert (signed_in.status_code, signed_in.headers["Location"]) == (302, "/live")
    account = user_of(client)
    assert (account.username, account.email, account.role, account.organisation_id) == ("anna.keller", "anna@grid.example", "operator", 1)


def _without_redirects(address: str, form: bytes) -> str:
    class Stop(urllib.request.HTTPRedirectHandler):
        def redirect_request(self, *args: Any, **_facts: Any) -> None:
            raise StopIteration(args[5])

    try:
        urllib.request.build_opener(Stop).open(address, data=form, timeout=10)
    except StopIteration as stopped:
        return str(stopped.value)
    raise AssertionError("no redirect")


@pytest.mark.parametrize("methods", [["client_secret_post"], ["client_secret_basic"], None])
def test_the_client_is_authenticated_as_the_provider_can(provider: OpenIdProvider, methods: list[str] | None) -> None:
    provider.methods = methods
    assert is_in(signs_in(provider))


def test_state_nonce_and_challenge_are_new_each_time_and_no_part_of_the_query_is_passed_on(provider: OpenIdProvider) -> None:
    client, seen = Client(), []
    for _turn in range(2):
        address = client.get("/single-sign-on?scope=admin&auth_params=prompt%3Dnone&process=connect").headers["Location"]
        asked = {name: values[0] for name, values in parse_qs(urlsplit(address).query).items()}
        assert asked.keys() == {
            "response_type", "client_id", "redirect_uri", "scope", "state", "nonce", "code_challenge", "code_challenge_method",
        }  # fmt: skip
        assert (asked["scope"], asked["redirect_uri"]) == ("openid profile email", "http://testserver/single-sign-on/callback")
        seen.append(asked)
    for name in ("state", "nonce", "code_challenge"):
        assert len({asked[name] for asked in seen}) == 2
        assert min(len(asked[name]) for asked in seen) >= 43


@pytest.mark.parametrize(
    ("asked", "leads_to"),
    [
        ("/live", "/live"),
        ("/account#tokens", "/account#tokens"),
        ("https://evil.example/", "/"),
        ("//evil.example", "/"),
        ("javascript:x", "/"),
    ],
)
def test_one_is_led_on_this_host_only(provider: OpenIdProvider, asked: str, leads_to: str) -> None:
    answer = comes_back(Client(), provider, f"/single-sign-on?{urlencode({'next': asked})}")
    assert answer.headers["Location"] == leads_to


def test_a_sign_in_is_in_the_log_and_begins_a_new_session(provider: OpenIdProvider) -> None:
    client = Client()
    there = client.get("/single-sign-on").headers["Location"]
    before = client.cookies["sessionid"].value
    client.get(provider.authorises(there))
    assert client.cookies["sessionid"].value != before
    user = user_of(client)
    assert list(SignInEntry.objects.values_list("outcome", "user")) == [(SignInOutcome.SIGNED_IN, user.pk)]
    assert BrowserSession.objects.filter(user=user).count() == 1


# Answers that are not trusted


def _hs256_with_the_public_key(provider: OpenIdProvider, claims: dict[str, Any]) -> str:
    """The classic confusion: the public key, which everybody knows, as the shared one. PyJWT itself refuses to make such a token."""

    def part(content: bytes) -> str:
        return base64.urlsafe_b64encode(content).decode().rstrip("=")

    text = f"{part(json.dumps({'alg': 'HS256', 'kid': provider.kid}).encode())}.{part(json.dumps(claims).encode())}"
    shared = provider.key.public_key().public_bytes(Encoding.PEM, PublicFormat.SubjectPublicKeyInfo)
    return f"{text}.{part(hmac.new(shared, text.encode(), hashlib.sha256).digest())}"


FALSE_TOKENS: dict[str, Callable[[OpenIdProvider, dict[str, Any]], str]] = {
    "wrong nonce": lambda provider, claims: provider.signed(claims | {"nonce": "of another sign-in"}),
    "no nonce": lambda provider, claims: provider.signed({name: value for name, value in claims.items() if name != "nonce"}),
    "expired": lambda provider, claims: provider.signed(claims | {"iat": int(time.time()) - 900, "exp": int(time.time()) - 120}),
    "never expires": lambda provider, claims: provider.signed({name: value for name, value in claims.items() if name != "exp"}),
    "made in the future": lambda provider, claims: provider.signed(claims | {"iat": int(time.time()) + 600}),
    "wrong issuer": lambda provider, claims: provider.signed(claims | {"iss": "https://other.example"}),
    "wrong audience": lambda provider, claims: provider.signed(claims | {"aud": "another client"}),
    "several audiences, no party": lambda provider, claims: provider.signed(claims | {"aud": [CLIENT_ID, "another"]}),
    "another party": lambda provider, claims: provider.signed(claims | {"azp": "another"}),
    "no subject": lambda provider, claims: provider.signed({name: value for name, value in claims.items() if name != "sub"}),
    "empty subject": lambda provider, claims: provider.signed(claims | {"sub": ""}),
    "subject is no text": lambda provider, claims: provider.signed({**claims, "sub": None}),
    "another key": lambda provider, claims: provider.signed(claims, key=OTHER_KEY),
    "unknown key id": lambda provider, claims: provider.signed(claims, headers={"kid": "unknown"}),
    "alg none": lambda _provider, claims: jwt.encode(claims, key=None, algorithm="none"),
    "HS256 with the public key": _hs256_with_the_public_key,
    "HS256 with the client's secret": lambda provider, claims: jwt.encode(
        claims, key=CLIENT_SECRET, algorithm="HS256", headers={"kid": provider.kid}
    ),
    "changed claims": lambda provider, claims: _with_claims(provider.signed(claims), claims | {"groups": ["admins"]}),
    "cut signature": lambda provider, claims: provider.signed(claims)[:-20],
    "no token": lambda _provider, _claims: "",
    "noise": lambda _provider, _claims: "a.b.c",
}


def _with_claims(token: str, claims: dict[str, Any]) -> str:
    header, _claims, signature = token.split(".")
    return f"{header}.{base64.urlsafe_b64encode(json.dumps(claims).encode()).decode().rstrip('=')}.{signature}"


@pytest.mark.parametrize("fault", FALSE_TOKENS)
def test_a_false_id_token_signs_nobody_in(provider: OpenIdProvider, fault: str) -> None:
    provider.sign = lambda claims: FALSE_TOKENS[fault](provider, claims)
    client = Client()
    answer = comes_back(client, provider)
    assert (answer.status_code, heading(answer)) == (403, "The answer of Grid ID is not trusted")
    assert not is_in(client)
    assert not User.objects.exists()
    assert list(SignInEntry.objects.values_list("outcome", "user")) == [(SignInOutcome.REFUSED, None)]


@pytest.mark.parametrize("algorithm", ["RS256", "RS512", "PS256"])
def test_the_usual_signatures_are_taken(provider: OpenIdProvider, algorithm: str) -> None:
    provider.sign = lambda claims: provider.signed(claims, algorithm=algorithm)
    assert is_in(signs_in(provider))


def test_a_signature_of_an_elliptic_curve_is_taken(provider: OpenIdProvider) -> None:
    key = ec.generate_private_key(ec.SECP256R1())
    public = json.loads(jwt.algorithms.ECAlgorithm.to_jwk(key.public_key())) | {"kid": "curve"}
    provider.answers["/keys"] = (200, json.dumps({"keys": [provider.jwk(), public]}).encode())
    provider.sign = lambda claims: provider.signed(claims, key=key, algorithm="ES256", headers={"kid": "curve"})
    assert is_in(signs_in(provider))


def test_clocks_may_differ_by_a_minute(provider: OpenIdProvider) -> None:
    now = int(time.time())
    assert is_in(signs_in(provider, iat=now + 45, exp=now + 345))


def test_another_subject_in_userinfo_is_refused(provider: OpenIdProvider) -> None:
    provider.userinfo = {"sub": "berta"}
    answer = comes_back(Client(), provider)
    assert (answer.status_code, heading(answer)) == (403, "The answer of Grid ID is not trusted")


def test_a_changed_key_is_fetched_once_and_then_taken(provider: OpenIdProvider, monkeypatch: pytest.MonkeyPatch) -> None:
    assert is_in(signs_in(provider))
    provider.changes_key()
    answer = comes_back(Client(), provider)
    assert answer.status_code == 403, "the keys were fetched less than 5 s ago"
    monkeypatch.setattr(identity_provider, "REFETCH_INTERVAL_S", 0)
    assert is_in(signs_in(provider))
    assert provider.asked.count("/keys") == 2


def test_the_documents_are_fetched_once_in_ten_minutes(provider: OpenIdProvider) -> None:
    for _turn in range(3):
        signs_in(provider)
    assert (provider.asked.count("/keys"), provider.asked.count("/.well-known/openid-configuration")) == (1, 1)


@pytest.mark.parametrize(
    ("path", "answer", "status"),
    [
        ("/.well-known/openid-configuration", (500, b"{}"), 503),
        ("/.well-known/openid-configuration", (404, b"{}"), 503),
        ("/.well-known/openid-configuration", (200, b"<html>"), 403),
        ("/.well-known/openid-configuration", (200, b"[]"), 403),
        ("/.well-known/openid-configuration", (200, b'{"issuer": "https://other.example"}'), 403),
        ("/.well-known/openid-configuration", (200, b"x" * 600_000), 503),
    ],
)
def test_a_provider_that_cannot_be_asked_is_told_on_a_page(
    provider: OpenIdProvider, path: str, answer: tuple[int, bytes], status: int
) -> None:
    provider.answers[path] = answer
    page = Client().get("/single-sign-on")
    assert page.status_code == status
    assert "Grid ID" in heading(page)


@pytest.mark.parametrize(
    ("path", "answer", "status"),
    [
        ("/token", (500, b"{}"), 503),
        ("/token", (400, b'{"error": "invalid_grant"}'), 403),
        ("/token", (200, b"null"), 403),
        ("/token", (200, b"{}"), 403),
        ("/token", (302, b"http://127.0.0.1:9/elsewhere"), 403),
        ("/keys", (500, b"{}"), 503),
        ("/keys", (200, b'{"keys": []}'), 403),
        ("/keys", (200, b'{"keys": "none"}'), 403),
        ("/keys", (200, b'{"keys": [{"kty": "RSA", "n": "AQAB", "e": "AQAB"}]}'), 403),
        ("/userinfo", (401, b"{}"), 503),
        ("/userinfo", (200, b'{"name": "without a subject"}'), 403),
    ],
)
def test_a_provider_that_fails_later_is_told_on_a_page(provider: OpenIdProvider, path: str, answer: tuple[int, bytes], status: int) -> None:
    provider.answers[path] = answer
    client = Client()
    assert comes_back(client, provider).status_code == status
    assert not is_in(client)


def test_a_discovery_document_of_another_issuer_is_refused(provider: OpenIdProvider) -> None:
    known = provider.discovery() | {"issuer": f"{provider.issuer}/"}
    provider.answers["/.well-known/openid-configuration"] = (200, json.dumps(known).encode())
    assert Client().get("/single-sign-on").status_code == 403


def test_endpoints_without_tls_are_refused(provider: OpenIdProvider) -> None:
    known = provider.discovery() | {"token_endpoint": "http://grid.example/token"}
    provider.answers["/.well-known/openid-configuration"] = (200, json.dumps(known).encode())
    assert Client().get("/single-sign-on").status_code == 403


def test_a_provider_that_is_down_is_told_on_a_page(settings: Any) -> None:
    with openid_provider() as gone:
        issuer = gone.issuer
    settings.IDENTITY_PROVIDER = IdentityProvider(
        issuer=issuer, client_id=CLIENT_ID, client_secret=CLIENT_SECRET, name="Grid ID", default_role="viewer"
    )
    documents.clear()
    page = Client().get("/single-sign-on")
    assert (page.status_code, heading(page)) == (503, "Grid ID does not answer")


# State


def test_an_answer_works_once(provider: OpenIdProvider) -> None:
    client = Client()
    back = provider.authorises(client.get("/single-sign-on").headers["Location"])
    assert client.get(back).status_code == 302
    client.post("/sign-out")
    answer = client.get(back)
    assert (answer.status_code, heading(answer)) == (400, "This sign-in has expired")
    assert not is_in(client)


def test_an_answer_works_in_the_browser_alone_that_asked(provider: OpenIdProvider) -> None:
    """Login CSRF: an attacker's answer, opened by somebody else, would sign them in as the attacker."""
    back = provider.authorises(Client().get("/single-sign-on").headers["Location"])
    victim = Client()
    victim.get("/single-sign-on")
    assert victim.get(back).status_code == 400
    assert not is_in(victim)


def test_a_page_of_another_site_starts_no_sign_in(provider: OpenIdProvider) -> None:
    answer = Client().get("/single-sign-on?next=/live", headers={"Sec-Fetch-Site": "cross-site"})
    assert answer.headers["Location"] == "/sign-in?next=%2Flive"
    for site in ("none", "same-origin"):
        assert Client().get("/single-sign-on", headers={"Sec-Fetch-Site": site}).headers["Location"].startswith(provider.issuer)


def test_a_code_of_one_sign_in_does_not_work_in_another(provider: OpenIdProvider) -> None:
    """The code's challenge is bound to the verifier of the session that asked."""
    client = Client()
    first = client.get("/single-sign-on").headers["Location"]
    second = client.get("/single-sign-on").headers["Location"]
    code = parse_qs(urlsplit(provider.authorises(first)).query)["code"][0]
    state = parse_qs(urlsplit(second).query)["state"][0]
    assert client.get(f"/single-sign-on/callback?{urlencode({'code': code, 'state': state})}").status_code == 403
    assert not is_in(client)


@pytest.mark.parametrize("query", ["", "code=x", "state=x", "code=x&state=x", "error=access_denied", "state=" + "x" * 5_000])
def test_an_answer_that_nobody_asked_for_is_told(provider: OpenIdProvider, query: str) -> None:
    assert Client().get(f"/single-sign-on/callback?{query}").status_code == 400


def test_an_answer_expires_after_ten_minutes(provider: OpenIdProvider, monkeypatch: pytest.MonkeyPatch) -> None:
    client = Client()
    back = provider.authorises(client.get("/single-sign-on").headers["Location"])
    began_s = time.time()
    monkeypatch.setattr("allauth.socialaccount.internal.statekit.time.time", lambda: began_s + 601)
    assert client.get(back).status_code == 400


def test_an_answer_of_another_issuer_is_refused(provider: OpenIdProvider) -> None:
    """RFC 9207, against mix-up."""
    client = Client()
    back = provider.authorises(client.get("/single-sign-on").headers["Location"])
    assert client.get(back.replace(urlencode({"iss": provider.issuer}), "iss=https%3A%2F%2Fother.example")).status_code == 400


@pytest.mark.parametrize(
    ("error", "status", "title"),
    [
        ("access_denied", 403, "Grid ID did not sign you in"),
        ("<script>", 403, "Grid ID did not sign you in"),
        ("temporarily_unavailable", 503, "Grid ID does not answer"),
    ],
)
def test_errors_of_the_provider_are_told(provider: OpenIdProvider, error: str, status: int, title: str) -> None:
    client = Client()
    state = parse_qs(urlsplit(client.get("/single-sign-on").headers["Location"]).query)["state"][0]
    answer = client.get(f"/single-sign-on/callback?{urlencode({'error': error, 'state': state})}")
    assert (answer.status_code, heading(answer)) == (status, title)
    assert "<script>" not in answer.content.decode().split("<body")[1].split("<h1>")[1].split("</main>")[0]


def test_without_a_provider_there_is_no_such_page() -> None:
    for page in ("single-sign-on", "single-sign-on/callback"):
        assert Client().get(f"/{page}").status_code == 404
    assert client_of(a_user()).get("/single-sign-on/reauthentication").status_code == 404
