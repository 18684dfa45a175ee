"""Passkeys: made after a reauthentication, they sign in without a password, stand for a second factor, and belong to one user and host."""

from base64 import b32decode
from datetime import timedelta
from hashlib import sha256
from typing import Any

import pytest
from django.core.cache import cache
from django.test import Client
from django.utils import timezone
from fido2.cose import UnsupportedKey
from fido2.utils import websafe_decode, websafe_encode
from fido2.webauthn import AttestationObject, AttestedCredentialData, AuthenticatorData
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from accounts.pages import sign_in
from accounts.passkeys import MAX_PASSKEYS, MAX_RESPONSE_LENGTH
from accounts.second_factors import has_authenticator_app, passkeys_of
from tests.accounts.authenticator_app import code_now, is_in, shown_seed, type_password, with_app
from tests.accounts.software_authenticator import SoftwareAuthenticator, as_form
from tests.accounts.users import a_user, client_of
from workspace.models import AuditEntry, BrowserSession, Organisation, Role, SignInEntry, SignInOutcome, User
from workspace.sessions.sign_in_attempts import TRIES_OF_A_NETWORK

pytestmark = pytest.mark.django_db
PASSWORD = "inspect-the-lines"
HOST = {"SERVER_NAME": "localhost"}


@pytest.fixture(autouse=True)
def _no_tries_yet() -> None:
    cache.clear()


@pytest.fixture
def ida() -> User:
    user = a_user()
    user.set_password(PASSWORD)
    user.save()
    return user


def at_home(user: User) -> Client:
    """Somebody who has just signed in on the host that passkeys belong to."""
    client = client_of(user)
    client.defaults |= HOST
    return client


def stranger() -> Client:
    return Client(raise_request_exception=False, **HOST)


def post(client: Client, path: str, body: Any = None) -> Any:
    return client.post(f"/api/v1{path}", body, content_type="application/json")


def add(client: Client, key: SoftwareAuthenticator, name: str = "Laptop") -> int:
    options = post(client, "/account/passkeys/options").json()["options"]
    return int(post(client, "/account/passkeys", {"name": name, "passkey": key.create(options)}).status_code)


def with_passkey(user: User) -> SoftwareAuthenticator:
    key = SoftwareAuthenticator()
    assert add(at_home(user), key) == 201
    return key


def signs_in(client: Client, key: SoftwareAuthenticator, **more: str) -> str:
    options = client.get("/sign-in/passkey").json()
    return str(client.post("/sign-in/passkey", as_form(key.get(options)) | more).headers.get("Location", ""))


def history_of(user: User) -> list[str]:
    return list(AuditEntry.objects.filter(subject_type="user", subject_id=str(user.pk)).order_by("pk").values_list("action", flat=True))


def test_a_passkey_signs_in_alone_and_leads_where_one_wanted_to_go(ida: User) -> None:
    key = with_passkey(ida)
    client = stranger()
    assert signs_in(client, key, next="/live") == "/live"
    assert client.get("/api/v1/account").json()["username"] == ida.username
    assert client.get("/api/v1/account/sessions").json()["results"][0]["is_this_one"]
    assert SignInEntry.objects.get(outcome=SignInOutcome.SIGNED_IN).user == ida
    assert history_of(ida) == ["passkey added"]


def test_it_is_second_factor_enough_where_one_is_required_or_set_up(ida: User) -> None:
    key = with_passkey(ida)
    with_app(ida)
    Organisation.objects.update(requires_second_factor=True)
    client = stranger()
    assert signs_in(client, key) == "/"
    assert is_in(client)


def test_after_the_password_it_is_asked_for_and_accepted_in_place_of_a_code(ida: User) -> None:
    key = with_passkey(ida)
    client = stranger()
    assert type_password(client, ida, PASSWORD) == "/sign-in/code"
    assert not is_in(client)
    options = client.get("/sign-in/code").context["passkey_options"]
    assert client.post("/sign-in/code", as_form(SoftwareAuthenticator().get(options))).status_code == 200
    assert not is_in(client)
    options = client.get("/sign-in/code").context["passkey_options"]
    assert client.post("/sign-in/code", as_form(key.get(options))).headers["Location"] == "/"
    assert is_in(client)


def test_a_code_without_an_app_is_no_way_in(ida: User) -> None:
    with_passkey(ida)
    client = stranger()
    type_password(client, ida, PASSWORD)
    assert client.post("/sign-in/code", {"code": "123456"}).headers["Location"] == "/sign-in"
    assert not is_in(client)


def test_a_challenge_is_answered_once_and_in_its_own_session(ida: User) -> None:
    key = with_passkey(ida)
    first, second = stranger(), stranger()
    signed = as_form(key.get(first.get("/sign-in/passkey").json()))
    second.get("/sign-in/passkey")
    assert second.post("/sign-in/passkey", signed).status_code == 200
    assert not is_in(second)
    assert first.post("/sign-in/passkey", signed).status_code == 302
    first.post("/sign-out")
    assert first.post("/sign-in/passkey", signed).status_code == 200
    assert not is_in(first)
    assert SignInEntry.objects.filter(outcome=SignInOutcome.WRONG).count() == 2


def changed(ida: User, key: SoftwareAuthenticator, wrong: str) -> None:
    if wrong == "another key":
        key.key = SoftwareAuthenticator().key
    elif wrong == "another site":
        key.origin = "http://localhost.example.org"
    elif wrong == "a site under this one":
        key.origin = "http://thief.localhost"
    elif wrong == "another port":
        key.origin = "http://localhost:8001"
    elif wrong == "another host":
        key.host = "example.org"
    elif wrong == "no user verification":
        key.flags = 0x01
    elif wrong == "another user":
        key.user_handle = with_passkey(a_user()).user_handle
    elif wrong == "removed":
        passkeys_of(ida).delete()
    elif wrong == "user disabled":
        User.objects.filter(pk=ida.pk).update(is_active=False)


SITES = ["another site", "a site under this one", "another port", "another host"]
WRONG = [*SITES, "another key", "no user verification", "another user", "removed", "user disabled"]


@pytest.mark.parametrize("wrong", WRONG)
def test_what_is_wrong_lets_nobody_in(ida: User, wrong: str) -> None:
    key = with_passkey(ida)
    changed(ida, key, wrong)
    client = stranger()
    signs_in(client, key)
    assert not is_in(client)


def test_another_users_passkey_is_not_accepted_after_a_password(ida: User) -> None:
    with_passkey(ida)
    foreign = with_passkey(a_user())
    client = stranger()
    type_password(client, ida, PASSWORD)
    options = client.get("/sign-in/code").context["passkey_options"]
    client.post("/sign-in/code", as_form(foreign.get(options)))
    assert not is_in(client)


@pytest.mark.parametrize("wrong", [*SITES, "no user verification"])
def test_a_passkey_that_is_made_wrongly_is_not_kept(ida: User, wrong: str) -> None:
    key = SoftwareAuthenticator()
    changed(ida, key, wrong)
    assert add(at_home(ida), key) == 400
    assert not passkeys_of(ida).exists()


def test_a_key_of_an_algorithm_that_was_not_offered_is_no_second_factor(ida: User) -> None:
    key = SoftwareAuthenticator()
    key.public_key = UnsupportedKey(dict(key.public_key) | {3: -9_999})
    assert add(at_home(ida), key) == 400
    assert not passkeys_of(ida).exists()


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(max_size=20),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=10), inner, max_size=3),
    max_leaves=6,
)
PARTS = ("id", "rawId", "type", "response", "clientExtensionResults")
INNER = ("clientDataJSON", "authenticatorData", "signature", "userHandle", "attestationObject")


@pytest.mark.long
@settings(max_examples=25, suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)
@given(part=st.sampled_from([*PARTS, *INNER, ""]), value=JSON)
def test_damaged_responses_are_refused_and_nothing_fails(ida: User, part: str, value: Any) -> None:
    cache.clear()
    key, owner, client = SoftwareAuthenticator(), at_home(ida), stranger()
    made = _damaged(key.create(post(owner, "/account/passkeys/options").json()["options"]), part, value)
    assert post(owner, "/account/passkeys", {"name": "x", "passkey": made}).status_code in {201, 400}
    key.user_handle = "MQ"
    signed = _damaged(key.get(client.get("/sign-in/passkey").json()), part, value)
    assert client.post("/sign-in/passkey", as_form(signed)).status_code == 200
    assert post(owner, "/account/proof", {"passkey": signed}).status_code == 400
    assert not is_in(client)
    passkeys_of(ida).delete()


def _damaged(credential: Any, part: str, value: Any) -> Any:
    if not part:
        return value
    place = credential["response"] if part in INNER else credential
    return credential | {"response": place | {part: value}} if part in INNER else credential | {part: value}


def test_it_confirms_that_it_is_the_user_and_nobody_else(ida: User) -> None:
    key, foreign = with_passkey(ida), with_passkey(a_user())
    client = at_home(ida)
    assert is_in(client)
    BrowserSession.objects.filter(user=ida).update(began_at=timezone.now() - timedelta(minutes=16))
    assert post(client, "/account/passkeys/options").status_code == 403

    def proof(signer: SoftwareAuthenticator) -> int:
        methods = client.get("/api/v1/account/proof").json()
        assert methods["has_password"]
        return int(post(client, "/account/proof", {"passkey": signer.get(methods["passkey_options"])}).status_code)

    assert proof(foreign) == 400
    assert post(client, "/account/passkeys/options").status_code == 403
    assert proof(key) == 204
    assert post(client, "/account/passkeys/options").status_code == 200


def test_passkeys_are_listed_and_removed_by_their_owner_alone(ida: User) -> None:
    key = with_passkey(ida)
    passkey = passkeys_of(ida).get()
    other = at_home(a_user(Role.ADMINISTRATOR))
    assert other.delete(f"/api/v1/account/passkeys/{passkey.pk}").status_code == 404
    client = at_home(ida)
    row = client.get("/api/v1/account/passkeys").json()["results"][0]
    assert (row["id"], row["name"], row["last_used_at"]) == (passkey.pk, "Laptop", None)
    assert client.delete(f"/api/v1/account/passkeys/{passkey.pk}").status_code == 204
    assert history_of(ida) == ["passkey added", "passkey removed"]
    assert signs_in(stranger(), key) == ""


def test_one_user_has_so_many_passkeys_and_no_more(ida: User) -> None:
    client = at_home(ida)
    for _ in range(MAX_PASSKEYS):
        assert add(client, SoftwareAuthenticator()) == 201
    assert add(client, SoftwareAuthenticator()) == 409


def test_an_administrator_resets_passkeys_too(ida: User) -> None:
    with_passkey(ida)
    client = client_of(a_user(Role.ADMINISTRATOR))
    user = next(row for row in client.get("/api/v1/users").json()["results"] if row["id"] == ida.pk)
    assert user["has_second_factor"]
    assert client.delete(f"/api/v1/users/{ida.pk}/second-factor").status_code == 204
    assert not passkeys_of(ida).exists()


def test_challenges_of_one_network_are_limited(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sign_in, "PASSKEY_CHALLENGES", 5)
    answers = [stranger().get("/sign-in/passkey").status_code for _ in range(6)]
    assert answers == [200] * 5 + [429]


def test_a_password_alone_sets_up_no_app_once_there_is_a_passkey(ida: User) -> None:
    Organisation.objects.update(requires_second_factor=True)
    thief = stranger()
    assert type_password(thief, ida, PASSWORD) == "/second-factor"
    seed = b32decode(shown_seed(thief.get("/second-factor").content.decode()))
    with_passkey(ida)
    assert thief.post("/second-factor", {"code": code_now(seed)}).headers["Location"] == "/sign-in"
    assert not is_in(thief)
    assert not has_authenticator_app(ida)


@pytest.mark.parametrize("extension", [b"\x81" * 5_000, b"\x19", b"\x1b\x00", b"\xa1\x81\x00\x00"])
def test_damaged_extensions_are_refused_and_nothing_fails(ida: User, extension: bytes) -> None:
    key, client = with_passkey(ida), stranger()
    signed = key.get(client.get("/sign-in/passkey").json())
    data = websafe_decode(signed["response"]["authenticatorData"])
    signed["response"]["authenticatorData"] = websafe_encode(data[:32] + b"\x85" + data[33:] + extension)
    assert client.post("/sign-in/passkey", as_form(signed)).status_code == 200
    assert not is_in(client)


@pytest.mark.parametrize("opened", ["[", '{"a":'])
def test_endless_nesting_is_refused_and_nothing_fails(opened: str) -> None:
    assert stranger().post("/sign-in/passkey", {"credential": opened * 100_000}).status_code == 200


def test_an_attestation_without_a_key_is_refused(ida: User) -> None:
    key, owner = SoftwareAuthenticator(), at_home(ida)
    made = key.create(post(owner, "/account/passkeys/options").json()["options"])
    data = AuthenticatorData.create(sha256(b"localhost").digest(), key.flags, 0)
    made["response"]["attestationObject"] = websafe_encode(bytes(AttestationObject.create("none", data, {})))
    assert post(owner, "/account/passkeys", {"name": "x", "passkey": made}).status_code == 400


def test_a_key_of_an_unknown_algorithm_signs_nobody_in(ida: User) -> None:
    key, owner, client = SoftwareAuthenticator(), at_home(ida), stranger()
    made = key.create(post(owner, "/account/passkeys/options").json()["options"])
    credential = AttestedCredentialData.create(bytes(16), key.credential_id, UnsupportedKey({1: 2, 3: -999}))
    data = AuthenticatorData.create(sha256(b"localhost").digest(), key.flags | 0x40, 0, credential)
    made["response"]["attestationObject"] = websafe_encode(bytes(AttestationObject.create("none", data, {})))
    post(owner, "/account/passkeys", {"name": "x", "passkey": made})
    assert client.post("/sign-in/passkey", as_form(key.get(client.get("/sign-in/passkey").json()))).status_code == 200
    assert not is_in(client)


def test_refused_passkeys_write_few_rows_and_keep_nobody_out(ida: User) -> None:
    key = with_passkey(ida)
    for _ in range(TRIES_OF_A_NETWORK + 5):
        stranger().post("/sign-in/passkey", {"credential": "{}"})
    assert SignInEntry.objects.filter(outcome=SignInOutcome.WRONG).count() == TRIES_OF_A_NETWORK
    assert SignInEntry.objects.filter(outcome=SignInOutcome.HELD_BACK).count() == 1
    assert signs_in(stranger(), key) == "/"


def test_what_an_authenticator_adds_is_not_stored_at_any_length(ida: User) -> None:
    owner = at_home(ida)
    made = SoftwareAuthenticator().create(post(owner, "/account/passkeys/options").json()["options"])
    assert post(owner, "/account/passkeys", {"name": "x", "passkey": made | {"more": "x" * MAX_RESPONSE_LENGTH}}).status_code == 400
    assert not passkeys_of(ida).exists()


def test_removing_the_app_leaves_the_passkeys_as_the_page_says(ida: User) -> None:
    with_passkey(ida)
    with_app(ida)
    client = at_home(ida)
    Organisation.objects.update(requires_second_factor=True)
    assert "one of your passkeys is asked for after your password" in client.get("/second-factor/remove").content.decode()
    assert client.post("/second-factor/remove", {"code": code_now(), "password": PASSWORD}).status_code == 302
    assert type_password(stranger(), ida, PASSWORD) == "/sign-in/code"
