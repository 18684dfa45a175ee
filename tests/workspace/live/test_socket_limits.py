"""How many websockets one user, and one network, may have open over all live programs."""

import asyncio
import json
import socket
from collections.abc import Iterator
from typing import Any

import pytest
from django.conf import settings
from redis import Redis
from websocket import WebSocket, create_connection

from tests.accounts.users import a_user, client_of
from tests.workspace.live.proxied_site import Endpoint, front_endpoint, redis_at, running, wait_until
from workspace.live import sockets
from workspace.live.sockets import SocketPlaces
from workspace.models import User

pytestmark = pytest.mark.django_db(transaction=True)

OF_A_USER, OPERATORS = 5, 1  # 12 of an address
TOO_MANY = 4429


@pytest.fixture
def here(django_db_setup: None, monkeypatch: pytest.MonkeyPatch) -> Iterator[Endpoint]:
    monkeypatch.setenv("SPANWISE_SOCKETS_PER_USER", str(OF_A_USER))
    monkeypatch.setenv("SPANWISE_OPERATORS_PER_ADDRESS", str(OPERATORS))
    with front_endpoint() as endpoint, endpoint.serves_live(), running(redis_at(endpoint.redis)):
        wait_until(endpoint.redis.exists)
        wait_until(lambda: endpoint.is_open)
        yield endpoint


def opened(endpoint: Endpoint, user: User, number: int) -> list[WebSocket]:
    sockets = [endpoint.open("/ws/live", user=user) for _ in range(number)]
    assert {first(live)["type"] for live in sockets} == {"snapshot"}
    return sockets


def connected(path: str) -> socket.socket | None:
    """None while nobody listens there."""
    beside = socket.socket(socket.AF_UNIX)
    try:
        beside.connect(path)
    except OSError:
        beside.close()
        return None
    return beside


def opened_beside(endpoint: Endpoint, path: str, user: User) -> WebSocket:
    """At the live program of this unix socket, past nginx."""
    beside = connected(path)
    assert beside is not None
    cookie = f"{settings.SESSION_COOKIE_NAME}={client_of(user).cookies[settings.SESSION_COOKIE_NAME].value}"
    site = f"127.0.0.1:{endpoint.port}"
    return create_connection(f"ws://{site}/ws/live", timeout=60, socket=beside, cookie=cookie, origin=f"http://{site}")


def is_closed_at_once(live: WebSocket) -> bool:
    frame = live.recv_frame()  # without an answer to it, for which the other side may not wait
    return frame.opcode == 8 and int.from_bytes(frame.data[:2], "big") == TOO_MANY


def first(live: WebSocket) -> dict[str, Any]:
    message: dict[str, Any] = json.loads(live.recv())
    return message


@pytest.mark.long
def test_one_too_many_of_a_user_is_closed_with_a_code_and_another_user_is_let_in(here: Endpoint) -> None:
    user = a_user()
    sockets = opened(here, user, OF_A_USER)
    assert is_closed_at_once(here.open("/ws/live", user=user))
    opened(here, a_user(), 1)
    sockets[0].close()
    wait_until(lambda: here.open("/ws/live", user=user).recv_data()[0] != 8)  # the place of the closed one is free again


def test_one_too_many_of_an_address_is_closed_with_a_code(here: Endpoint) -> None:
    people = [a_user() for _ in range(3)]
    sockets = [live for user in people[:2] for live in opened(here, user, OF_A_USER)]
    sockets += opened(here, people[2], 2)
    assert is_closed_at_once(here.open("/ws/live", user=people[2]))
    assert len(sockets) == 12


@pytest.mark.long
def test_those_of_all_live_programs_are_counted_together(here: Endpoint) -> None:
    path = here.folder / "live-2.sock"
    with running([part.replace("live.sock", path.name) for part in here.live], **here.environment):
        wait_until(lambda: (asked := connected(str(path))) is not None and asked.close() is None)
        user = a_user()
        sockets = opened(here, user, OF_A_USER - 2)
        sockets += [opened_beside(here, str(path), user) for _ in range(2)]
        assert first(sockets[-1])["type"] == "snapshot"
        assert is_closed_at_once(opened_beside(here, str(path), user))
        assert is_closed_at_once(here.open("/ws/live", user=user))
        sockets.pop().close()
        wait_until(lambda: here.open("/ws/live", user=user).recv_data()[0] != 8)


def test_those_of_a_killed_program_are_counted_until_their_lifetime_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sockets, "LIFETIME_S", 2)
    monkeypatch.setattr(sockets, "RENEW_INTERVAL_S", 0.2)
    limits = {f"user {a_user().pk}": 2}

    async def scenario() -> None:
        killed, beside = SocketPlaces(), SocketPlaces()
        assert await killed.take(limits)
        assert killed._renewing is not None
        assert await beside.take(limits)
        assert await beside.take(limits) is None
        await asyncio.sleep(3)  # both are renewed
        assert await beside.take(limits) is None
        killed._renewing.cancel()
        await asyncio.sleep(4)
        assert await beside.take(limits)

    asyncio.run(scenario())


def test_open_ones_are_counted_again_after_redis_has_lost_them(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sockets, "RENEW_INTERVAL_S", 0.2)
    place = f"user {a_user().pk}"

    async def scenario() -> None:
        here, beside = SocketPlaces(), SocketPlaces()
        assert await here.take({place: 1})
        Redis.from_url(settings.REDIS_URL).delete(f"spanwise-sockets.{place}")
        await asyncio.sleep(1)
        assert await beside.take({place: 1}) is None

    asyncio.run(scenario())


def test_a_process_counts_for_itself_while_redis_is_away(settings: Any) -> None:
    settings.REDIS_URL = "unix:///tmp/there-is-none.sock"

    async def scenario() -> None:
        places = SocketPlaces()
        member = await places.take({"user 1": 1})
        assert member is not None
        assert await places.take({"user 1": 1}) is None
        await places.release(member)
        assert await places.take({"user 1": 1})

    asyncio.run(scenario())
