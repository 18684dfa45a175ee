"""Plans that heed batteries, wind and airspeed."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from django.contrib.gis.gdal import GDALRaster

from inspection.geodesy import LonLat
from inspection.models import Asset
from inspection.services import import_terrain
from missions.services import TargetRequest, make_plan
from operation.reasons import Reason
from planning.energy.conditions import Conditions, WindLayer
from planning.energy.performance import Performance
from planning.explain.energy_shortfall import least_missing
from planning.plan import UnassignedTarget
from planning.problem import Objective, Priority
from planning.request import EndAction, UavRequest
from tests.inspection import ground
from tests.missions.worlds import island, power_line, rebuild, request, uav, world

pytestmark = pytest.mark.django_db

AT_THE_FIRST = (10.0, 55.9999)
AT_THE_LAST = (10.020, 55.9999)


def iris(position: tuple[float, float] = AT_THE_FIRST, *, battery_wh: float = 56.6, speed_mps: float = 8.0, **facts: Any) -> UavRequest:
    asked = uav(position, performance=Performance(battery_wh=battery_wh, max_airspeed_mps=11.0), **facts)
    return UavRequest(**(vars(asked) | {"cruise_speed_mps": speed_mps}))


def reasons(plan: dict[str, Any]) -> dict[int, str]:
    return {item["target"]: item["reason"] for item in plan["unassigned"]}


def test_the_battery_is_told_at_each_waypoint_and_in_total() -> None:
    here = world()
    plan = make_plan(request=request(here.towers[5], uavs=(iris(end_action=EndAction.RETURN),)))
    (route,) = plan["routes"]
    assert len(route["used_wh"]) == len(route["battery_left_percent"]) == len(route["waypoints"])
    assert route["used_wh"] == sorted(route["used_wh"])
    assert route["battery_left_percent"][-1] > route["battery_percent"] > 20.0
    assert plan["total_energy_wh"] == route["energy_wh"] == pytest.approx(56.6 * (1 - route["battery_percent"] / 100), abs=0.05)


def test_a_target_that_no_battery_reaches_is_refused_with_the_watt_hours_that_lack() -> None:
    here = world()
    enough = make_plan(request=request(here.towers[5], uavs=(iris(end_action=EndAction.RETURN),)))["total_energy_wh"]
    small = iris(battery_wh=enough / 0.8 - 1.0, end_action=EndAction.RETURN)
    plan = make_plan(request=request(here.towers[5], uavs=(small,)))
    assert reasons(plan) == {0: "beyond_energy"}
    assert "Wh" in plan["unassigned"][0]["message"]
    just = iris(battery_wh=enough / 0.8 + 0.05, end_action=EndAction.RETURN)
    assert reasons(make_plan(request=request(here.towers[5], uavs=(just,)))) == {}


def test_no_route_takes_more_than_the_usable_battery() -> None:
    here = world()
    for battery_wh in (4.0, 6.0, 8.0, 12.0):
        plan = make_plan(
            request=request(
                *here.towers, here.line, uavs=(iris(battery_wh=battery_wh), iris(AT_THE_LAST, name="Gull", battery_wh=battery_wh))
            )
        )
        assert all(route["energy_wh"] is None or route["energy_wh"] <= 0.8 * battery_wh for route in plan["routes"])
        assert all(route["battery_percent"] is None or route["battery_percent"] >= 20.0 for route in plan["routes"])


def test_head_wind_makes_the_way_there_longer_than_the_way_back() -> None:
    here = world()
    west = Conditions((WindLayer(60.0, 8.0, 90.0),))  # from the east: the way to the last tower is against it
    plan = make_plan(request=request(here.towers[5], uavs=(iris(speed_mps=8.0, end_action=EndAction.RETURN),), conditions=west))
    (route,) = plan["routes"]
    target = next(place for place, waypoint in enumerate(route["waypoints"]) if waypoint["kind"] == "target")
    out_s = route["arrival_s"][target] - route["arrival_s"][0]
    back_s = route["arrival_s"][-1] - route["arrival_s"][target] - 10.0
    assert out_s > 2.0 * back_s
    assert plan["conditions"]["wind"] == [{"altitude_agl_m": 60.0, "speed_mps": 8.0, "from_deg": 90.0}]


def test_a_wind_stronger_than_the_uav_can_fly_against_bars_the_way() -> None:
    here = world()
    storm = Conditions((WindLayer(60.0, 15.0, 90.0),))
    plan = make_plan(request=request(here.towers[5], uavs=(iris(),), conditions=storm))
    assert set(reasons(plan)) == {0}


def test_the_objectives_each_find_no_worse_a_plan_in_what_they_count() -> None:
    here = world()
    uavs = (iris(end_action=EndAction.RETURN), iris(AT_THE_LAST, name="Gull", speed_mps=5.0, end_action=EndAction.RETURN))
    wind = Conditions((WindLayer(60.0, 4.0, 200.0),))
    plans = {
        objective: make_plan(request=request(*here.towers, here.bridge, uavs=uavs, objective=objective, conditions=wind))
        for objective in Objective
    }
    counted = {
        Objective.TOTAL: lambda plan: plan["total_length_m"],
        Objective.MAKESPAN: lambda plan: max(route["duration_s"] for route in plan["routes"]),
        Objective.TIME: lambda plan: plan["total_duration_s"],
        Objective.ENERGY: lambda plan: plan["total_energy_wh"],
    }
    for objective, value in counted.items():
        assert plans[objective]["unassigned"] == []
        assert value(plans[objective]) <= min(value(plan) for plan in plans.values()) * 1.001 + 0.5
    assert plans[Objective.ENERGY]["lower_bound_wh"] <= plans[Objective.ENERGY]["total_energy_wh"]


def test_calm_air_and_no_battery_plan_as_ever() -> None:
    here = world()
    plan = make_plan(request=request(*here.towers, objective=Objective.MAKESPAN))
    reported = make_plan(request=request(*here.towers, objective=Objective.MAKESPAN, conditions=Conditions((WindLayer(60.0, 0.0, 0.0),))))
    assert plan["routes"][0]["targets"] == reported["routes"][0]["targets"]


def test_what_does_not_fit_in_one_flight_is_flown_in_several() -> None:
    here = world()
    home = {"end_action": EndAction.RETURN, "speed_mps": 8.0}
    one = make_plan(request=request(here.towers[5], uavs=(iris(**home),)))["total_energy_wh"]
    battery_wh = 1.15 * one / 0.8
    both = (here.towers[5], here.bridge, here.towers[0])
    once = make_plan(request=request(*both, uavs=(iris(battery_wh=battery_wh, **home),)))
    assert "beyond_energy" in reasons(once).values()
    plan = make_plan(request=request(*both, uavs=(iris(battery_wh=battery_wh, sorties=3, **home),)))
    assert plan["unassigned"] == []
    (route,) = plan["routes"]
    kinds = [waypoint["kind"] for waypoint in route["waypoints"]]
    stop = kinds.index("base")
    assert kinds[stop - 1 : stop + 2] == ["end", "base", "start"]
    assert route["waypoints"][stop]["altitude_agl_m"] == 0.0
    assert route["arrival_s"] == sorted(route["arrival_s"])
    assert route["arrival_s"][stop + 1] - route["arrival_s"][stop] > 600.0
    assert max(route["used_wh"]) <= 0.8 * battery_wh
    assert route["used_wh"][stop + 1] < route["used_wh"][stop]
    assert route["energy_wh"] > 0.8 * battery_wh
    assert min(route["battery_left_percent"]) >= 20.0
    assert sorted(route["targets"]) == [0, 1, 2]


def test_a_uav_that_charges_at_towers_flies_farther_than_its_battery() -> None:
    here = world()
    home = {"end_action": EndAction.RETURN}
    whole = make_plan(request=request(here.towers[5], uavs=(iris(**home),)))
    small = iris(battery_wh=0.6 * whole["total_energy_wh"] / 0.8, **home)
    assert reasons(make_plan(request=request(here.towers[5], uavs=(small,)))) == {0: "beyond_energy"}
    plan = make_plan(request=request(here.towers[5], uavs=(small,), charging_w=100.0))
    (route,) = plan["routes"]
    assert plan["unassigned"] == []
    (stop,) = route["charging"]
    assert route["waypoints"][stop["waypoint"]]["asset"] in {tower.pk for tower in here.towers}
    assert route["duration_s"] > whole["routes"][0]["duration_s"] + stop["charging_s"]
    assert min(route["battery_left_percent"]) >= 19.9


def test_what_cannot_be_charged_for_is_left_out_and_nothing_else() -> None:
    """Six places far from every tower, and all the towers, for which one battery does not last."""
    here = world()
    home = {"end_action": EndAction.RETURN}
    there = [TargetRequest(None, LonLat(10.001 + 0.001 * number, 55.975)) for number in range(6)]
    far = make_plan(request=request(there[0], uavs=(iris(**home),)))["total_energy_wh"]
    towers = make_plan(request=request(*here.towers, uavs=(iris(**home),)))["total_energy_wh"]
    small = iris(battery_wh=0.7 * min(far, towers) / 0.8, **home)
    plan = make_plan(request=request(*there, *here.towers, uavs=(small,), charging_w=300.0))
    assert reasons(plan) == dict.fromkeys(range(6), "beyond_energy")
    assert all(item["message"].startswith("Even with charging stops, Tern is up to ") for item in plan["unassigned"])
    assert all(" Wh short for this target: " in item["message"] for item in plan["unassigned"])
    assert sorted(plan["routes"][0]["targets"]) == [6, 7, 8, 9, 10, 11]
    assert plan["routes"][0]["charging"]
    assert plan["gap"] is None


def test_without_towers_on_the_way_charging_helps_nobody() -> None:
    here = world()
    small = iris((10.001, 55.95), battery_wh=4.0, end_action=EndAction.RETURN)
    plan = make_plan(request=request(here.towers[5], uavs=(small,), charging_w=100.0))
    assert reasons(plan) == {0: "beyond_energy"}


@pytest.mark.parametrize("charging_w", [None, 300.0])
def test_with_the_wh_that_are_missing_it_is_flown_and_with_less_it_is_not(charging_w: float | None) -> None:
    """A place 2.8 km from the line: on the way to it there is no tower to charge at."""
    world()
    there = TargetRequest(None, LonLat(10.001, 55.975))

    def plan(battery_wh: float) -> dict[str, Any]:
        return make_plan(request=request(there, uavs=(iris(battery_wh=battery_wh, end_action=EndAction.RETURN),), charging_w=charging_w))

    (item,) = plan(8.0)["unassigned"]
    missing_wh = item["why"][0]["params"]["missing_wh"]
    assert plan(8.0 + (missing_wh + 0.06) / 0.8)["unassigned"] == []
    assert reasons(plan(8.0 + (missing_wh - 0.06) / 0.8)) == {0: "beyond_energy"}
    assert ("Even with charging stops" in item["message"]) == (charging_w is not None)


def test_who_has_the_range_lacks_the_battery_though_others_lack_the_range() -> None:
    """Once the target is kept from the one that charges, the solver knows of nothing but the other one's range."""
    world()
    there = TargetRequest(None, LonLat(10.001, 55.975))
    uavs = (iris(battery_wh=8.0, end_action=EndAction.RETURN), uav(name="Gull", max_range_m=1_000.0, end_action=EndAction.RETURN))
    (item,) = make_plan(request=request(there, uavs=uavs, charging_w=300.0))["unassigned"]
    assert item["reason"] == "beyond_energy"
    assert item["message"].startswith("Even with charging stops, Tern is up to ")


def test_a_target_that_is_in_reach_alone_is_told_so_and_flown_when_it_comes_first() -> None:
    here = world()
    there = TargetRequest(None, LonLat(10.001, 55.985))
    alone_wh = make_plan(request=request(there, uavs=(iris(end_action=EndAction.RETURN),)))["total_energy_wh"]
    small = iris(battery_wh=(alone_wh + 0.1) / 0.8, end_action=EndAction.RETURN)
    (item,) = make_plan(request=request(*here.towers[:3], there, uavs=(small,)))["unassigned"]
    assert item["target"] == 3
    assert "on its own" in item["message"]
    first = TargetRequest(None, LonLat(10.001, 55.985), priority=Priority.HIGH)
    assert 3 not in reasons(make_plan(request=request(*here.towers[:3], first, uavs=(small,))))


def ridge(folder: Path) -> None:
    """80 m high and some 60 m wide between the third tower and the fourth, where the network has no node."""
    columns, rows = 400, 60
    heights = np.zeros((rows, columns), dtype=np.float32)
    heights[:, 199:202] = 80.0
    raster = GDALRaster(
        {
            "driver": "GTiff", "name": str(folder / "ridge.tif"), "srid": 4326, "width": columns, "height": rows,
            "origin": (9.97, 56.03), "scale": (0.0002, -0.001), "datatype": 6,
            "bands": [{"data": heights.tobytes(), "nodata_value": -9999.0}],
        }
    )  # fmt: skip
    raster._flush()
    import_terrain(path=folder / "ridge.tif", vertical_datum="EGM96")


@pytest.mark.long
def test_a_target_behind_a_ridge_is_refused_with_what_the_drawn_route_lacks(tmp_path: Path) -> None:
    """The network's nodes know nothing of the ridge: the search's own figures would say that next to nothing is missing."""
    here = world()
    ridge(tmp_path)
    least_wh = least_as_drawn_wh(here.towers[5])
    small = iris(battery_wh=(least_wh - 0.7) / 0.8, end_action=EndAction.RETURN)
    plan = make_plan(request=request(here.towers[5], uavs=(small,)))
    assert reasons(plan) == {0: "beyond_energy"}
    stated = f"it needs {least_wh:.1f} Wh there and back, 0.7 Wh more than the usable battery of Tern: 0.3 min of flight."
    assert plan["unassigned"][0]["message"] == f"Including terrain and obstacles {stated}"
    enough = iris(battery_wh=(least_wh + 0.1) / 0.8, end_action=EndAction.RETURN)
    assert make_plan(request=request(here.towers[5], uavs=(enough,)))["total_energy_wh"] == pytest.approx(least_wh, abs=0.1)


def least_as_drawn_wh(tower: Asset) -> float:
    """What the least route there and back takes as it is drawn, by what a UAV with far too small a battery is told."""
    tiny = iris(battery_wh=20.0, end_action=EndAction.RETURN)
    (item,) = make_plan(request=request(tower, uavs=(tiny,)))["unassigned"]
    return float(item["message"].split("needs ")[1].split(" Wh")[0])


def test_who_may_fly_again_takes_a_full_battery_and_charges_at_no_tower(tmp_path: Path) -> None:
    """Not even for what only the drawn route takes, over the ridge: what a refusal says to be missing counts on no charging, either."""
    here = world()
    ridge(tmp_path)
    small = iris(battery_wh=(least_as_drawn_wh(here.towers[5]) - 0.7) / 0.8, end_action=EndAction.RETURN, sorties=2)
    (item,) = make_plan(request=request(here.towers[5], uavs=(small,), charging_w=300.0))["unassigned"]
    assert item["message"].endswith("there and back, 0.7 Wh more than the usable battery of Tern: 0.3 min of flight.")


def test_what_is_missing_is_of_the_route_that_is_the_least_as_it_is_drawn() -> None:
    """Over another target it is longer, and round wires over which the straight way rises; the search counts no rises.

         there
    tower --|-- wire -- tower
      beside|
           UAV
    """
    world()
    power_line([ground.tower((lon, 55.9975), height_m=104.0) for lon in (9.997, 10.005)])
    rebuild()
    there, beside = TargetRequest(None, LonLat(9.9985, 55.9985)), TargetRequest(None, LonLat(9.9958, 55.9975))

    def plan(battery_wh: float, *targets: TargetRequest) -> dict[str, Any]:
        return make_plan(request=request(*targets, uavs=(iris((9.9985, 55.9965), battery_wh=battery_wh / 0.8),)))

    straight_wh, round_wh = (plan(40.0, *targets)["total_energy_wh"] for targets in ((there,), (beside, there)))
    assert round_wh < straight_wh - 0.5
    stated = next(item["message"] for item in plan(round_wh - 0.3, beside, there)["unassigned"] if item["target"] == 1)
    assert f"it needs {round_wh:.1f} Wh there, 0.3 Wh more" in stated


MID_WAY = (10.16, 56.0)  # from here a UAV reaches the line of the world, or the island; from the one to the other it does not


@pytest.mark.parametrize("max_range_m", [None, 20_000.0])
def test_what_a_uav_without_a_battery_could_do_alone_lacks_no_battery(max_range_m: float | None) -> None:
    here, far = world(), island()
    gull = uav(MID_WAY, name="Gull", max_range_m=max_range_m)
    plan = make_plan(request=request(here.towers[2], far[0], uavs=(gull, iris(battery_wh=1.0))))
    (item,) = plan["unassigned"]
    assert [len(route["targets"]) for route in plan["routes"]] == [1, 0]
    assert item["reason"] == ("no_path" if max_range_m is None else "beyond_range")
    assert "Wh" not in item["message"]


def test_what_is_not_on_one_route_with_others_is_not_put_down_to_the_wind() -> None:
    here, far = world(), island()
    breeze = Conditions((WindLayer(10.0, 2.0, 200.0),), 10.0)
    (item,) = make_plan(request=request(here.towers[2], far[0], uavs=(uav(MID_WAY),), conditions=breeze))["unassigned"]
    assert (item["reason"], "not on one route" in item["message"]) == ("no_path", True)


def test_what_can_be_done_alone_on_other_ways_is_told_so() -> None:
    by_battery = UnassignedTarget(0, "beyond_energy", (Reason("beyond_battery"),), 9.0)
    alone = UnassignedTarget(0, "beyond_range", (Reason("in_range_alone"),), 0.0)
    assert least_missing([by_battery], [alone], {}) == least_missing([alone], [by_battery], {}) == [alone]


def test_what_another_plan_flies_is_within_reach_alone() -> None:
    left_out = UnassignedTarget(0, "beyond_range", (Reason("beyond_range"),), 1_000.0)
    (reported,) = least_missing([left_out], [], {0: uav(max_range_m=9_000.0)})
    assert (reported.reason, reported.missing, reported.why) == ("beyond_range", 0.0, (Reason("in_range_alone"),))
    assert least_missing([left_out], [], {1: uav()}) == [left_out]


def test_of_targets_that_are_come_to_one_from_the_other_the_farther_is_left_out_if_charging_does_not_suffice() -> None:
    """18 km from the line and 3.7 km from one to the next, of which a UAV flies 5 km at most away from it."""
    world()
    near, far = (TargetRequest(None, LonLat(lon, 56.0)) for lon in (10.41, 10.47))
    small = iris((10.35, 56.0), battery_wh=30.0, speed_mps=12.0)
    plan = make_plan(request=request(near, far, uavs=(small,), charging_w=100.0))
    assert reasons(plan).keys() == {1}
    assert plan["routes"][0]["targets"] == [0]
