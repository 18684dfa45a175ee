"""Visitors behind a proxy are told apart, over a unix socket and by TCP; who is no proxy names no address but its own."""

import uuid

import pytest
from django.test import Client

from tests.workspace.sessions.test_sign_in_limits import PASSWORD
from workspace.live.sockets import _address_of
from workspace.models import User
from workspace.sessions.preferences import visitor_address
from workspace.sessions.sign_in_attempts import TRIES

STRANGER, OWNER, PROXY = "203.0.113.1", "203.0.113.2", "10.3.0.9"


@pytest.mark.parametrize(
    ("peer", "forwarded", "visitor"),
    [
        ("", STRANGER, STRANGER),
        ("", f"{OWNER}, {STRANGER}", STRANGER),
        (PROXY, STRANGER, STRANGER),
        (PROXY, f"{OWNER}, {STRANGER}", STRANGER),
        (f"::ffff:{PROXY}", STRANGER, STRANGER),
        ("fd00::7", "2001:db8::1", "2001:db8::1"),
        (PROXY, "", PROXY),
        ("198.51.100.7", STRANGER, "198.51.100.7"),
        ("2001:db8::7", STRANGER, "2001:db8::7"),
    ],
)
def test_whose_address_counts(peer: str, forwarded: str, visitor: str) -> None:
    assert visitor_address(peer, forwarded) == visitor
    headers = [(b"x-forwarded-for", forwarded.encode())] if forwarded else []
    assert _address_of({"client": (peer, 1) if peer else None, "headers": headers}) == visitor


@pytest.mark.django_db
def test_a_stranger_behind_the_proxy_by_tcp_holds_back_nobody_else() -> None:
    owner = User.objects.create_user(f"owner-{uuid.uuid4().hex[:8]}", password=PASSWORD)

    def sign_in(password: str, address: str) -> bool:
        sent = {"login": owner.username, "password": password}
        return Client().post("/sign-in", sent, REMOTE_ADDR=PROXY, HTTP_X_FORWARDED_FOR=address).status_code == 302

    for _ in range(TRIES):
        assert not sign_in("wrong", STRANGER)
    assert not sign_in(PASSWORD, STRANGER), "held back"
    assert sign_in(PASSWORD, OWNER)
