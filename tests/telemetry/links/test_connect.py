"""Where a UAV connects: addresses of the gateway as UAVs reach it, and secrets as text and QR code."""

import logging
from typing import Any

import pytest
from django.test import Client

from telemetry.selectors.vehicles import GatewayAddress, gateway_addresses
from tests.accounts.users import a_user, client_of
from tests.missions.api import post
from tests.missions.commands.outbox import a_uav
from workspace.models import Role

FINDER = ["1111111", "1000001", "1011101", "1011101", "1011101", "1000001", "1111111"]  # ISO/IEC 18004


@pytest.mark.parametrize(
    ("listens", "public", "reached"),
    [
        ("0.0.0.0:14550", "", ("grid.example", 14550, False)),
        ("0.0.0.0:14550", "uavs.example", ("uavs.example", 14550, False)),
        ("[::]:14551", "", ("grid.example", 14551, False)),
        ("192.0.2.7:14550", "", ("192.0.2.7", 14550, False)),
        ("192.0.2.7:14550", "uavs.example", ("uavs.example", 14550, False)),
        ("127.0.0.1:14550", "uavs.example", ("127.0.0.1", 14550, True)),
        ("localhost:14550", "", ("localhost", 14550, True)),
    ],
)
def test_uavs_reach_the_gateway_where_it_listens(settings: Any, listens: str, public: str, reached: tuple[str, int, bool]) -> None:
    settings.GATEWAY_UDP, settings.GATEWAY_TCP, settings.GATEWAY_PUBLIC_HOST = listens, "", public
    assert gateway_addresses("grid.example") == [GatewayAddress("udp", *reached)]


def test_several_addresses_are_all_told(settings: Any) -> None:
    settings.GATEWAY_UDP, settings.GATEWAY_TCP, settings.GATEWAY_PUBLIC_HOST = "0.0.0.0:14550, 0.0.0.0:14551", "0.0.0.0:5760", ""
    assert [(one.protocol, one.port) for one in gateway_addresses("a")] == [("udp", 14550), ("udp", 14551), ("tcp", 5760)]


@pytest.mark.django_db
def test_the_connection_tells_where_to_connect(settings: Any) -> None:
    settings.GATEWAY_UDP, settings.GATEWAY_TCP, settings.GATEWAY_PUBLIC_HOST = "0.0.0.0:14550", "", ""
    settings.PUBLIC_ADDRESS = "https://grid.example"
    viewer = a_user(Role.VIEWER)
    own = a_uav(organisation=viewer.organisation)
    answer = client_of(viewer).get(f"/api/v1/uavs/{own.pk}/connection").json()
    assert answer["server"] == "https://grid.example"
    assert answer["gateway"] == [{"protocol": "udp", "host": "grid.example", "port": 14550, "is_local": False}]
    assert answer["last_message_at"] is None


@pytest.mark.django_db
@pytest.mark.parametrize("kind", ["mavlink-key", "link-token"])
def test_a_secret_is_a_qr_code_once_and_in_no_log(kind: str, caplog: pytest.LogCaptureFixture) -> None:
    operator = a_user(Role.OPERATOR)
    client: Client = client_of(operator)
    own = a_uav(organisation=operator.organisation)
    with caplog.at_level(logging.DEBUG):
        made = post(client, f"uavs/{own.pk}/credentials", {"kind": kind}).json()
        listed = client.get(f"/api/v1/uavs/{own.pk}/credentials").content.decode()
    rows = made["secret_qr"]
    assert len({len(row) for row in rows} | {len(rows)}) == 1
    assert [row[:7] for row in rows[:7]] == [row[-7:] for row in rows[:7]] == [row[:7] for row in rows[-7:]] == FINDER
    assert "secret" not in listed
    assert made["secret"] not in caplog.text
    assert rows[0] not in caplog.text
