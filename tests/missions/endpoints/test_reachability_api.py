"""Which assets can be inspected, over the API."""

from typing import Any

import pytest
from django.contrib.gis.geos import Point
from django.test import Client

from inspection.models import Asset, GraphSnapshot, NoFlyZone
from inspection.services import mark_ground_changed
from missions.models import Base, Uav, UavState
from tests.accounts.users import a_user, client_of
from tests.missions.api import TERN, post
from tests.missions.worlds import UAV_AT, World, island, world, zone_around
from workspace.models import Organisation, Role

pytestmark = pytest.mark.django_db


@pytest.fixture
def client() -> Client:
    return client_of(a_user(Role.VIEWER))


def asked(client: Client, status: int = 200, **body: Any) -> dict[str, Any]:
    response = post(client, "reachability", {"uavs": [TERN]} | body)
    assert response.status_code == status, response.content
    return response.json()


def codes(stated: dict[str, Any]) -> dict[int, str]:
    """By asset what is said of it."""
    names = ["reachable", *(reason["code"] for reason in stated["reasons"])]
    return dict(zip(stated["assets"]["ids"], [names[code] for code in stated["assets"]["code"]], strict=True))


def test_without_a_limit_all_that_is_joined_can_be_inspected(here: World, client: Client) -> None:
    stated = asked(client)
    assert stated["reachable"] == stated["of"] == 9
    assert stated["reasons"] == stated["grounded"] == []
    assert set(stated["assets"]["ids"]) == {asset.pk for asset in (*here.towers, here.line, here.railway, here.bridge)}
    assert stated["flights"] == [{"uav": 0, "base": None}]


@pytest.mark.parametrize("end_action", ["hover", "land", "return", "base"])
def test_however_it_ends_all_that_is_joined_can_be_inspected(here: World, client: Client, end_action: str) -> None:
    Base.objects.create(name="West", location=Point(10.001, 56.0, srid=4326))
    assert asked(client, uavs=[TERN | {"end_action": end_action}])["reachable"] == 9


def test_a_short_range_tells_what_is_missing(here: World, client: Client) -> None:
    stated = asked(client, uavs=[TERN | {"max_range_m": 1_000}])
    found = codes(stated)
    assert (found[here.towers[0].pk], found[here.towers[5].pk], found[here.line.pk]) == ("reachable", "beyond_range", "partly_reachable")
    [far] = [reason for reason in stated["reasons"] if reason["code"] == "beyond_range"]
    assert far["count"] == sum(code == "beyond_range" for code in found.values())
    missing_m = dict(zip(stated["assets"]["ids"], stated["assets"]["missing_m"], strict=True))
    assert missing_m[here.towers[0].pk] == 0
    assert 0 < missing_m[here.towers[4].pk] < missing_m[here.towers[5].pk]


def test_what_is_reached_is_what_a_plan_flies_to(here: World, client: Client) -> None:
    """Each tower planned alone, with ranges on both sides of what the preferred way and the shortest one take."""
    operator = client_of(a_user(Role.OPERATOR))

    def planned(tower: Asset, max_range_m: float | None) -> dict[str, Any]:
        return post(operator, "plans", {"uavs": [TERN | {"max_range_m": max_range_m}], "targets": [{"asset": tower.pk}]}).json()

    reported = set()
    for tower in here.towers:
        needed_m = planned(tower, None)["routes"][0]["length_m"]
        for range_m in (needed_m + 1.0, needed_m - 1.0, 0.9 * needed_m, 0.5 * needed_m):
            is_flown = not planned(tower, range_m)["unassigned"]
            reported.add(is_flown)
            code = codes(asked(client, uavs=[TERN | {"max_range_m": range_m}]))[tower.pk]
            assert code == ("reachable" if is_flown else "beyond_range"), range_m / needed_m
    assert reported == {True, False}


def test_a_small_battery_tells_what_is_missing_and_a_storm_that_it_is_one(here: World, client: Client) -> None:
    small = TERN | {"battery_wh": 8.0, "max_airspeed_mps": 15.0}
    stated = asked(client, uavs=[small])
    found = codes(stated)
    assert (found[here.towers[0].pk], found[here.towers[5].pk]) == ("reachable", "beyond_energy")
    missing_wh = dict(zip(stated["assets"]["ids"], stated["assets"]["missing_wh"], strict=True))
    assert missing_wh[here.towers[0].pk] == 0 < missing_wh[here.towers[5].pk]
    storm = {"wind": [{"altitude_agl_m": 60.0, "speed_mps": 20.0, "from_deg": 270.0}], "temperature_c": 15.0}
    assert set(codes(asked(client, uavs=[small], conditions=storm)).values()) == {"wind"}


def test_with_charging_on_the_way_it_is_said_that_this_is_not_counted(here: World, client: Client) -> None:
    small = TERN | {"battery_wh": 8.0}
    assert asked(client, uavs=[small])["not_counted"] == []
    stated = asked(client, uavs=[small], charging_w=400.0)
    assert stated["not_counted"] == ["charging"]
    assert any("a plan tells" in reason["message"] for reason in stated["reasons"])
    assert codes(stated)[here.towers[5].pk] == "beyond_energy"


def test_who_lands_at_the_target_reaches_nothing_over_a_low_zone(here: World, client: Client) -> None:
    zone = zone_around((10.008, 56.0), name="Yard", with_graph=False)
    NoFlyZone.objects.filter(pk=zone.pk).update(upper_limit_m=10.0, upper_reference="AGL")
    mark_ground_changed()
    for end_action, code in (("hover", "reachable"), ("land", "inside_zone"), ("return", "reachable")):
        stated = asked(client, uavs=[TERN | {"end_action": end_action}])
        assert codes(stated)[here.towers[2].pk] == code
        assert codes(stated)[here.towers[3].pk] == "reachable"
    assert "Landing there leads through a no-fly zone." in [
        reason["message"] for reason in asked(client, uavs=[TERN | {"end_action": "land"}])["reasons"]
    ]


def test_inside_a_zone_names_it(here: World, client: Client) -> None:
    zone_around((10.008, 56.0), name="Airport")
    stated = asked(client)
    assert codes(stated)[here.towers[2].pk] == "inside_zone"
    assert "Inside Airport." in [reason["message"] for reason in stated["reasons"]]


def test_a_saved_zone_counts_at_once_without_a_new_graph(here: World, client: Client) -> None:
    assert codes(asked(client))[here.towers[2].pk] == "reachable"
    zone_around((10.008, 56.0), with_graph=False)
    assert codes(asked(client))[here.towers[2].pk] == "inside_zone"


def test_too_tall_and_cut_off_are_told_apart(client: Client) -> None:
    Asset.objects.all().delete()
    tall = world(height_m=110.0)
    lone = island()
    found = codes(asked(client))
    assert found[tall.towers[0].pk] == "above_height_limit"
    assert found[lone[0].pk] == "no_path"


def test_from_chosen_bases_each_uav_starts_at_each(here: World, client: Client) -> None:
    lone = island()
    bases = [Base.objects.create(name=name, location=Point(lon, 56.0, srid=4326)) for name, lon in (("East", 10.301), ("West", 10.001))]
    stated = asked(client, bases=[base.pk for base in bases])
    assert stated["flights"] == [{"uav": 0, "base": "East"}, {"uav": 0, "base": "West"}]
    flight = dict(zip(stated["assets"]["ids"], stated["assets"]["flight"], strict=True))
    assert (flight[lone[0].pk], flight[here.towers[0].pk]) == (0, 1)


def test_a_uav_that_cannot_take_off_reaches_nothing(here: World, client: Client) -> None:
    zone_around(UAV_AT, name="Airport")
    stated = asked(client)
    assert stated["flights"] == []
    assert [(one["uav"], one["code"]) for one in stated["grounded"]] == [(0, "uav_inside_zone")]
    assert "no_uav" in {reason["code"] for reason in stated["reasons"]}


def test_a_retired_uav_of_the_fleet_reaches_nothing(here: World, client: Client) -> None:
    uav = Uav.objects.create(name="Old", location=Point(*UAV_AT, srid=4326), state=UavState.RETIRED)
    assert [one["code"] for one in asked(client, uavs=[{"id": uav.pk}])["grounded"]] == ["uav_out_of_service"]


def test_only_what_is_in_the_box_is_told(here: World, client: Client) -> None:
    stated = asked(client, box=[9.999, 55.999, 10.005, 56.001])
    assert set(stated["assets"]["ids"]) == {here.towers[0].pk, here.towers[1].pk, here.line.pk}
    assert stated["of"] == 3


def test_uavs_and_bases_of_others_are_not_there(here: World, client: Client) -> None:
    other = Organisation.objects.create(name="Elsewhere")
    base = Base.objects.create(organisation=other, name="Theirs", location=Point(10.0, 56.0, srid=4326))
    uav = Uav.objects.create(organisation=other, name="Theirs", location=Point(*UAV_AT, srid=4326))
    assert "bases" in asked(client, 400, bases=[base.pk])["error"]["details"]
    assert asked(client, 400, uavs=[{"id": uav.pk}])["error"]["code"] == "invalid"


@pytest.mark.parametrize(
    "fault",
    [
        {"uavs": []},
        {"box": [1, 2, 3]},
        {"box": [0, 10, 1, -10]},
        {"box": [0, "a", 1, 1]},
        {"bases": ["x"]},
        {"departs_at": "yesterday"},
        {"uavs": [TERN | {"end_action": "base"}]},
    ],
)
def test_what_makes_no_sense_is_refused(here: World, client: Client, fault: dict[str, Any]) -> None:
    assert asked(client, 400, **fault)["error"]["code"] == "invalid"


def test_without_a_network_there_is_nothing_to_tell(client: Client) -> None:
    GraphSnapshot.objects.all().delete()
    assert asked(client, 503)["error"]["code"] == "no_graph"


def test_nobody_asks_without_signing_in(here: World) -> None:
    assert post(Client(), "reachability", {"uavs": [TERN]}).status_code in {401, 403}
