"""Routes changed by hand: what may be, what is refused, what is kept, and how it is taken back."""

from typing import Any

import pytest
from django.test import Client

from inspection.models import NoFlyZone
from missions.models import Waypoint
from tests.accounts.users import a_user, client_of
from tests.inspection import ground
from tests.missions.api import mission_body, patch, post
from tests.missions.plane import apart_m
from tests.missions.worlds import World, power_line, rebuild, zone_around

pytestmark = pytest.mark.django_db


@pytest.fixture
def client() -> Client:
    return client_of(a_user())


def error_of(response: Any, status: int) -> dict[str, Any]:
    assert response.status_code == status, response.content
    error: dict[str, Any] = response.json()["error"]
    return error


def planned(here: World, client: Client) -> dict[str, Any]:
    return post(client, "missions", mission_body(here.towers[3], here.towers[5]) | {"plan": True}).json()


def as_wished(mission: dict[str, Any]) -> list[dict[str, Any]]:
    waypoints = mission["plan"]["routes"][0]["waypoints"]
    return [
        {"position": waypoint["position"], "altitude_agl_m": waypoint["altitude_agl_m"], "was": number}
        for number, waypoint in enumerate(waypoints)
    ]


def put(client: Client, mission: dict[str, Any], waypoints: list[dict[str, Any]]) -> Any:
    return client.put(
        f"/api/v1/missions/{mission['id']}/routes/0/waypoints",
        {"waypoints": waypoints},
        content_type="application/json",
        HTTP_IF_MATCH=f'"{mission["revision"]}"',
    )


def test_a_waypoint_put_in_makes_the_route_longer_and_is_by_hand(here: World, client: Client) -> None:
    mission = planned(here, client)
    wished = as_wished(mission)
    wished.insert(1, {"position": [10.003, 55.9935], "altitude_agl_m": 70.0, "was": None})
    changed = put(client, mission, wished).json()
    (route,) = changed["plan"]["routes"]
    assert route["length_m"] > mission["plan"]["routes"][0]["length_m"] + 100
    assert changed["plan"]["total_length_m"] == pytest.approx(route["length_m"])
    assert [route["waypoints"][place]["position"] for place in route["by_hand"]] == [[10.003, 55.9935]]
    assert route["targets"] == mission["plan"]["routes"][0]["targets"]
    assert len(route["arrival_s"]) == len(route["waypoints"])
    assert changed["plan"]["is_proven"] is False
    assert changed["revision"] == mission["revision"] + 1


def test_the_same_waypoints_change_nothing_but_the_revision(here: World, client: Client) -> None:
    mission = planned(here, client)
    changed = put(client, mission, as_wished(mission)).json()
    before, after = (found["plan"]["routes"][0] for found in (mission, changed))
    assert after["waypoints"] == before["waypoints"]
    assert after["length_m"] == pytest.approx(before["length_m"], abs=0.01)


def test_a_leg_into_a_zone_is_refused_and_nothing_is_kept(here: World, client: Client) -> None:
    mission = planned(here, client)
    zone_around((10.003, 55.9935), 0.0005, name="Hospital")
    wished = as_wished(mission)
    wished.insert(1, {"position": [10.003, 55.9935], "altitude_agl_m": 70.0, "was": None})
    faults = error_of(put(client, mission, wished), 400)["details"]
    assert any(place.startswith("legs.") and "Hospital" in str(fault) for place, fault in faults.items())
    assert Waypoint.objects.filter(is_by_hand=True).count() == 0


@pytest.mark.parametrize(("height_m", "words"), [(90.0, "fly at 105 m above ground"), (110.0, "cannot be flown over below 120 m")])
def test_a_leg_over_wires_is_refused_below_their_height(here: World, client: Client, height_m: float, words: str) -> None:
    """Wires between two towers 190 m to the left and right of the leg."""
    power_line([ground.tower((lon, 55.9942), height_m=height_m) for lon in (9.999, 10.005)])
    rebuild()
    mission = planned(here, client)
    wished = as_wished(mission)
    wished.insert(1, {"position": [10.003, 55.9935], "altitude_agl_m": 70.0, "was": None})
    faults = error_of(put(client, mission, wished), 400)["details"]
    assert set(faults) == {"legs.0", "legs.1"}
    assert words in str(faults["legs.0"])


def test_a_route_that_rises_over_wires_can_be_kept_as_it_is(here: World, client: Client) -> None:
    power_line([ground.tower((lon, 55.997), height_m=90.0) for lon in (9.995, 10.02)])
    rebuild()
    mission = planned(here, client)
    assert max(waypoint["altitude_agl_m"] for waypoint in mission["plan"]["routes"][0]["waypoints"]) == 105.0
    changed = put(client, mission, as_wished(mission)).json()
    assert changed["plan"]["routes"][0]["waypoints"] == mission["plan"]["routes"][0]["waypoints"]


@pytest.mark.parametrize("altitude_m", [20.0, 130.0])
def test_a_waypoint_too_low_or_too_high_is_refused(here: World, client: Client, altitude_m: float) -> None:
    mission = planned(here, client)
    wished = as_wished(mission)
    wished[1]["altitude_agl_m"] = altitude_m
    assert "waypoints.1.altitude_agl_m" in error_of(put(client, mission, wished), 400)["details"]


def test_targets_can_neither_be_taken_out_nor_swapped_nor_moved(here: World, client: Client) -> None:
    mission = planned(here, client)
    whole = as_wished(mission)
    target = next(number for number, waypoint in enumerate(mission["plan"]["routes"][0]["waypoints"]) if waypoint["kind"] == "target")
    without = [point for point in whole if point["was"] != target]
    swapped = whole[:1] + whole[1:-1][::-1] + whole[-1:]
    for wished in (without, swapped):
        assert "waypoints" in error_of(put(client, mission, wished), 400)["details"]
    whole[target]["position"] = [whole[target]["position"][0] + 0.001, 56.0]
    assert f"waypoints.{target}.position" in error_of(put(client, mission, whole), 400)["details"]


def test_who_has_seen_an_older_mission_changes_nothing(here: World, client: Client) -> None:
    mission = planned(here, client)
    assert put(client, mission, as_wished(mission)).status_code == 200
    assert put(client, mission, as_wished(mission)).status_code == 412


def test_a_dragged_leg_is_told_what_it_meets(here: World, client: Client) -> None:
    zone = zone_around((10.003, 55.9935), 0.0005, name="Hospital")
    NoFlyZone.objects.filter(pk=zone.pk).update(lower_limit_m=100.0, lower_reference="AGL")
    zone_around((0.0, 0.0), 0.0001)

    def leg(altitude_agl_m: float) -> dict[str, Any]:
        ends = ([10.000, 55.9935], [10.006, 55.9935])
        start, end = ({"position": position, "altitude_agl_m": altitude_agl_m, "arrival_s": 0.0} for position in ends)
        return {"start": start, "end": end}

    under, through, above = post(client, "leg-checks", {"legs": [leg(60.0), leg(110.0), leg(125.0)]}).json()["legs"]
    assert under == {"is_clear": True, "zone": None, "message": ""}
    assert (through["is_clear"], through["zone"]) == (False, zone.pk)
    assert "Hospital" in through["message"]
    assert (above["is_clear"], above["zone"]) == (False, None)


@pytest.mark.parametrize(("height_m", "words"), [(90.0, "fly at 105 m above ground"), (110.0, "cannot be flown over below 120 m")])
def test_a_dragged_leg_over_wires_is_told_how_high_to_fly(here: World, client: Client, height_m: float, words: str) -> None:
    power_line([ground.tower((lon, 55.9942), height_m=height_m) for lon in (9.999, 10.005)])
    rebuild()

    def leg(north: float) -> dict[str, Any]:
        ends = ([10.002, 55.9935], [10.002, north])
        start, end = ({"position": position, "altitude_agl_m": 70.0, "arrival_s": 0.0} for position in ends)
        return {"start": start, "end": end}

    short, over = post(client, "leg-checks", {"legs": [leg(55.9938), leg(55.995)]}).json()["legs"]
    assert short["is_clear"]
    assert not over["is_clear"]
    assert words in over["message"]


def planned_with(here: World, client: Client, **wishes: Any) -> dict[str, Any]:
    """One UAV of 12 m/s that may fly 14 m/s through the air, with a battery."""
    body = mission_body(here.towers[3], here.towers[5]) | {"plan": True} | wishes
    body["uavs"] = [uav | {"max_airspeed_mps": 14.0, "battery_wh": 100.0, "cruise_speed_mps": 12.0} for uav in body["uavs"]]
    return post(client, "missions", body).json()


def longest_leg(mission: dict[str, Any], before: int | None = None) -> int:
    """The waypoint to which the longest leg leads, by its time, of all legs or of those to waypoints before one."""
    arrival_s = mission["plan"]["routes"][0]["arrival_s"][:before]
    return max(range(1, len(arrival_s)), key=lambda place: arrival_s[place] - arrival_s[place - 1])


def test_a_speed_over_one_leg_counts_into_all_times_and_the_battery_and_is_stored(here: World, client: Client) -> None:
    mission = planned_with(here, client)
    place, wished = longest_leg(mission), as_wished(mission)
    wished[place]["speed_mps"] = 6.0
    changed = put(client, mission, wished).json()
    before, after = (found["plan"]["routes"][0] for found in (mission, changed))
    assert after["arrival_s"][:place] == before["arrival_s"][:place]
    later_s = after["arrival_s"][place] - before["arrival_s"][place]
    half_s = apart_m(wished[place - 1]["position"], wished[place]["position"]) / 12.0  # as much again at half the speed
    assert half_s - 3.0 <= later_s <= half_s + 0.2  # a turn from 6 m/s takes up to 1.5 s less than one from 12 m/s, at either end
    speeding_up_s = after["duration_s"] - before["duration_s"] - later_s  # on the next leg, from 6 to 12 m/s by 2 m/s2: 0.75 s at most
    assert -0.2 <= speeding_up_s <= 0.95
    assert after["energy_wh"] > before["energy_wh"]
    assert after["speeds_by_hand"] == [{"waypoint": place, "speed_mps": 6.0}]
    assert place in after["by_hand"]
    copy = post(client, f"missions/{mission['id']}/duplicate", {}).json()
    assert copy["plan"]["routes"][0]["speeds_by_hand"] == after["speeds_by_hand"]


@pytest.mark.parametrize("speed_mps", [0.2, 15.0])
def test_a_speed_that_cannot_be_flown_is_refused_at_its_waypoint(here: World, client: Client, speed_mps: float) -> None:
    mission = planned_with(here, client)
    place, wished = longest_leg(mission), as_wished(mission)
    wished[place]["speed_mps"] = speed_mps
    faults = error_of(put(client, mission, wished), 400)["details"]
    assert set(faults) == {f"waypoints.{place}.speed_mps"}
    leg = {"start": wished[place - 1] | {"arrival_s": 0}, "end": wished[place] | {"arrival_s": 60}, "speed_mps": speed_mps}
    for end in ("start", "end"):
        leg[end] = {name: leg[end][name] for name in ("position", "altitude_agl_m", "arrival_s")}
    (reported,) = post(client, "leg-checks", {"legs": [leg], "mission": mission["id"], "uav": 0}).json()["legs"]
    assert reported == {"is_clear": False, "zone": None, "message": faults[f"waypoints.{place}.speed_mps"][0]}


def test_against_the_wind_less_may_be_wished(here: World, client: Client) -> None:
    wind = {"wind": [{"altitude_agl_m": 50, "speed_mps": 6, "from_deg": heading} for heading in (90,)], "temperature_c": 15}
    mission = planned_with(here, client, conditions=wind)
    ways = mission["plan"]["routes"][0]["waypoints"]
    easts = [ways[place]["position"][0] - ways[place - 1]["position"][0] for place in range(1, len(ways))]
    against = max(range(len(easts)), key=easts.__getitem__) + 1
    wished = as_wished(mission)
    wished[against]["speed_mps"] = 11.0  # 14 m/s through the air leave some 8 m/s
    assert f"waypoints.{against}.speed_mps" in error_of(put(client, mission, wished), 400)["details"]
    wished[against]["speed_mps"] = 7.0
    assert put(client, mission, wished).status_code == 200


def test_no_speed_where_no_leg_leads(here: World, client: Client) -> None:
    mission = planned_with(here, client)
    wished = as_wished(mission)
    wished[0]["speed_mps"] = 6.0
    assert "waypoints.0.speed_mps" in error_of(put(client, mission, wished), 400)["details"]


def test_a_speed_is_checked_for_a_uav_of_a_mission_alone(client: Client, here: World) -> None:
    end = {"position": [10.0, 55.9935], "altitude_agl_m": 60.0}
    answer = post(client, "leg-checks", {"legs": [{"start": end, "end": end, "speed_mps": 6.0}]})
    assert set(error_of(answer, 400)["details"]) == {"mission", "uav"}


def undo(client: Client, mission: dict[str, Any]) -> Any:
    return client.post(f"/api/v1/missions/{mission['id']}/routes/0/waypoints/undo", HTTP_IF_MATCH=f'"{mission["revision"]}"')


def test_changes_are_taken_back_one_by_one_until_the_route_is_as_planned(here: World, client: Client) -> None:
    mission = planned_with(here, client)
    wished = as_wished(mission)
    wished.insert(1, {"position": [10.003, 55.9935], "altitude_agl_m": 70.0, "was": None})
    first = put(client, mission, wished).json()
    slower = as_wished(first)
    slower[longest_leg(first)]["speed_mps"] = 6.0
    second = put(client, first, slower).json()
    assert [found["plan"]["routes"][0]["hand_steps"] for found in (mission, first, second)] == [0, 1, 2]
    back = undo(client, second).json()
    assert without_steps(back) == without_steps(first)
    again = undo(client, back).json()
    assert without_steps(again) == without_steps(mission)
    assert {name: again["plan"][name] for name in ("is_proven", "gap", "method")} == {
        name: mission["plan"][name] for name in ("is_proven", "gap", "method")
    }
    assert error_of(undo(client, again), 400)["details"] == {"uav": ["No change by hand of this route can be taken back."]}


def without_steps(mission: dict[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in mission["plan"]["routes"][0].items() if name != "hand_steps"}


def test_a_change_is_not_taken_back_into_a_zone(here: World, client: Client) -> None:
    mission = planned(here, client)
    wished = as_wished(mission)
    wished.insert(1, {"position": [10.003, 55.9935], "altitude_agl_m": 70.0, "was": None})
    first = put(client, mission, wished).json()
    without = [point for point in as_wished(first) if point["position"] != [10.003, 55.9935]]
    second = put(client, first, without).json()
    zone_around((10.003, 55.9935), 0.0005, name="Hospital")
    faults = error_of(undo(client, second), 400)["details"]
    assert any("Hospital" in str(fault) for fault in faults.values())


def test_planning_again_ends_what_can_be_taken_back(here: World, client: Client) -> None:
    mission = planned(here, client)
    changed = put(client, mission, as_wished(mission)).json()
    again = client.post(f"/api/v1/missions/{mission['id']}/plan", HTTP_IF_MATCH=f'"{changed["revision"]}"').json()
    assert again["plan"]["routes"][0]["hand_steps"] == 0


PUT_IN = [10.003, 55.9935]


def with_one_put_in(mission: dict[str, Any]) -> list[dict[str, Any]]:
    wished = as_wished(mission)
    wished.insert(1, {"position": PUT_IN, "altitude_agl_m": 70.0, "was": None})
    return wished


def plan_again(client: Client, mission: dict[str, Any]) -> dict[str, Any]:
    return client.post(f"/api/v1/missions/{mission['id']}/plan", HTTP_IF_MATCH=f'"{mission["revision"]}"').json()


def by_hand(mission: dict[str, Any]) -> list[Any]:
    (route,) = mission["plan"]["routes"]
    return [route["waypoints"][place]["position"] for place in route["by_hand"]]


def test_planned_again_a_route_keeps_what_a_hand_put_in_and_can_go_back_to_the_plan(here: World, client: Client) -> None:
    mission = planned(here, client)
    changed = put(client, mission, with_one_put_in(mission)).json()
    again = plan_again(client, changed)
    assert by_hand(again) == [PUT_IN]
    assert again["plan"]["warnings"] == []
    assert (again["plan"]["is_proven"], again["plan"]["method"]) == (False, "by hand")
    assert again["plan"]["total_length_m"] == pytest.approx(changed["plan"]["total_length_m"])
    assert "by_hand" not in again["last_plan"]
    (route,) = again["plan"]["routes"]
    assert route["hand_steps"] == 1
    back = undo(client, again).json()
    assert without_steps(back) == without_steps(mission)
    assert back["plan"]["is_proven"]
    assert by_hand(plan_again(client, back)) == []


def test_with_another_target_the_leg_by_hand_stays_where_its_ends_do(here: World, client: Client) -> None:
    mission = planned(here, client)
    changed = put(client, mission, with_one_put_in(mission)).json()

    def with_targets(*assets: Any) -> dict[str, Any]:
        body = {"targets": mission_body(*assets)["targets"], "plan": True}
        return patch(client, f"missions/{mission['id']}", body).json()

    more = with_targets(here.towers[5], here.towers[4], here.towers[3])
    assert by_hand(more) == [PUT_IN]
    assert len(more["plan"]["routes"][0]["targets"]) == 3
    other = with_targets(here.towers[0], here.towers[5])
    assert by_hand(other) == []
    (warning,) = other["plan"]["warnings"]
    assert (warning["code"], warning["uav"]) == ("by_hand_not_kept", 0)
    assert warning["message"].startswith("1 of 1 manually edited legs of Tern were discarded")
    assert changed["plan"]["warnings"] == []


def test_what_a_zone_bars_by_now_is_planned_and_the_rest_by_hand_stays(here: World, client: Client) -> None:
    mission = planned(here, client)
    wished = with_one_put_in(mission)
    kinds = [None, *(point["kind"] for point in mission["plan"]["routes"][0]["waypoints"])]
    last = max(place for place, kind in enumerate(kinds) if kind == "target")
    wished.insert(last, {"position": [10.018, 55.997], "altitude_agl_m": 70.0, "was": None})
    changed = put(client, mission, wished).json()
    assert len(by_hand(changed)) == 2
    zone_around((10.003, 55.9935), 0.0005, name="Hospital")
    again = plan_again(client, changed)
    assert by_hand(again) == [[10.018, 55.997]]
    assert [warning["code"] for warning in again["plan"]["warnings"]] == ["by_hand_not_kept"]


def test_a_height_and_a_speed_by_hand_stay(here: World, client: Client) -> None:
    mission = planned_with(here, client)
    wished = as_wished(mission)
    target = next(place for place, point in enumerate(mission["plan"]["routes"][0]["waypoints"]) if point["kind"] == "target")
    wished[target]["altitude_agl_m"] += 20.0
    wished[longest_leg(mission)]["speed_mps"] = 6.0
    changed = put(client, mission, wished).json()
    again = plan_again(client, changed)
    assert without_steps(again) == without_steps(changed)
    assert again["plan"]["routes"][0]["speeds_by_hand"]


def test_a_waypoint_that_was_taken_out_stays_out(here: World, client: Client) -> None:
    mission = planned(here, client)
    kinds = [waypoint["kind"] for waypoint in mission["plan"]["routes"][0]["waypoints"]]
    changed = put(client, mission, [point for point, kind in zip(as_wished(mission), kinds, strict=True) if kind != "pass"]).json()
    assert plan_again(client, changed)["plan"]["total_length_m"] == changed["plan"]["total_length_m"] < mission["plan"]["total_length_m"]


def test_from_where_a_lost_link_goes_wrong_is_told_of_the_changed_route(here: World, client: Client) -> None:
    """South of the start a zone, and behind it a new waypoint, which is reached round it: from there nobody returns straight."""
    mission = planned_with(here, client, lost_link={"behaviour": "return"})
    assert mission["plan"]["lost_link"]["failed"] == []
    zone_around((10.001, 55.9925), 0.0002, name="Hospital")
    wished = as_wished(mission)
    for position in ([10.0081, 55.9925], [10.001, 55.99], [10.008, 55.9925]):
        wished.insert(1, {"position": position, "altitude_agl_m": 70.0, "was": None})
    changed = put(client, mission, wished).json()
    failed = changed["plan"]["lost_link"]["failed"]
    (behind,) = [place for place, point in enumerate(as_wished(changed)) if point["position"] == [10.001, 55.99]]
    assert {(one["route"], one["zone"]) for one in failed} == {(0, "Hospital")}
    assert behind in {one["waypoint"] for one in failed}
    assert undo(client, changed).json()["plan"]["lost_link"]["failed"] == []


def test_a_route_of_which_points_were_only_taken_out_is_not_proven(here: World, client: Client) -> None:
    mission = planned(here, client)
    kinds = [waypoint["kind"] for waypoint in mission["plan"]["routes"][0]["waypoints"]]
    changed = put(client, mission, [point for point, kind in zip(as_wished(mission), kinds, strict=True) if kind != "pass"]).json()
    assert changed["plan"]["total_length_m"] < mission["plan"]["total_length_m"]
    assert (mission["plan"]["is_proven"], changed["plan"]["is_proven"]) == (True, False)


def test_the_range_is_of_each_flight_of_a_route(here: World, client: Client) -> None:
    body = mission_body(here.towers[0], here.towers[5], return_to_start=True) | {"plan": True}
    body["uavs"] = [{"name": "Tern", "position": [10.010, 55.995], "max_range_m": 1_900.0, "sorties": 4, "end_action": "return"}]
    mission = post(client, "missions", body).json()
    assert mission["plan"]["routes"][0]["length_m"] > 1_900.0
    assert put(client, mission, as_wished(mission)).status_code == 200


def test_a_stretch_within_one_span_is_flown_over_its_wires_and_not_put_lower(here: World, client: Client) -> None:
    """The towers at its ends are 90 m tall, and none of them is a vertex of it."""
    line = power_line([ground.tower((lon, 55.998), height_m=90.0) for lon in (10.006, 10.011)], voltages_v=[110_000])
    rebuild()
    mission = post(
        client, "missions", mission_body({"asset": line.pk, "stretch": [[10.008, 55.998], [10.009, 55.998]]}) | {"plan": True}
    ).json()
    own = [waypoint["altitude_agl_m"] for waypoint in mission["plan"]["routes"][0]["waypoints"] if waypoint["kind"] == "target"]
    assert own and min(own) == 105.0
    lower = [point | {"altitude_agl_m": min(point["altitude_agl_m"], 70.0)} for point in as_wished(mission)]
    assert error_of(put(client, mission, lower), 400)


def test_a_tower_of_the_highest_voltages_is_not_inspected_lower_by_hand(here: World, client: Client) -> None:
    """No height is tagged: 60 m by its line's voltage, and 15 m above it."""
    towers = [ground.tower((lon, 55.998)) for lon in (10.006, 10.011)]
    power_line(towers, voltages_v=[380_000])
    rebuild()
    mission = post(client, "missions", mission_body(towers[0]) | {"plan": True}).json()
    lower = [point | {"altitude_agl_m": min(point["altitude_agl_m"], 62.0)} for point in as_wished(mission)]
    assert "Between 75 and" in str(error_of(put(client, mission, lower), 400))


def test_of_two_legs_over_a_wire_the_one_that_is_too_low_is_told_of(here: World, client: Client) -> None:
    """Wires at 80 m: the first leg crosses them at 70 m, the second comes back 1 m short of the clearance, as rounding may have it."""
    power_line([ground.tower((lon, 55.9975), height_m=80.0) for lon in (10.001, 10.004)], voltages_v=[110_000])
    rebuild()
    mission = post(client, "missions", mission_body(here.bridge) | {"plan": True}).json()
    wished = as_wished(mission)
    over = [(55.9965, 70.0), (55.9985, 70.0), (55.9985, 94.0), (55.9965, 94.0), (55.9965, 70.0)]
    wished[1:1] = [{"position": [10.0025, lat], "altitude_agl_m": agl_m, "was": None} for lat, agl_m in over]
    assert {place for place in error_of(put(client, mission, wished), 400)["details"] if int(place.split(".")[1]) < 5} == {"legs.1"}
