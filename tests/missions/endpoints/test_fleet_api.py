"""Types, bases and states of the fleet."""

from typing import Any

import pytest
from django.test import Client

from missions.models import Base, CommandKind, Mission, Uav, UavState, UavType
from missions.services.commands.commands import queue_command
from tests.accounts.users import a_user, client_of
from tests.missions.api import mission_body, patch, post
from workspace.models import AuditEntry, Organisation, Role

pytestmark = pytest.mark.django_db

ANY = {"If-Match": "*"}
KESTREL: dict[str, Any] = {"name": "Kestrel", "max_range_m": 60_000.0, "cruise_speed_mps": 14.0, "sensors": ["RGB camera", "Lidar"]}
DEPOT: dict[str, Any] = {"name": "Depot", "position": [10.0, 56.0]}


@pytest.fixture
def client() -> Client:
    return client_of(a_user(Role.OPERATOR))


def made(client: Client, path: str, body: dict[str, Any]) -> Any:
    response = post(client, path, body)
    assert response.status_code == 201, response.content
    return response.json()


def uav_of(client: Client, name: str = "Tern", **facts: Any) -> Any:
    return made(client, "uavs", {"name": name, "position": [10.0, 56.0]} | facts)


def names(client: Client, query: str) -> list[str]:
    return [feature["properties"]["name"] for feature in client.get(f"/api/v1/uavs?{query}").json()["features"]]


def test_a_type_and_a_base_come_back_as_they_were_sent(client: Client) -> None:
    for path, body in (("uav-types", KESTREL), ("bases", DEPOT)):
        response = post(client, path, body)
        assert response.status_code == 201
        stored = client.get(response["Location"])
        assert stored.json() == response.json()
        assert stored.json().items() >= (body | {"uav_count": 0, "revision": 1}).items()
        assert stored["ETag"] == '"1"'


def test_a_uav_has_range_speed_and_sensors_of_its_type_until_it_has_its_own(client: Client) -> None:
    kestrel = made(client, "uav-types", KESTREL)
    uav = uav_of(client, type=kestrel["id"], sensor="Gas sniffer")
    facts = uav["properties"]
    assert (facts["max_range_m"], facts["cruise_speed_mps"]) == (60_000.0, 14.0)
    assert facts["from_type"] == ["max_range_m", "cruise_speed_mps", "reserve_percent"]
    assert facts["sensors"] == ["Gas sniffer", "RGB camera", "Lidar"]
    facts = patch(client, f"uavs/{uav['id']}", {"max_range_m": 40_000}, **ANY).json()["properties"]
    assert (facts["max_range_m"], facts["from_type"]) == (40_000.0, ["cruise_speed_mps", "reserve_percent"])
    patch(client, f"uav-types/{kestrel['id']}", {"cruise_speed_mps": 20}, **ANY)
    assert client.get(f"/api/v1/uavs/{uav['id']}").json()["properties"]["cruise_speed_mps"] == 20.0


def test_a_uav_has_battery_mass_reserve_and_airspeed_of_its_type_until_it_has_its_own(client: Client) -> None:
    iris = made(client, "uav-types", KESTREL | {"name": "Iris", "battery_wh": 56.6, "mass_kg": 1.545, "max_airspeed_mps": 11})
    uav = uav_of(client, type=iris["id"], battery_wh=70, reserve_percent=30)
    facts = uav["properties"]
    assert (facts["battery_wh"], facts["reserve_percent"], facts["mass_kg"], facts["max_airspeed_mps"]) == (70.0, 30.0, 1.545, 11.0)
    assert facts["from_type"] == ["max_range_m", "cruise_speed_mps", "mass_kg", "max_airspeed_mps"]
    (flown,) = made(client, "missions", mission_body() | {"uavs": [{"id": uav["id"]}]})["uavs"]
    assert {name: flown[name] for name in ("battery_wh", "reserve_percent", "mass_kg")} == {
        "battery_wh": 70.0,
        "reserve_percent": 30.0,
        "mass_kg": 1.545,
    }
    facts = patch(client, f"uavs/{uav['id']}", {"battery_wh": None, "mass_kg": 2}, **ANY).json()["properties"]
    assert (facts["battery_wh"], facts["mass_kg"]) == (56.6, 2.0)


def test_a_uav_that_is_heavier_than_its_type_hovers_as_well_with_more_power(client: Client) -> None:
    """A hover was measured with 1.545 kg: of four times that, 8 times what lifts, and the same 8 W for the avionics."""
    iris = made(client, "uav-types", KESTREL | {"name": "Iris", "battery_wh": 56.6, "mass_kg": 1.545, "hover_power_w": 158.0})
    uav = uav_of(client, type=iris["id"], mass_kg=6.18)
    (flown,) = made(client, "missions", mission_body() | {"uavs": [{"id": uav["id"]}]})["uavs"]
    assert flown["hover_power_w"] == pytest.approx(8.0 + 8.0 * 150.0)


def test_a_hover_that_no_rotors_manage_is_told_with_its_bounds(client: Client) -> None:
    """15.15 N on 0.206 m2 in air of 1.225 kg/m3 take 83.04 W at best: with 8 W beside, 95.4 W at 95 % and 838.4 W at 10 %."""
    answer = post(client, "uav-types", KESTREL | {"hover_power_w": 50})
    assert answer.json()["error"]["details"] == {"hover_power_w": ["From 96 to 838 W for this mass and these rotors."]}


def test_a_uav_without_a_type_has_a_battery_of_its_own(client: Client) -> None:
    refused = post(client, "uavs", {"name": "Wren", "position": [10.0, 56.0], "battery_wh": 56.6})
    assert (refused.status_code, [*refused.json()["error"]["details"]]) == (400, ["mass_kg"])
    uav = uav_of(client, battery_wh=56.6, mass_kg=1.6)
    (flown,) = made(client, "missions", mission_body() | {"uavs": [{"id": uav["id"]}]})["uavs"]
    assert (flown["battery_wh"], flown["reserve_percent"]) == (56.6, 20.0)


@pytest.mark.parametrize(
    ("field", "value"), [("battery_wh", 0), ("mass_kg", -1), ("mass_kg", 5_000), ("reserve_percent", 93), ("max_airspeed_mps", 0.2)]
)
def test_figures_that_no_uav_has_are_told_at_their_field(client: Client, field: str, value: float) -> None:
    uav = uav_of(client)
    answer = patch(client, f"uavs/{uav['id']}", {field: value}, **ANY)
    assert answer.status_code == 400
    assert list(answer.json()["error"]["details"]) == [field]


def test_a_mission_flies_a_stored_uav_with_the_values_of_its_type(client: Client) -> None:
    uav = uav_of(client, type=made(client, "uav-types", KESTREL)["id"])
    mission = made(client, "missions", mission_body() | {"uavs": [{"id": uav["id"]}]})
    assert (mission["uavs"][0]["max_range_m"], mission["uavs"][0]["cruise_speed_mps"]) == (60_000.0, 14.0)


def test_a_new_uav_stands_at_its_base(client: Client) -> None:
    depot = made(client, "bases", DEPOT)
    uav = made(client, "uavs", {"name": "Kite", "base": depot["id"]})
    assert uav["geometry"]["coordinates"] == DEPOT["position"]
    assert uav["properties"]["base_name"] == "Depot"
    assert uav["properties"]["located_at"] is not None
    assert post(client, "uavs", {"name": "Tern"}).json()["error"]["details"] == {
        "position": ["A UAV needs a position, or a base to stand at."]
    }


def test_a_base_is_found_by_its_name_and_its_uavs_follow_a_new_one(client: Client) -> None:
    depot = made(client, "bases", DEPOT)
    uav = uav_of(client, base_name="Depot")
    assert uav["properties"]["base"] == depot["id"]
    patch(client, f"bases/{depot['id']}", {"name": "North yard"}, **ANY)
    assert client.get(f"/api/v1/uavs/{uav['id']}").json()["properties"]["base_name"] == "North yard"
    assert patch(client, f"uavs/{uav['id']}", {"base": None}, **ANY).json()["properties"]["base_name"] == ""


def test_a_place_has_the_time_at_which_it_was_set(client: Client) -> None:
    uav = uav_of(client)
    first = uav["properties"]["located_at"]
    assert patch(client, f"uavs/{uav['id']}", {"sensor": "Lidar"}, **ANY).json()["properties"]["located_at"] == first
    assert patch(client, f"uavs/{uav['id']}", {"position": [10.5, 56.0]}, **ANY).json()["properties"]["located_at"] > first


def test_the_list_is_filtered_and_counted(client: Client) -> None:
    kestrel, depot = made(client, "uav-types", KESTREL)["id"], made(client, "bases", DEPOT)["id"]
    uav_of(client, "Kestrel 1", type=kestrel, base=depot)
    uav_of(client, "Kestrel 2", type=kestrel, state="maintenance", serial_number="SN-7")
    uav_of(client, "Gull", sensor="Thermal camera", state="retired")
    assert names(client, "") == ["Kestrel 1", "Kestrel 2"]
    assert names(client, "state=all") == ["Gull", "Kestrel 1", "Kestrel 2"]
    assert names(client, "state=retired") == ["Gull"]
    assert names(client, f"base={depot}") == ["Kestrel 1"]
    assert names(client, f"type={kestrel}&state=maintenance") == ["Kestrel 2"]
    assert names(client, "sensor=lidar") == ["Kestrel 1", "Kestrel 2"]
    assert names(client, "state=all&sensor=thermal") == ["Gull"]
    assert names(client, "text=sn-7") == ["Kestrel 2"]
    assert client.get("/api/v1/uavs?state=retired").json()["numbers"] == {"active": 1, "maintenance": 1, "retired": 1}


def test_a_longer_list_asks_the_database_no_oftener(client: Client, django_assert_max_num_queries: Any) -> None:
    kestrel, depot = made(client, "uav-types", KESTREL)["id"], made(client, "bases", DEPOT)["id"]
    for number in range(12):
        made(client, f"uavs/{uav_of(client, f'Kestrel {number}', type=kestrel, base=depot)['id']}/credentials", {"kind": "link-token"})
    with django_assert_max_num_queries(8):
        features = client.get("/api/v1/uavs").json()["features"]
    assert [feature["properties"]["credentials"] for feature in features] == [["link-token"]] * 12


@pytest.mark.parametrize("query", ["state=lost", "base=x", "type=-1", "base=99999999999999999999"])
def test_a_filter_that_is_none_is_refused(client: Client, query: str) -> None:
    assert client.get(f"/api/v1/uavs?{query}").status_code == 400


@pytest.mark.parametrize(
    ("path", "body", "place"),
    [
        ("uav-types", KESTREL | {"max_range_m": 0}, "max_range_m"),
        ("uav-types", KESTREL | {"battery_wh": -1}, "battery_wh"),
        ("uav-types", KESTREL | {"mass_kg": 0}, "mass_kg"),
        ("uav-types", KESTREL | {"cruise_speed_mps": 0}, "cruise_speed_mps"),
        ("uav-types", KESTREL | {"sensors": ["x" * 51]}, "sensors.0"),
        ("uav-types", {}, "name"),
        ("bases", {"name": "Depot"}, "position"),
        ("bases", DEPOT | {"position": [10, 96]}, "position"),
        ("uavs", {"name": "Tern", "base": 10**9}, "base"),
        ("uavs", {"name": "Tern", "position": [10, 56], "type": 10**9}, "type"),
        ("uavs", {"name": "Tern", "position": [10, 56], "mavlink_system_id": 255}, "mavlink_system_id"),
        ("uavs", {"name": "Tern", "position": [10, 56], "state": "lost"}, "state"),
    ],
)
def test_bad_values_are_refused_with_their_place(client: Client, path: str, body: dict[str, Any], place: str) -> None:
    response = post(client, path, body)
    assert response.status_code == 400
    assert place in response.json()["error"]["details"]


def test_names_and_system_ids_are_given_once(client: Client) -> None:
    for path, body in (("uav-types", KESTREL), ("bases", DEPOT)):
        made(client, path, body)
        assert post(client, path, body).json()["error"]["code"] == "name_taken"
    uav_of(client, mavlink_system_id=7)
    response = post(client, "uavs", {"name": "Kite", "position": [10, 56], "mavlink_system_id": 7})
    assert (response.status_code, response.json()["error"]["code"]) == (409, "system_id_taken")
    assert "mavlink_system_id" in response.json()["error"]["details"]


@pytest.mark.parametrize(("path", "body"), [("uavs", {"name": "Tern", "position": [10.0, 56.0]}), ("uav-types", KESTREL), ("bases", DEPOT)])
def test_who_is_second_overwrites_nothing(client: Client, path: str, body: dict[str, Any]) -> None:
    address = f"{path}/{made(client, path, body)['id']}"
    seen = client.get(f"/api/v1/{address}")["ETag"]
    assert client.patch(f"/api/v1/{address}", {"name": "First"}, content_type="application/json").status_code == 428
    assert patch(client, address, {"name": "First"}, **{"If-Match": seen}).status_code == 200
    response = patch(client, address, {"name": "Second"}, **{"If-Match": seen})
    assert response.status_code == 412
    error = response.json()["error"]
    assert "First" in str(error["details"]["current"])
    assert error["details"]["changed_by"]
    assert client.delete(f"/api/v1/{address}", headers={"If-Match": seen}).status_code == 412
    assert patch(client, address, {"name": "Second"}, **{"If-Match": '"2"'}).status_code == 200


def test_what_is_in_use_is_not_deleted(client: Client) -> None:
    kestrel, depot = made(client, "uav-types", KESTREL)["id"], made(client, "bases", DEPOT)["id"]
    uav = uav_of(client, type=kestrel, base=depot)["id"]
    for address, code in ((f"uav-types/{kestrel}", "uav_type_in_use"), (f"bases/{depot}", "base_in_use")):
        response = client.delete(f"/api/v1/{address}", headers=ANY)
        assert (response.status_code, response.json()["error"]["code"]) == (409, code)
    made(client, "missions", mission_body() | {"uavs": [{"id": uav}]})
    response = client.delete(f"/api/v1/uavs/{uav}", headers=ANY)
    assert response.json()["error"] == {"code": "uav_in_use", "message": "A mission uses this UAV. Retire it instead.", "details": None}


def test_what_was_deleted_comes_back_as_it_was(client: Client) -> None:
    kestrel, depot = made(client, "uav-types", KESTREL)["id"], made(client, "bases", DEPOT)["id"]
    uav = uav_of(client, type=kestrel, mavlink_system_id=9, serial_number="SN-7", battery_wh=70, mass_kg=2)["id"]
    for address in (f"uavs/{uav}", f"uav-types/{kestrel}", f"bases/{depot}"):
        before = client.get(f"/api/v1/{address}").json()
        assert client.delete(f"/api/v1/{address}", headers=ANY).status_code == 204
        assert client.get(f"/api/v1/{address}").status_code == 404
        if address.startswith("uavs"):
            assert (
                post(client_of(a_user(organisation=Organisation.objects.create(name="Elsewhere"))), f"{address}/restore").status_code == 409
            )
        after = post(client, f"{address}/restore").json()
        facts, known = (row.get("properties", row) for row in (after, before))
        assert {name: facts[name] for name in facts if name not in {"revision", "updated_at", "uav_count"}} == {
            name: known[name] for name in known if name not in {"revision", "updated_at", "uav_count"}
        }
        assert facts["revision"] > known["revision"]
        assert post(client, f"{address}/restore").json()["error"]["code"] == "not_deleted"
        if address.startswith("uavs"):
            assert client.delete(f"/api/v1/{address}", headers=ANY).status_code == 204


def test_a_name_that_was_given_again_is_not_taken_back(client: Client) -> None:
    depot = made(client, "bases", DEPOT)["id"]
    client.delete(f"/api/v1/bases/{depot}", headers=ANY)
    made(client, "bases", DEPOT)
    assert post(client, f"bases/{depot}/restore").json()["error"]["code"] == "name_taken"


def test_a_uav_comes_back_under_its_bases_present_name(client: Client) -> None:
    depot = made(client, "bases", DEPOT)["id"]
    uav = uav_of(client, base=depot)["id"]
    client.delete(f"/api/v1/uavs/{uav}", headers=ANY)
    patch(client, f"bases/{depot}", {"name": "West"}, **ANY)
    assert post(client, f"uavs/{uav}/restore").json()["properties"]["base_name"] == "West"


def test_a_uav_that_was_deleted_before_there_were_types_and_bases_comes_back(client: Client) -> None:
    before = {
        "name": "Tern", "base_name": "West", "max_range_m": 9_000.0, "cruise_speed_mps": 12.0, "battery_percent": None, "sensor": "",
        "end_action": "hover", "position": [10.0, 56.0],
    }  # fmt: skip
    AuditEntry.objects.create(organisation_id=1, action="delete", subject_type="uav", subject_id="77", before=before)
    answer = post(client, "uavs/77/restore")
    assert answer.status_code == 200, answer.content
    properties = answer.json()["properties"]
    assert (properties["name"], properties["base_name"], properties["base"], properties["state"]) == ("Tern", "West", None, "active")


def test_of_several_organisations_none_takes_all_system_ids(client: Client, settings: Any) -> None:
    settings.MAX_SYSTEM_IDS = 2
    for number in (7, 8, 9):
        uav_of(client, f"Alone {number}", mavlink_system_id=number)
    other = client_of(a_user(organisation=Organisation.objects.create(name="Other")))
    ids = [uav_of(other, f"Other {number}", mavlink_system_id=number)["id"] for number in (17, 18)]
    refused = post(other, "uavs", {"name": "Third", "position": [10, 56], "mavlink_system_id": 19})
    assert (refused.status_code, refused.json()["error"]["code"]) == (409, "system_id_quota")
    third = uav_of(other, "Third")["id"]
    assert patch(other, f"uavs/{third}", {"mavlink_system_id": 19}, **ANY).json()["error"]["code"] == "system_id_quota"
    assert patch(other, f"uavs/{ids[0]}", {"mavlink_system_id": 20}, **ANY).status_code == 200
    assert patch(other, f"uavs/{ids[0]}", {"state": "retired"}, **ANY).status_code == 200
    assert patch(other, f"uavs/{third}", {"mavlink_system_id": 19}, **ANY).status_code == 200


def test_a_retired_uav_gives_its_system_id_back(client: Client) -> None:
    uav = uav_of(client, mavlink_system_id=7)["id"]
    retired = patch(client, f"uavs/{uav}", {"state": "retired"}, **ANY).json()["properties"]
    assert (retired["state"], retired["mavlink_system_id"]) == ("retired", None)
    assert uav_of(client, "Kite", mavlink_system_id=7)
    assert patch(client, f"uavs/{uav}", {"state": "active"}, **ANY).json()["properties"]["mavlink_system_id"] is None


def test_a_uav_with_a_command_on_its_way_is_not_retired(client: Client) -> None:
    uav = uav_of(client, mavlink_system_id=7)["id"]
    queue_command(uav=Uav.objects.get(pk=uav), kind=CommandKind.HOLD, actor=None)
    refused = patch(client, f"uavs/{uav}", {"state": "retired"}, **ANY)
    assert (refused.status_code, refused.json()["error"]["code"]) == (409, "commands_waiting")


def test_a_retired_uav_keeps_its_missions_and_can_come_back(client: Client) -> None:
    uav = uav_of(client)["id"]
    made(client, "missions", mission_body() | {"uavs": [{"id": uav}]})
    assert patch(client, f"uavs/{uav}", {"state": "retired"}, **ANY).json()["properties"]["mission_count"] == 1
    assert names(client, "") == []
    patch(client, f"uavs/{uav}", {"state": "active"}, **ANY)
    assert names(client, "") == ["Tern"]
    assert [entry.after["state"] for entry in AuditEntry.objects.filter(subject_type="uav", action="change").order_by("pk")] == [
        "retired",
        "active",
    ]


def test_the_missions_of_a_uav_are_listed_without_the_deleted(client: Client) -> None:
    uav = uav_of(client)["id"]
    kept, gone = (made(client, "missions", mission_body(name=name) | {"uavs": [{"id": uav}]})["id"] for name in ("Kept", "Gone"))
    Mission.objects.filter(pk=gone).update(deleted_at="2026-01-01T00:00:00Z")
    assert [mission["id"] for mission in client.get(f"/api/v1/uavs/{uav}/missions").json()["results"]] == [kept]
    assert client.get(f"/api/v1/uavs/{uav}").json()["properties"]["mission_count"] == 1


def test_the_fleet_of_another_organisation_does_not_exist(client: Client) -> None:
    kestrel, depot, uav = made(client, "uav-types", KESTREL)["id"], made(client, "bases", DEPOT)["id"], uav_of(client)["id"]
    other = client_of(a_user(organisation=Organisation.objects.create(name="Elsewhere")))
    for address in (f"uav-types/{kestrel}", f"bases/{depot}"):
        assert other.get(f"/api/v1/{address}").status_code == 404
        assert patch(other, address, {"name": "Mine"}, **ANY).status_code == 404
        assert other.delete(f"/api/v1/{address}", headers=ANY).status_code == 404
    assert post(other, f"uavs/{uav}/credentials", {"kind": "link-token"}).status_code == 404
    assert other.get(f"/api/v1/uavs/{uav}/missions").status_code == 404
    assert post(other, "uavs", {"name": "Tern", "base": depot}).status_code == 400
    assert (UavType.objects.count(), Base.objects.count(), Uav.objects.count()) == (1, 1, 1)


def test_an_answer_that_was_lost_makes_no_second_row(client: Client) -> None:
    for path, body in (("uav-types", KESTREL), ("bases", DEPOT)):
        answers = [post(client, path, body, **{"Idempotency-Key": f"once {path}"}).json()["id"] for _ in range(2)]
        assert answers[0] == answers[1]
    assert (UavType.objects.count(), Base.objects.count()) == (1, 1)


def test_viewers_see_the_fleet_and_change_nothing(client: Client) -> None:
    uav = uav_of(client)["id"]
    viewer = client_of(a_user(Role.VIEWER))
    assert viewer.get(f"/api/v1/uavs/{uav}/credentials").status_code == 200
    for path, body in (("uav-types", KESTREL), ("bases", DEPOT), (f"uavs/{uav}/credentials", {"kind": "link-token"})):
        assert post(viewer, path, body).status_code == 403
    assert patch(viewer, f"uavs/{uav}", {"state": UavState.RETIRED}, **ANY).status_code == 403


def test_who_has_seen_a_type_before_the_admin_changed_it_does_not_overwrite_that(client: Client) -> None:
    kestrel = made(client, "uav-types", KESTREL)
    form = {
        "organisation": 1,
        "name": "Kestrel",
        "max_range_m": 5_000,
        "cruise_speed_mps": 14,
        "battery_wh": "",
        "mass_kg": "",
        "reserve_percent": 20,
        "sensors": "",
    }
    administrator = client_of(a_user(Role.ADMINISTRATOR))
    assert administrator.post(f"/admin/missions/uavtype/{kestrel['id']}/change/", form).status_code == 302
    refused = patch(client, f"uav-types/{kestrel['id']}", {"max_range_m": 70_000.0}, **{"If-Match": '"1"'})
    assert (refused.status_code, refused.json()["error"]["details"]["current"]["max_range_m"]) == (412, 5_000.0)
    entry = AuditEntry.objects.filter(subject_type="uav_type", action="change").get()
    assert entry.after == {"max_range_m": "5000.0"}
