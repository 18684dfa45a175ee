"""How many websockets one user, and one network, may have open at one live program."""

import json
from collections.abc import Iterator
from typing import Any

import pytest
from websocket import WebSocket

from tests.workspace.front_door import Door, front_door, redis_at, running, wait_until
from tests.workspace.people import somebody
from workspace.models import User

pytestmark = pytest.mark.django_db(transaction=True)

OF_A_USER, OPERATORS = 5, 1  # 12 of an address
TOO_MANY = 4429


@pytest.fixture
def here(django_db_setup: None, monkeypatch: pytest.MonkeyPatch) -> Iterator[Door]:
    monkeypatch.setenv("SPANWISE_SOCKETS_PER_USER", str(OF_A_USER))
    monkeypatch.setenv("SPANWISE_OPERATORS_PER_ADDRESS", str(OPERATORS))
    with front_door() as door, door.serves_live(), running(redis_at(door.redis)):
        wait_until(door.redis.exists)
        wait_until(lambda: door.is_open)
        yield door


def opened(door: Door, user: User, number: int) -> list[WebSocket]:
    sockets = [door.open("/ws/live", user=user) for _ in range(number)]
    assert {first(live)["type"] for live in sockets} == {"snapshot"}
    return sockets


def is_closed_at_once(live: WebSocket) -> bool:
    opcode, data = live.recv_data()
    return opcode == 8 and int.from_bytes(data[:2], "big") == TOO_MANY


def first(live: WebSocket) -> dict[str, Any]:
    message: dict[str, Any] = json.loads(live.recv())
    return message


def test_one_too_many_of_a_user_is_closed_with_a_code_and_another_user_is_let_in(here: Door) -> None:
    user = somebody()
    sockets = opened(here, user, OF_A_USER)
    assert is_closed_at_once(here.open("/ws/live", user=user))
    opened(here, somebody(), 1)
    sockets[0].close()
    wait_until(lambda: here.open("/ws/live", user=user).recv_data()[0] != 8)  # the place of the closed one is free again


def test_one_too_many_of_an_address_is_closed_with_a_code(here: Door) -> None:
    people = [somebody() for _ in range(3)]
    sockets = [live for user in people[:2] for live in opened(here, user, OF_A_USER)]
    sockets += opened(here, people[2], 2)
    assert is_closed_at_once(here.open("/ws/live", user=people[2]))
    assert len(sockets) == 12
