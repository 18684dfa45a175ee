"""Whoever guesses passwords is slowed down; nobody is kept out of their own account by it."""

import uuid
from typing import Any

import pytest
from django.core.cache import cache
from django.core.cache.backends.redis import RedisCache
from django.http import HttpRequest
from django.test import Client

from workspace.models import SignInEntry, SignInOutcome, User
from workspace.sessions import sign_in_attempts
from workspace.sessions.sign_in_attempts import (
    COOKIE,
    TRIES,
    TRIES_BEFORE_A_NAME_IS_SLOW,
    TRIES_OF_A_NETWORK,
    TooManyAttempts,
    network_of,
    try_to_sign_in,
)

pytestmark = pytest.mark.django_db
PASSWORD = "inspect-the-lines"


@pytest.fixture(autouse=True)
def _no_tries_yet(settings: Any) -> None:
    cache.clear()
    settings.PASSWORD_HASHERS = ["django.contrib.auth.hashers.MD5PasswordHasher"]  # nothing here is about how slow a hash is


@pytest.fixture
def owner() -> User:
    return User.objects.create_user(f"owner-{uuid.uuid4().hex[:8]}", email="owner@example.org", password=PASSWORD)


def sign_in(client: Client, name: str, password: str, address: str = "203.0.113.1") -> bool:
    answer = client.post("/sign-in", {"login": name, "password": password}, REMOTE_ADDR=address)
    return bool(answer.status_code == 302)


def many_places(count: int) -> list[str]:
    return [f"198.51.100.{place}" for place in range(count)]


def hammer(name: str) -> None:
    """From so many places that each alone stays below its limit."""
    for address in many_places(TRIES_BEFORE_A_NAME_IS_SLOW + 5):
        sign_in(Client(), name, "wrong", address)


def test_guessing_is_limited_while_redis_is_away(owner: User, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sign_in_attempts, "cache", RedisCache("redis://127.0.0.1:1", {}))
    sign_in_attempts._of_process.clear()
    for _ in range(TRIES):
        assert not sign_in(Client(), owner.username, "wrong")
    assert not sign_in(Client(), owner.username, PASSWORD), "held back, though the password is right"
    assert sign_in(Client(), owner.username, PASSWORD, "203.0.113.77"), "whoever guesses elsewhere keeps nobody out"


def test_a_known_browser_signs_in_while_strangers_hammer_the_name_from_everywhere(client: Client, owner: User) -> None:
    assert sign_in(client, owner.username, PASSWORD)
    client.post("/sign-out")
    hammer(owner.username)
    assert not sign_in(Client(), owner.username, PASSWORD), "a stranger's browser has to wait"
    assert sign_in(client, owner.username, PASSWORD)


def test_a_known_browser_signs_in_while_somebody_at_the_same_address_hammers_the_name(client: Client, owner: User) -> None:
    assert sign_in(client, owner.username, PASSWORD)
    client.post("/sign-out")
    for _ in range(TRIES + 3):
        sign_in(Client(), owner.username, "wrong")
    assert not sign_in(Client(), owner.username, PASSWORD)
    assert sign_in(client, owner.username, PASSWORD)


def test_a_known_browser_has_no_more_tries_than_others(client: Client, owner: User) -> None:
    assert sign_in(client, owner.username, PASSWORD)
    client.post("/sign-out")
    for _ in range(TRIES):
        assert not sign_in(client, owner.username, "wrong")
    assert not sign_in(client, owner.username, PASSWORD)


def test_a_browser_is_known_for_the_names_that_signed_in_there_alone(client: Client, owner: User) -> None:
    assert sign_in(client, owner.username, PASSWORD)
    client.post("/sign-out")
    other = User.objects.create_user(f"other-{owner.username}", password=PASSWORD)
    hammer(other.username)
    assert not sign_in(client, other.username, PASSWORD)


def test_a_cookie_that_was_not_signed_here_makes_no_browser_known(client: Client, owner: User) -> None:
    assert sign_in(client, owner.username, PASSWORD)
    cookie = client.cookies[COOKIE]
    assert cookie["httponly"] and cookie["samesite"] == "Lax"
    forger = Client()
    forger.cookies[COOKIE] = cookie.value[:-2] + "xx"
    hammer(owner.username)
    assert not sign_in(forger, owner.username, PASSWORD)


def test_a_slow_name_lets_strangers_try_again_after_a_moment(owner: User, monkeypatch: pytest.MonkeyPatch) -> None:
    hammer(owner.username)
    page = Client().post("/sign-in", {"login": owner.username, "password": PASSWORD}, REMOTE_ADDR="203.0.113.9").content.decode()
    assert "Use a browser in which you have signed in before" in page
    monkeypatch.setattr(sign_in_attempts.cache, "add", lambda *_: True)  # the moment has passed
    assert sign_in(Client(), owner.username, PASSWORD, "203.0.113.10")


def test_waiting_for_a_turn_is_no_wrong_try(owner: User, monkeypatch: pytest.MonkeyPatch) -> None:
    hammer(owner.username)
    for _ in range(TRIES * 2):
        assert not sign_in(Client(), owner.username, PASSWORD, "203.0.113.9")
    monkeypatch.setattr(sign_in_attempts.cache, "add", lambda *_: True)
    assert sign_in(Client(), owner.username, PASSWORD, "203.0.113.9")


def test_names_that_nobody_has_are_slowed_down_alike() -> None:
    hammer("nobody")
    page = Client().post("/sign-in", {"login": "nobody", "password": "x"}, REMOTE_ADDR="203.0.113.9").content.decode()
    assert "Use a browser in which you have signed in before" in page


def test_one_network_tries_so_many_names_and_no_more() -> None:
    for number in range(TRIES_OF_A_NETWORK):
        try_to_sign_in(name=f"name-{number}", address="203.0.113.1", trusted_device=None)
    with pytest.raises(TooManyAttempts):
        try_to_sign_in(name="one-more", address="203.0.113.1", trusted_device=None)
    assert try_to_sign_in(name="one-more", address="203.0.113.2", trusted_device=None).left == TRIES - 1


def test_signing_in_right_many_times_from_one_network_is_no_guessing() -> None:
    for number in range(TRIES_OF_A_NETWORK * 2):
        try_to_sign_in(name=f"name-{number % 10}", address="203.0.113.1", trusted_device=None).succeeded()


@pytest.mark.parametrize(
    ("address", "network"),
    [
        ("203.0.113.7", "203.0.113.7"),
        ("2001:db8:1:2:aaaa::1", "2001:db8:1:2::"),
        ("2001:db8:1:2:ffff::9", "2001:db8:1:2::"),
        ("::ffff:203.0.113.7", "203.0.113.7"),
        ("", ""),
    ],
)
def test_a_subscriber_is_counted_as_one(address: str, network: str) -> None:
    assert network_of(address) == network


def test_tries_at_the_same_moment_are_all_counted_before_any_is_looked_at(
    client: Client, owner: User, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The password is looked at after the count: of ten tries that begin together five are looked at."""
    looked_at = []

    def check(self: Any, request: HttpRequest, **credentials: Any) -> None:
        looked_at.append(credentials)

    monkeypatch.setattr("workspace.api.authentication.RoleBackend.authenticate", check)
    for _ in range(10):
        sign_in(Client(), owner.username, "wrong")
    assert len(looked_at) == TRIES


def test_an_empty_form_costs_no_try(client: Client, owner: User) -> None:
    for _ in range(TRIES + 1):
        sign_in(client, owner.username, "")
    assert sign_in(client, owner.username, PASSWORD)


# --- the log -----------------------------------------------------------------------------------------------------------------------


def log() -> list[tuple[str, str | None]]:
    return [(entry.outcome, entry.user and entry.user.username) for entry in SignInEntry.objects.order_by("pk").select_related("user")]


def test_the_log_has_each_way_in_and_out(client: Client, owner: User) -> None:
    sign_in(client, owner.username, "wrong")
    sign_in(client, owner.username, PASSWORD)
    client.post("/sign-out")
    outcomes = [SignInOutcome.WRONG, SignInOutcome.SIGNED_IN, SignInOutcome.SIGNED_OUT]
    assert log() == [(outcome, owner.username) for outcome in outcomes]


def test_the_log_keeps_nothing_that_was_typed(client: Client, owner: User) -> None:
    sign_in(client, "my-secret-password", "another-secret")
    sign_in(client, owner.username, "a-third-secret")
    kept = str(list(SignInEntry.objects.values()))
    assert "secret" not in kept
    assert log() == [(SignInOutcome.WRONG, None), (SignInOutcome.WRONG, owner.username)]


def test_a_flood_of_tries_is_no_flood_of_rows(owner: User) -> None:
    for _ in range(TRIES + 20):
        sign_in(Client(), owner.username, "wrong")
    assert [outcome for outcome, _ in log()] == [SignInOutcome.WRONG] * TRIES + [SignInOutcome.HELD_BACK]


def test_the_log_takes_any_browser_name(client: Client, owner: User) -> None:
    client.post(
        "/sign-in", {"login": owner.username, "password": PASSWORD}, HTTP_USER_AGENT="a\x07b" + "x" * 500, REMOTE_ADDR="2001:db8::1"
    )
    entry = SignInEntry.objects.get()
    assert entry.user_agent == ("ab" + "x" * 500)[:200]
    assert entry.address == "2001:db8::1"


def test_names_are_typed_in_any_unicode_form() -> None:
    User.objects.create_user("Jörg", password=PASSWORD)
    assert Client().post("/sign-in", {"login": "Jo\N{COMBINING DIAERESIS}rg", "password": PASSWORD}).status_code == 302


def test_the_answer_is_a_page_and_never_repeats_the_password() -> None:
    headers = {"Accept": "application/json"}
    page = Client().post("/sign-in", {"login": "nobody", "password": "told-to-nobody"}, headers=headers)
    assert page.headers["Content-Type"].startswith("text/html")
    assert "told-to-nobody" not in page.content.decode()
