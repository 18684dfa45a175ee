"""A field that is not known is refused by its name wherever a plan, a mission or something of the fleet is asked for."""

from typing import Any

import pytest
from django.test import Client

from missions.models import Uav, UavCredential
from tests.accounts.users import a_user, client_of
from tests.missions.api import mission_body, patch, plan_body, post
from tests.missions.worlds import world
from workspace.models import Role

pytestmark = pytest.mark.django_db


def details(client: Client, path: str, body: dict[str, Any]) -> dict[str, Any]:
    response = post(client, path, body)
    assert response.status_code == 400, response.content
    found: dict[str, Any] = response.json()["error"]["details"]
    return found


def test_a_mistyped_field_is_named_with_the_one_that_is_meant() -> None:
    here, client = world(), client_of(a_user())
    body = mission_body(here.towers[1])
    plan = {name: value for name, value in body.items() if name != "name"}
    assert details(client, "plans", plan | {"return_to_strat": True}) == {
        "return_to_strat": ["There is no such field; is return_to_start meant?"]
    }
    assert details(client, "missions", body | {"colour": "red"}) == {"colour": ["There is no such field."]}
    uav = plan["uavs"][0] | {"max_airspeed": 11}
    assert "is max_airspeed_mps meant?" in str(details(client, "plans", plan | {"uavs": [uav]}))
    wind = {"wind": [{"altitude_agl_m": 50, "speed": 4, "from_deg": 90}]}
    assert "is speed_mps meant?" in str(details(client, "plans", plan | {"conditions": wind}))


def test_a_patch_of_an_unknown_field_changes_nothing() -> None:
    here, client = world(), client_of(a_user())
    mission = post(client, "missions", mission_body(here.towers[1])).json()
    answer = patch(client, f"missions/{mission['id']}", {"nmae": "North"})
    assert answer.status_code == 400
    assert answer.json()["error"]["details"] == {"nmae": ["There is no such field; is name meant?"]}


def test_of_many_unknown_fields_a_few_are_told() -> None:
    here, client = world(), client_of(a_user())
    many = {f"{'x' * 200}{number}": 1 for number in range(50)}
    reported = details(client, "missions", mission_body(here.towers[1]) | many)
    assert max(map(len, reported)) == 80
    assert len(reported) <= 10


def test_of_a_long_list_the_nearest_names_are_looked_for_a_few_times_only() -> None:
    here, client = world(), client_of(a_user())
    wrong = [{f"positio{number}": 1 for number in range(10)} for _ in range(300)]
    reported = details(client, "plans", plan_body(here.towers[1]) | {"targets": wrong})
    meant = [words for words in reported.values() if "is position meant" in str(words)]
    assert 1 <= len(meant) <= 10


UAV = {"name": "Kite", "position": [10.0, 56.0]}


@pytest.mark.parametrize(
    ("path", "body", "place", "words"),
    [
        ("uavs", UAV | {"batery_wh": 40}, "batery_wh", "is battery_wh meant?"),
        ("uavs", UAV | {"retired": True}, "retired", "There is no such field."),
        ("uav-types", {"name": "Iris", "cruise_speed": 9}, "cruise_speed", "is cruise_speed_mps meant?"),
        ("bases", {"name": "North", "position": [10.0, 56.0], "notes": "by the gate"}, "notes", "is note meant?"),
        ("uavs", {"type": "Feature", "properties": {"name": "Kite", "mass": 2}}, "mass", "is mass_kg meant?"),
        ("uavs", {"type": "Feature", "properties": {"name": "Kite"}, "mass_kg": 2}, "mass_kg", "stands in its properties"),
        ("uavs", {"type": "Feature", "properties": {"name": "Kite"}, "geometry": {"type": "Polygon"}}, "position", "at a Point"),
        ("uavs", {"type": "Feature", "properties": ["Kite"]}, "properties", "An object is needed."),
    ],
)
def test_a_mistyped_field_of_the_fleet_is_named(path: str, body: dict[str, Any], place: str, words: str) -> None:
    client = client_of(a_user(Role.ADMINISTRATOR))
    assert words in str(details(client, path, body)[place])
    assert not Uav.objects.exists()


def test_a_mistyped_field_of_a_credential_is_named_and_nothing_is_made() -> None:
    client = client_of(a_user(Role.ADMINISTRATOR))
    uav = post(client, "uavs", UAV).json()["id"]
    assert details(client, f"uavs/{uav}/credentials", {"kind": "link-token", "expires": "2027-01-01"}) == {
        "expires": ["There is no such field."]
    }
    assert not UavCredential.objects.exists()


@pytest.mark.parametrize("path", ["uavs", "uav-types", "bases"])
def test_what_was_answered_may_be_sent_again(path: str) -> None:
    client = client_of(a_user(Role.ADMINISTRATOR))
    body = {"name": "Iris"} if path == "uav-types" else UAV
    made = post(client, path, body).json()
    again = patch(client, f"{path}/{made['id']}", made, **{"If-Match": "*"})
    assert again.status_code == 200, again.content
