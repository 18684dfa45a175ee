"""Why a target is not reached, and where the kilometres of a route come from."""

from typing import Any

import pytest
from django.test import Client

from inspection.models import Asset
from missions.models import Uav
from tests.accounts.users import a_user, client_of
from tests.inspection import ground
from tests.missions.api import TERN, mission_body, plan_body, post, unlimited_type
from tests.missions.worlds import UAV_AT, World, island, power_line, rebuild, zone_around
from workspace.models import Role

pytestmark = pytest.mark.django_db


@pytest.fixture
def client() -> Client:
    return client_of(a_user(Role.OPERATOR))


def why_target(client: Client, body: dict[str, Any], target: int = 0) -> dict[str, Any]:
    response = post(client, "plans/why-target", body | {"target": target})
    assert response.status_code == 200, response.content
    return response.json()


def why_route(client: Client, body: dict[str, Any], uav: int = 0) -> tuple[dict[str, Any], dict[str, Any]]:
    """The answer, and the plan that was asked about."""
    plan = post(client, "plans", body).json()
    response = post(client, "plans/why-route", body | {"routes": [route["targets"] for route in plan["routes"]], "uav": uav})
    assert response.status_code == 200, response.content
    return response.json(), plan


def test_a_target_in_a_zone_names_the_zone(here: World, client: Client) -> None:
    zone = zone_around((10.008, 56.0))
    stated = why_target(client, plan_body(here.towers[2]))
    assert (stated["reason"], stated["zones"], stated["stretches"]) == ("inside_zone", [{"id": zone.pk, "name": "Airport"}], [])


def test_a_line_through_a_zone_says_which_parts_can_be_flown_and_these_can(here: World, client: Client) -> None:
    zone_around((10.010, 56.0))
    stated = why_target(client, plan_body(here.line))
    assert stated["reason"] == "inside_zone"
    west, east = stated["stretches"]
    assert west[0] == [10.0, 56.0]
    assert west[1][0] < 10.009
    assert east[0][0] > 10.011
    assert east[1] == [10.020, 56.0]
    for stretch in stated["stretches"]:
        assert post(client, "plans", plan_body({"asset": here.line.pk, "stretch": stretch})).json()["unassigned"] == []


def test_a_target_out_of_range_says_what_each_uav_needs_and_who_of_the_fleet_could(here: World, client: Client) -> None:
    common = {"position": list(UAV_AT), "type": unlimited_type(client)}
    spare = post(client, "uavs", common | {"name": "Kite", "max_range_m": 50_000.0}).json()["id"]
    post(client, "uavs", common | {"name": "Wren", "max_range_m": 700.0})
    body = plan_body(here.towers[5]) | {"uavs": [TERN | {"max_range_m": 900.0}], "return_to_start": True}
    assert post(client, "plans", body).json()["unassigned"][0]["reason"] == "beyond_range"
    stated = why_target(client, body)
    assert stated["reason"] == "beyond_range"
    own, *others = stated["uavs"]
    assert own["is_in_mission"] and not own["is_enough"]
    for more_m, left_out in ((0.1, 0), (-0.1, 1)):  # on the shortest way, which is tried before it is refused
        just = post(client, "plans", body | {"uavs": [TERN | {"max_range_m": own["needed_m"] + more_m}]}).json()
        assert len(just["unassigned"]) == left_out
    assert {uav["name"]: uav["is_enough"] for uav in others} == {"Kite": True}  # Wren's range does not even reach there straight
    assert others[0]["uav_id"] == spare
    assert post(client, "plans", body | {"uavs": [TERN | {"max_range_m": 900.0}, {"id": spare}]}).json()["unassigned"] == []


def test_a_spare_uav_may_land_at_a_base_where_none_of_the_plan_does(here: World, client: Client) -> None:
    kite = {"name": "Kite", "position": list(UAV_AT), "end_action": "base", "max_range_m": 50_000.0, "type": unlimited_type(client)}
    post(client, "uavs", kite)
    body = plan_body(here.towers[5]) | {"uavs": [TERN | {"max_range_m": 100.0}]}
    assert {uav["name"]: uav["is_enough"] for uav in why_target(client, body)["uavs"]} == {"Tern": False, "Kite": False}  # no base
    post(client, "bases", {"name": "North", "position": [10.012, 56.0005]})
    own, spare = why_target(client, body)["uavs"]
    assert (own["is_enough"], spare["is_enough"]) == (False, True)
    assert spare["needed_m"] > own["needed_m"]  # the way to the base, too


def test_a_retired_uav_is_not_offered(here: World, client: Client) -> None:
    post(client, "uavs", {"name": "Kite", "position": list(UAV_AT), "type": unlimited_type(client)})
    Uav.objects.update(state="retired")
    body = plan_body(here.towers[5]) | {"uavs": [TERN | {"max_range_m": 900.0}], "return_to_start": True}
    assert [uav["name"] for uav in why_target(client, body)["uavs"]] == ["Tern"]


def test_a_place_far_from_everything_says_how_far(here: World, client: Client) -> None:
    stated = why_target(client, plan_body({"position": [10.0, 56.3]}))
    assert stated["reason"] == "too_far_from_network"
    assert stated["network_m"] == pytest.approx(32_200, rel=0.01)
    assert stated["access_limit_m"] == 10_000.0


def test_a_target_that_is_only_left_out_for_the_others_says_so(here: World, client: Client) -> None:
    assert why_target(client, plan_body(here.towers[0], here.towers[5]), target=1)["reason"] == "not_with_the_others"


def test_a_part_of_the_network_behind_a_zone_names_it(here: World, client: Client) -> None:
    towers = [here.towers[-1], *(ground.tower((10.05 + 0.05 * place, 56.0)) for place in range(14))]
    power_line(towers)
    zone_around((10.35, 56.0), half_deg=0.14, name="Firing range")
    stated = why_target(client, plan_body(towers[-1]))
    assert (stated["reason"], [zone["name"] for zone in stated["zones"]]) == ("no_path", ["Firing range"])
    assert stated["message"] == "No permitted route from any base. Firing range is in the way."


def test_an_island_is_not_connected_and_no_zone_is_blamed(here: World, client: Client) -> None:
    far, _ = island()
    zone_around((10.15, 56.0), half_deg=0.14, name="Firing range")
    body = plan_body(far)
    assert post(client, "plans", body).json()["unassigned"][0]["reason"] == "no_path"
    stated = why_target(client, body)
    assert (stated["reason"], stated["zones"]) == ("no_path", [])
    assert "It is not connected to the network of any UAV" in stated["message"]


def test_the_parts_of_a_route_add_up_to_it(here: World, client: Client) -> None:
    body = plan_body(here.towers[1], here.towers[4], return_to_start=True)
    stated, plan = why_route(client, body)
    assert stated["length_m"] == pytest.approx(plan["routes"][0]["length_m"], rel=1e-4)
    assert stated["straight_m"] + stated["on_lines_m"] + stated["round_zones_m"] == pytest.approx(stated["length_m"], rel=1e-9)
    assert stated["round_zones_m"] == 0.0
    assert stated["zones"] == []


def test_a_way_round_a_zone_is_counted_and_the_zone_named(here: World, client: Client) -> None:
    power_line([here.towers[0], ground.tower((10.010, 56.004)), here.towers[5]])
    rebuild()
    body = plan_body(here.towers[0], here.towers[5])
    before, _ = why_route(client, body)
    zone = zone_around((10.010, 56.0))
    after, plan = why_route(client, body)
    assert after["length_m"] == pytest.approx(plan["routes"][0]["length_m"], rel=1e-4)
    assert after["round_zones_m"] == pytest.approx(after["length_m"] - before["length_m"], rel=0.05)
    assert after["round_zones_m"] > 100
    assert [(named["id"], named["name"]) for named in after["zones"]] == [(zone.pk, "Airport")]


def test_a_route_that_a_later_zone_cuts_off_is_not_explained(here: World, client: Client) -> None:
    body = plan_body(here.towers[0], here.towers[5])
    plan = post(client, "plans", body).json()
    zone_around((here.towers[5].centre.x, here.towers[5].centre.y), half_deg=0.001)
    rebuild()
    answer = post(client, "plans/why-route", body | {"routes": [route["targets"] for route in plan["routes"]], "uav": 0})
    assert (answer.status_code, list(answer.json()["error"]["details"])) == (400, ["routes"])


def refused_route(client: Client, body: dict[str, Any]) -> None:
    answer = post(client, "plans/why-route", body | {"routes": [[0]], "uav": 0})
    assert (answer.status_code, list(answer.json()["error"]["details"])) == (400, ["routes"])


def test_a_route_with_no_way_home_is_not_explained(here: World, client: Client) -> None:
    refused_route(client, plan_body(island()[0], return_to_start=True))
    body = plan_body(here.towers[2], return_to_start=True)
    why_route(client, body)
    zone_around((here.towers[2].centre.x, here.towers[2].centre.y), half_deg=0.0002)
    refused_route(client, body)


@pytest.mark.parametrize("base_lon", [10.012, 10.9], ids=["inside a zone", "out of reach"])
def test_a_route_with_no_way_to_a_base_is_not_explained(here: World, client: Client, base_lon: float) -> None:
    post(client, "bases", {"name": "North", "position": [base_lon, 56.0005]})
    zone_around((10.012, 56.0005), half_deg=0.0003)
    refused_route(client, plan_body(here.towers[2]) | {"uavs": [TERN | {"end_action": "base"}]})


def test_a_place_where_there_is_no_network_at_all_has_no_distance_to_it(here: World, client: Client) -> None:
    Asset.objects.all().delete()
    rebuild()
    stated = why_target(client, plan_body({"position": [10.0, 56.3]}))
    assert (stated["reason"], stated["network_m"]) == ("too_far_from_network", None)


def test_another_uav_is_set_against_the_one_that_flies(here: World, client: Client) -> None:
    uavs = [TERN, TERN | {"name": "Kite", "position": [10.019, 55.995]}]
    body = plan_body(here.towers[0], here.towers[1], here.towers[5], uavs=uavs, objective="makespan")
    stated, plan = why_route(client, body)
    assert plan["routes"][1]["targets"] == [2]
    alternative = stated["alternative"]
    assert (alternative["uav"], alternative["target"]) == (1, 1)  # the nearer of its two
    assert alternative["other_length_m"] > plan["routes"][1]["length_m"]
    assert not alternative["is_beyond_range"]


def test_the_costliest_target_saves_what_it_says(here: World, client: Client) -> None:
    stated, plan = why_route(client, plan_body(here.towers[0], here.towers[5]))
    heaviest = stated["heaviest"]
    rest = here.towers[0] if heaviest["target"] == 1 else here.towers[5]
    without = post(client, "plans", plan_body(rest)).json()
    assert heaviest["saves_m"] == pytest.approx(plan["total_length_m"] - without["total_length_m"], rel=1e-4)


def test_a_viewer_may_ask_why(here: World) -> None:
    viewer = client_of(a_user(Role.VIEWER))
    assert why_target(viewer, plan_body(here.towers[0]))["target"] == 0


@pytest.mark.parametrize(
    ("path", "more", "place"),
    [
        ("plans/why-target", {"target": 7}, "target"),
        ("plans/why-route", {"routes": [], "uav": 0}, "routes"),
        ("plans/why-route", {"routes": [[0, 0]], "uav": 0}, "routes"),
        ("plans/why-route", {"routes": [[5]], "uav": 0}, "routes"),
        ("plans/why-route", {"routes": [[]], "uav": 0}, "uav"),
    ],
)
def test_a_question_about_another_plan_is_refused(here: World, client: Client, path: str, more: dict[str, Any], place: str) -> None:
    response = post(client, path, plan_body(here.towers[0]) | more)
    assert response.status_code == 400
    assert place in response.json()["error"]["details"]


def test_what_binds_a_route_is_said(here: World, client: Client) -> None:
    iris = TERN | {
        "position": [10.0, 55.9999],
        "cruise_speed_mps": 8.0,
        "battery_wh": 56.6,
        "max_airspeed_mps": 11.0,
        "end_action": "return",
    }
    body = plan_body(here.towers[5], uavs=[iris])
    calm, plan = why_route(client, body)
    assert calm["binds"] == []
    assert calm["used_wh"] == pytest.approx(plan["total_energy_wh"], rel=0.01)
    assert calm["wind_s"] == pytest.approx(0.0, abs=0.01)
    tight = iris | {"battery_wh": 1.02 * plan["total_energy_wh"] / 0.8, "most_targets": 1}
    wind = {"wind": [{"altitude_agl_m": 60.0, "speed_mps": 7.0, "from_deg": 90.0}]}
    bound, _ = why_route(client, plan_body(here.towers[5], uavs=[tight]))
    assert bound["binds"] == ["battery", "most_targets"]
    windy, _ = why_route(client, body | {"conditions": wind})
    assert "wind" in windy["binds"]
    assert windy["wind_s"] > 10.0


def test_a_mast_too_tall_is_told_as_such_and_not_as_a_zone(here: World, client: Client) -> None:
    mast = ground.tower((10.006, 56.004), height_m=200.0)
    power_line([mast, ground.tower((10.010, 56.004))])
    rebuild()
    body = plan_body(mast, here.towers[3])
    assert post(client, "plans", body).json()["unassigned"][0]["reason"] == "above_height_limit"
    stated = post(client, "plans/why-target", body | {"target": 0}).json()
    assert (stated["reason"], stated["zones"]) == ("above_height_limit", [])


def test_what_the_shortest_way_reaches_nothing_calls_out_of_range(here: World, client: Client) -> None:
    body = plan_body(here.towers[5])
    body["uavs"] = [body["uavs"][0] | {"position": [10.001, 55.995], "max_range_m": 1_400.0}]
    plan = post(client, "plans", body).json()
    assert (plan["unassigned"], [warning["code"] for warning in plan["warnings"]]) == ([], ["shortest_ways"])
    reached = post(client, "reachability", {"uavs": body["uavs"]}).json()["assets"]
    assert reached["code"][reached["ids"].index(here.towers[5].pk)] == 0
    assert post(client, "plans/why-target", body | {"target": 0}).json()["reason"] == "not_with_the_others"


def test_a_battery_too_small_and_a_wind_too_strong_are_told_as_such(here: World, client: Client) -> None:
    body = plan_body(here.towers[5]) | {"return_to_start": True}
    small = TERN | {"battery_wh": 4.0, "mass_kg": 1.5, "max_airspeed_mps": 15.0}
    calm = body | {"uavs": [small]}
    storm = body | {
        "uavs": [small | {"battery_wh": 400.0}],
        "conditions": {"wind": [{"altitude_agl_m": 0, "speed_mps": 18, "from_deg": 270}]},
    }
    for asked, reason in ((calm, "beyond_energy"), (storm, "wind")):
        (left_out,) = post(client, "plans", asked).json()["unassigned"]
        stated = why_target(client, asked)
        assert (left_out["reason"], stated["reason"], stated["message"]) == (reason, reason, left_out["message"])


def test_a_route_on_the_shortest_ways_is_explained_on_these(here: World, client: Client) -> None:
    body = plan_body(here.towers[5])
    body["uavs"] = [body["uavs"][0] | {"position": list(UAV_AT), "max_range_m": 1_400.0}]
    plan = post(client, "plans", body).json()
    asked = body | {"routes": [route["targets"] for route in plan["routes"]], "uav": 0, "shortest_ways": True}
    stated = post(client, "plans/why-route", asked).json()
    assert stated["length_m"] == pytest.approx(plan["total_length_m"], rel=1e-6)


def test_a_mission_explains_its_routes_and_what_it_leaves_out(here: World, client: Client) -> None:
    zone_around((10.008, 56.0))
    made = post(client, "missions", mission_body(here.towers[2], here.towers[5], plan=True)).json()
    stated = client.get(f"/api/v1/missions/{made['id']}/explanation").json()
    assert [(route["uav"], route["fault"]) for route in stated["routes"]] == [(0, "")]
    assert [(target["target"], target["reason"]) for target in stated["targets"]] == [(0, "inside_zone")]
    assert (stated["more_routes"], stated["more_targets"]) == (0, 0)
    (route,) = made["plan"]["routes"]
    explanation = stated["routes"][0]["explanation"]
    assert explanation["zones"] or not explanation["round_zones_m"]
    assert route["explanation"]["straight_m"] == pytest.approx(explanation["straight_m"], abs=1.0)
    assert route["explanation"]["more_m"] == pytest.approx(route["length_m"] - explanation["straight_m"], abs=1.0)
    assert client.get(f"/api/v1/missions/{made['id']}/explanation?target=0").json()["routes"] == []
    assert client.get(f"/api/v1/missions/{made['id']}/explanation?uav=0").json()["targets"] == []
    assert client.get(f"/api/v1/missions/{made['id']}/explanation?uav=a").status_code == 400


def test_a_route_that_can_no_longer_be_flown_says_so_in_its_mission(here: World, client: Client) -> None:
    made = post(client, "missions", mission_body(here.towers[5], plan=True)).json()
    zone_around((UAV_AT.lon, UAV_AT.lat))
    (route,) = client.get(f"/api/v1/missions/{made['id']}/explanation").json()["routes"]
    assert (route["explanation"], "no-fly zone" in route["fault"]) == (None, True)
    draft = post(client, "missions", mission_body(here.towers[5])).json()
    response = client.get(f"/api/v1/missions/{draft['id']}/explanation")
    assert (response.status_code, response.json()["error"]["code"]) == (409, "not_planned")
