"""What UAVs do when their link is lost: wished for, checked, stored."""

from typing import Any

import pytest
from django.test import Client

from tests.missions.api import TERN, mission_body, plan_body, post
from tests.missions.worlds import World, world, zone_around
from tests.workspace.people import client_of, somebody

pytestmark = pytest.mark.django_db
IRIS = TERN | {"position": [10.0, 55.9999], "cruise_speed_mps": 8.0, "battery_wh": 56.6, "max_airspeed_mps": 11.0}


@pytest.fixture
def here() -> World:
    return world()


@pytest.fixture
def client() -> Client:
    return client_of(somebody())


def checked(client: Client, here: World, **wished: Any) -> dict[str, Any]:
    plan = post(client, "plans", plan_body(here.towers[5], uavs=[IRIS], lost_link=wished)).json()
    found: dict[str, Any] = plan["lost_link"]
    return found


def test_who_goes_on_has_nothing_to_be_checked(here: World, client: Client) -> None:
    plan = post(client, "plans", plan_body(here.towers[5])).json()
    assert plan["lost_link"] == {"behaviour": "go_on", "rally_points": [], "hold_s": 0.0, "failed": []}


def test_a_zone_between_the_route_and_its_start_bars_the_return_and_a_rally_point_mends_it(here: World, client: Client) -> None:
    assert checked(client, here, behaviour="return")["failed"] == []
    zone_around((10.010, 55.9998), 0.0012, name="Fire brigade")
    failed = checked(client, here, behaviour="return")["failed"]
    assert {one["trouble"] for one in failed} == {"zone"}
    assert {one["zone"] for one in failed} == {"Fire brigade"}
    assert {one["haven"] for one in failed} == {0}
    mended = checked(client, here, behaviour="return", rally_points=[[10.021, 56.0005]])["failed"]
    assert len(mended) < len(failed)


def test_the_wish_is_stored_with_the_mission_and_checked_with_its_plan(here: World, client: Client) -> None:
    wish = {"behaviour": "hold", "rally_points": [[10.021, 56.0005]], "hold_s": 60.0}
    mission = post(client, "missions", mission_body(here.towers[5], uavs=[IRIS], lost_link=wish) | {"plan": True}).json()
    assert mission["lost_link"] == wish
    assert mission["plan"]["lost_link"] == wish | {"failed": []}
    again = post(client, f"missions/{mission['id']}/plan").json()
    assert again["plan"]["lost_link"] == mission["plan"]["lost_link"]
