"""UAVs as GeoJSON."""

from typing import Any

import pytest
from django.test import Client

from missions.models import Uav
from tests.accounts.users import a_user, client_of
from tests.missions.api import mission_body, patch, post
from workspace.models import AuditEntry, Organisation, Role

pytestmark = pytest.mark.django_db

FEATURE: dict[str, Any] = {
    "type": "Feature",
    "geometry": {"type": "Point", "coordinates": [10.0, 56.0]},
    "properties": {"name": "Tern", "base_name": "North", "max_range_m": 12_000.0, "end_action": "return"},
}


ANY = {"If-Match": "*"}


@pytest.fixture
def client() -> Client:
    return client_of(a_user(Role.OPERATOR))


def test_a_feature_comes_back_as_it_was_sent(client: Client) -> None:
    response = post(client, "uavs", FEATURE)
    assert response.status_code == 201
    feature = client.get(response["Location"]).json()
    assert feature == response.json()
    assert feature["geometry"] == FEATURE["geometry"]
    assert (
        feature["properties"].items() >= (FEATURE["properties"] | {"cruise_speed_mps": 12.0, "battery_percent": None, "sensor": ""}).items()
    )


def test_a_flat_object_is_taken_too(client: Client) -> None:
    assert post(client, "uavs", {"name": "Kite", "position": [10.0, 56.0]}).status_code == 201


def test_the_list_is_a_feature_collection_by_name(client: Client) -> None:
    for name in ("Tern", "Kite", "Avocet"):
        post(client, "uavs", {"name": name, "position": [10.0, 56.0]})
    page = client.get("/api/v1/uavs?limit=2").json()
    assert page["type"] == "FeatureCollection"
    assert [feature["properties"]["name"] for feature in page["features"]] == ["Avocet", "Kite"]
    assert [feature["properties"]["name"] for feature in client.get(page["next"]).json()["features"]] == ["Tern"]
    assert client.get("/api/v1/uavs?text=kit").json()["features"][0]["properties"]["name"] == "Kite"


def test_a_change_touches_only_what_it_names(client: Client) -> None:
    uav = post(client, "uavs", FEATURE).json()["id"]
    changed = patch(client, f"uavs/{uav}", {"battery_percent": 80}, **ANY).json()
    assert changed["properties"].items() >= (FEATURE["properties"] | {"battery_percent": 80.0, "sensor": ""}).items()
    assert AuditEntry.objects.get(action="change", subject_type="uav").before["battery_percent"] is None


def test_a_heading_is_kept_and_not_known_until_it_is_said(client: Client) -> None:
    uav = post(client, "uavs", FEATURE).json()
    assert uav["properties"]["heading_deg"] is None
    assert patch(client, f"uavs/{uav['id']}", {"heading_deg": 271.5}, **ANY).json()["properties"]["heading_deg"] == 271.5


@pytest.mark.parametrize(
    ("body", "place"),
    [
        ({"name": "Tern"}, "position"),
        ({"position": [10, 56]}, "name"),
        ({"name": "Tern", "position": [10, 96]}, "position"),
        ({"name": "Tern", "position": [10, 56], "max_range_m": -5}, "max_range_m"),
        ({"name": "Tern", "position": [10, 56], "battery_percent": 101}, "battery_percent"),
        ({"name": "Tern", "position": [10, 56], "heading_deg": 360}, "heading_deg"),
        ({"name": "Tern", "position": [10, 56], "cruise_speed_mps": 0}, "cruise_speed_mps"),
        ({"name": "", "position": [10, 56]}, "name"),
        (FEATURE | {"geometry": {"type": "Polygon", "coordinates": []}}, "position"),
    ],
)
def test_bad_values_are_refused_with_their_place(client: Client, body: dict[str, Any], place: str) -> None:
    response = post(client, "uavs", body)
    assert response.status_code == 400
    assert place in response.json()["error"]["details"]


def test_two_uavs_cannot_have_one_name(client: Client) -> None:
    post(client, "uavs", FEATURE)
    response = post(client, "uavs", FEATURE)
    assert (response.status_code, response.json()["error"]["code"]) == (409, "name_taken")
    other = client_of(a_user(organisation=Organisation.objects.create(name="Elsewhere")))
    assert post(other, "uavs", FEATURE).status_code == 201


def test_a_uav_that_a_mission_uses_cannot_be_removed(client: Client) -> None:
    uav = post(client, "uavs", FEATURE).json()["id"]
    post(client, "missions", mission_body() | {"uavs": [{"id": uav}]})
    assert client.delete(f"/api/v1/uavs/{uav}", headers=ANY).status_code == 409
    spare = post(client, "uavs", {"name": "Spare", "position": [10, 56]}).json()["id"]
    assert client.delete(f"/api/v1/uavs/{spare}", headers=ANY).status_code == 204
    assert list(Uav.objects.values_list("pk", flat=True)) == [uav]


def test_uavs_of_another_organisation_do_not_exist(client: Client) -> None:
    uav = post(client, "uavs", FEATURE).json()["id"]
    other = client_of(a_user(organisation=Organisation.objects.create(name="Elsewhere")))
    assert {
        other.get(f"/api/v1/uavs/{uav}").status_code,
        patch(other, f"uavs/{uav}", {"name": "Mine"}, **ANY).status_code,
        other.delete(f"/api/v1/uavs/{uav}").status_code,
    } == {404}
    assert other.get("/api/v1/uavs").json()["features"] == []


def test_viewers_read_and_strangers_are_asked_to_sign_in(client: Client) -> None:
    post(client, "uavs", FEATURE)
    viewer = client_of(a_user(Role.VIEWER))
    assert len(viewer.get("/api/v1/uavs").json()["features"]) == 1
    assert post(viewer, "uavs", FEATURE).status_code == 403
    assert Client().get("/api/v1/uavs").status_code == 401
