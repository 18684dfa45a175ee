"""What a mission remembers of the plan before the present one."""

import pytest
from django.test import Client

from tests.accounts.users import a_user, client_of
from tests.missions.api import mission_body, patch, post
from tests.missions.worlds import World

pytestmark = pytest.mark.django_db


@pytest.fixture
def client() -> Client:
    return client_of(a_user())


def test_a_first_plan_has_none_before_it(here: World, client: Client) -> None:
    mission = post(client, "missions", mission_body(here.towers[0], plan=True)).json()
    assert mission["plan"] is not None
    assert mission["last_plan"] is None


def test_a_plan_that_is_replaced_is_remembered_in_short(here: World, client: Client) -> None:
    mission = post(client, "missions", mission_body(here.towers[1], here.towers[4], {"position": [10.0, 56.3]}, plan=True)).json()
    before = mission["plan"]
    wanted = {"targets": [{"asset": here.towers[4].pk}], "plan": True}
    now = patch(client, f"missions/{mission['id']}", wanted).json()
    last = now["last_plan"]
    assert last["total_length_m"] == before["total_length_m"] > now["plan"]["total_length_m"]
    assert last["duration_s"] == before["routes"][0]["departs_s"] + before["routes"][0]["duration_s"]
    (route,) = last["routes"]
    assert (route["uav"], route["length_m"]) == (before["routes"][0]["uav"], before["routes"][0]["length_m"])
    assert [stop["asset"] for stop in route["stops"]] == [here.towers[1].pk, here.towers[4].pk]
    first_m, second_m = (stop["at_m"] for stop in route["stops"])
    assert 0 < first_m < second_m <= route["length_m"] + 0.1
    assert route["start"] == before["routes"][0]["waypoints"][0]["position"]
    assert (route["end_action"], route["base"]) == (before["routes"][0]["end_action"], None)
    assert route["off_network"][0][0] == 0.0  # from where it stands to the line
    assert [target["position"] for target in last["unassigned"]] == [[10.0, 56.3]]


def test_planning_the_same_again_remembers_the_plan_too(here: World, client: Client) -> None:
    mission = post(client, "missions", mission_body(here.towers[1], plan=True)).json()
    again = post(client, f"missions/{mission['id']}/plan").json()
    assert again["last_plan"]["total_length_m"] == mission["plan"]["total_length_m"]


def test_a_change_without_a_plan_keeps_what_was_remembered(here: World, client: Client) -> None:
    mission = post(client, "missions", mission_body(here.towers[1], plan=True)).json()
    patch(client, f"missions/{mission['id']}", {"return_to_start": True})
    draft = patch(client, f"missions/{mission['id']}", {"return_to_start": False}).json()
    assert draft["plan"] is None
    assert draft["last_plan"]["total_length_m"] == mission["plan"]["total_length_m"]
