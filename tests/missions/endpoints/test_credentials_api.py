"""What a UAV proves itself with: shown once, replaced with an overlap, revoked."""

import hashlib
from typing import Any

import pytest
from django.test import Client

from missions.models import UavCredential
from missions.services import mavlink_signing_key
from missions.services.fleet.credentials import note_link_token_use, note_mavlink_key_use
from tests.accounts.users import a_user, client_of
from tests.missions.api import post
from workspace.models import AuditEntry, Role

pytestmark = pytest.mark.django_db


@pytest.fixture
def client() -> Client:
    return client_of(a_user(Role.OPERATOR))


def made(client: Client, path: str, body: dict[str, Any]) -> Any:
    response = post(client, path, body)
    assert response.status_code == 201, response.content
    return response.json()


def uav_of(client: Client, name: str = "Tern") -> Any:
    return made(client, "uavs", {"name": name, "position": [10.0, 56.0]})


def test_a_token_is_shown_once_and_only_its_hash_is_kept(client: Client) -> None:
    uav = uav_of(client)["id"]
    answer = post(client, f"uavs/{uav}/credentials", {"kind": "link-token"})
    assert (answer.status_code, answer["Cache-Control"]) == (201, "no-store")
    secret = answer.json()["secret"]
    row = UavCredential.objects.get()
    assert row.token_sha256 == hashlib.sha256(secret.encode()).hexdigest()
    listed = client.get(f"/api/v1/uavs/{uav}/credentials").content.decode()
    history = str(list(AuditEntry.objects.values_list("before", "after")))
    assert secret not in listed + history
    assert row.token_sha256 not in listed + history
    assert client.get(f"/api/v1/uavs/{uav}").json()["properties"]["credentials"] == ["link-token"]


def test_a_key_has_32_bytes_and_can_be_made_again_from_what_is_kept(client: Client, settings: Any) -> None:
    uav = uav_of(client)["id"]
    secret = made(client, f"uavs/{uav}/credentials", {"kind": "mavlink-key"})["secret"]
    row = UavCredential.objects.get()
    assert bytes.fromhex(secret) == mavlink_signing_key(credential=row)
    assert len(mavlink_signing_key(credential=row)) == 32
    assert secret not in row.key_salt
    settings.SECRET_KEY = "another installation"
    assert mavlink_signing_key(credential=row).hex() != secret


@pytest.mark.parametrize("kind", ["mavlink-key", "link-token"])
def test_a_new_credential_counts_beside_the_one_before_until_it_was_used(client: Client, kind: str) -> None:
    uav = uav_of(client)["id"]
    first = made(client, f"uavs/{uav}/credentials", {"kind": kind})
    note_mavlink_key_use(credential_ids=[first["id"]])
    second = made(client, f"uavs/{uav}/credentials", {"kind": kind})
    assert first["secret"] != second["secret"]

    def in_force() -> list[int]:
        rows = client.get(f"/api/v1/uavs/{uav}/credentials").json()["results"]
        return [row["id"] for row in rows if row["revoked_at"] is None]

    assert in_force() == [second["id"], first["id"]]
    assert client.get(f"/api/v1/uavs/{uav}").json()["properties"]["credentials"] == [kind]
    note_mavlink_key_use(credential_ids=[first["id"]])
    assert in_force() == [second["id"], first["id"]]
    if kind == "mavlink-key":
        note_mavlink_key_use(credential_ids=[second["id"]])
    else:
        note_link_token_use(credential_id=second["id"], last_used_at=None)
    assert in_force() == [second["id"]]
    assert [entry.action for entry in AuditEntry.objects.filter(subject_type="uav_credential").order_by("pk")] == ["create", "rotate"]


def test_a_credential_that_nobody_used_counts_no_more_once_there_is_another(client: Client) -> None:
    uav = uav_of(client)["id"]
    first, second = (made(client, f"uavs/{uav}/credentials", {"kind": "mavlink-key"}) for _ in range(2))
    listed = client.get(f"/api/v1/uavs/{uav}/credentials").json()["results"]
    assert [(row["id"], row["revoked_at"] is None) for row in listed] == [(second["id"], True), (first["id"], False)]


def test_revoking_the_newest_credential_cuts_off_the_one_that_it_replaced(client: Client) -> None:
    uav = uav_of(client)["id"]
    first = made(client, f"uavs/{uav}/credentials", {"kind": "mavlink-key"})
    note_mavlink_key_use(credential_ids=[first["id"]])
    second = made(client, f"uavs/{uav}/credentials", {"kind": "mavlink-key"})
    assert client.delete(f"/api/v1/uavs/{uav}/credentials/{second['id']}").status_code == 204
    assert not UavCredential.objects.filter(revoked_at=None).exists()


def test_a_revoked_credential_stays_in_the_list_and_counts_no_more(client: Client) -> None:
    uav = uav_of(client)["id"]
    token = made(client, f"uavs/{uav}/credentials", {"kind": "link-token"})["id"]
    for _ in range(2):
        assert client.delete(f"/api/v1/uavs/{uav}/credentials/{token}").status_code == 204
    assert client.get(f"/api/v1/uavs/{uav}").json()["properties"]["credentials"] == []
    assert len(client.get(f"/api/v1/uavs/{uav}/credentials").json()["results"]) == 1
    assert AuditEntry.objects.filter(subject_type="uav_credential", action="revoke").count() == 1
    assert client.delete(f"/api/v1/uavs/{uav_of(client, 'Kite')['id']}/credentials/{token}").status_code == 404
