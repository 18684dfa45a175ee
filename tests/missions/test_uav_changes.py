"""A mission keeps the figures of its UAVs: what has become of the UAVs since is said, and taken over when somebody asks for it."""

from typing import Any

import pytest
from django.core.cache import cache
from django.test import Client
from django.utils.translation import override

from missions.models import Mission, MissionState, MissionUav, Uav, UavState, UavType
from tests.accounts.users import a_user, client_of
from tests.missions.api import mission_body, patch, plan_body, post
from tests.missions.worlds import UAV_AT, World

pytestmark = pytest.mark.django_db

IRIS = {"battery_wh": 56.6, "mass_kg": 1.545, "cruise_speed_mps": 10.0, "max_airspeed_mps": 11.0, "sensors": ["Thermal"]}


@pytest.fixture(autouse=True)
def empty_cache() -> None:
    cache.clear()


@pytest.fixture
def client() -> Client:
    return client_of(a_user())


@pytest.fixture
def iris(client: Client) -> int:
    return int(post(client, "uav-types", {"name": "Iris"} | IRIS).json()["id"])


@pytest.fixture
def kite(client: Client, iris: int) -> int:
    return int(post(client, "uavs", {"name": "Kite", "position": list(UAV_AT), "type": iris}).json()["id"])


def made(client: Client, here: World, *uavs: dict[str, Any], plan: bool = True, **more: Any) -> dict[str, Any]:
    response = post(client, "missions", mission_body(here.towers[2], uavs=list(uavs), plan=plan) | more)
    assert response.status_code == 201, response.content
    found: dict[str, Any] = response.json()
    return found


def change(client: Client, uav: int, values: dict[str, Any]) -> None:
    response = patch(client, f"uavs/{uav}", values, **{"If-Match": "*"})
    assert response.status_code == 200, response.content


def now(client: Client, mission: dict[str, Any]) -> dict[str, Any]:
    found: dict[str, Any] = client.get(f"/api/v1/missions/{mission['id']}").json()
    listed = next(row for row in client.get("/api/v1/missions").json()["results"] if row["id"] == mission["id"])
    filtered = [row["id"] for row in client.get("/api/v1/missions?stale=true").json()["results"]]
    assert listed["is_stale"] == found["is_stale"] == (mission["id"] in filtered)
    assert listed["has_other_uavs"] == any(cause["what"] == "uav" for cause in found["stale_causes"])
    return found


def figures(mission: dict[str, Any]) -> dict[str, tuple[Any, Any]]:
    return {figure["name"]: (figure["kept"], figure["now"]) for change in mission["uav_changes"] for figure in change["figures"]}


def test_a_battery_that_has_shrunk_makes_a_planned_mission_stale_and_says_by_how_much(here: World, client: Client, kite: int) -> None:
    mission = made(client, here, {"id": kite})
    assert (mission["is_stale"], mission["uav_changes"]) == (False, [])
    change(client, kite, {"battery_wh": 40.0, "mass_kg": 1.4})
    found = now(client, mission)
    assert figures(found) == {"battery_wh": (56.6, 40.0), "mass_kg": (1.545, 1.4)}
    assert found["stale_reason"] == "A UAV changed since this was planned. Kite: battery 56.6 → 40 Wh, mass 1.545 → 1.4 kg."
    assert [(cause["what"], cause["uav"]) for cause in found["stale_causes"]] == [("uav", 0)]
    assert (found["revision"], found["uavs"][0]["battery_wh"]) == (mission["revision"], 56.6)  # nothing is changed behind anybody's back


def test_a_type_that_has_changed_is_said_of_its_uavs_in_the_readers_language(here: World, client: Client, kite: int, iris: int) -> None:
    mission = made(client, here, {"id": kite})
    UavType.objects.filter(pk=iris).update(cruise_speed_mps=8.5, max_range_m=12_000.0, reserve_percent=25.0, max_airspeed_mps=None)
    words = "Kite: range not stated → 12 km, speed 10 → 8.5 m/s, reserve 20 → 25 %, highest airspeed 11 → not stated."
    assert [change["message"] for change in now(client, mission)["uav_changes"]] == [words]
    with override("de"):
        german = client.get(f"/api/v1/missions/{mission['id']}", headers={"Accept-Language": "de"}).json()
    assert "8,5 m/s" in german["uav_changes"][0]["message"]


def test_the_present_figures_are_taken_and_the_plan_goes(here: World, client: Client, kite: int) -> None:
    mission = made(client, here, {"id": kite, "most_targets": 3})
    change(client, kite, {"battery_wh": 40.0, "mass_kg": 1.4})
    assert patch(client, f"missions/{mission['id']}", {"uavs": [{"id": kite, "most_targets": 3}]}).status_code == 200
    found = now(client, mission)
    assert (found["state"], found["uav_changes"], found["uavs"][0]["battery_wh"]) == ("draft", [], 40.0)


def test_a_draft_says_it_too_and_is_not_stale(here: World, client: Client, kite: int) -> None:
    mission = made(client, here, {"id": kite}, plan=False)
    change(client, kite, {"cruise_speed_mps": 9.0, "state": "maintenance"})
    found = now(client, mission)
    assert (figures(found), found["uav_changes"][0]["state"], found["is_stale"]) == ({"cruise_speed_mps": (10.0, 9.0)}, None, False)


@pytest.mark.parametrize("state", [UavState.MAINTENANCE, UavState.RETIRED])
def test_a_planned_uav_that_no_longer_flies_is_said_until_it_is_planned_without_it(
    here: World, client: Client, kite: int, state: UavState
) -> None:
    mission = made(client, here, {"id": kite}, {"name": "Tern", "position": list(UAV_AT)})
    change(client, kite, {"state": state})
    found = now(client, mission)
    assert [(change["state"], change["figures"]) for change in found["uav_changes"]] == [(state, [])]
    assert found["is_stale"]
    post(client, f"missions/{mission['id']}/plan")
    assert not now(client, mission)["is_stale"]
    change(client, kite, {"state": "active"})
    assert now(client, mission)["uav_changes"][0]["message"] == "Kite: flies again, and the plan leaves it on the ground."


def test_figures_of_this_mission_alone_are_its_own_whatever_becomes_of_the_uav(here: World, client: Client, kite: int) -> None:
    stated = made(client, here, {"id": kite, "cruise_speed_mps": 7.0}, name="Slow")
    as_it_is = made(client, here, {"id": kite, "cruise_speed_mps": 10.0}, name="As it is")
    assert [mission["uavs"][0]["own_figures"] for mission in (stated, as_it_is)] == [["cruise_speed_mps"], []]
    change(client, kite, {"cruise_speed_mps": 9.0})
    assert figures(now(client, stated)) == {}
    assert figures(now(client, as_it_is)) == {"cruise_speed_mps": (10.0, 9.0)}


def test_a_figure_of_this_mission_alone_is_told_when_the_fleets_changes(here: World, client: Client, kite: int) -> None:
    """The plan stands all the same; and sent again as it was, it is not said anew."""
    mission = made(client, here, {"id": kite, "cruise_speed_mps": 7.0}, plan=True)
    assert now(client, mission)["uav_changes"] == []
    change(client, kite, {"cruise_speed_mps": 9.0})
    found = now(client, mission)
    reported = [{"name": "cruise_speed_mps", "said": 7.0, "then": 10.0, "now": 9.0}]
    assert [(change["said"], change["figures"]) for change in found["uav_changes"]] == [(reported, [])]
    assert found["uav_changes"][0]["message"] == "Kite: speed 10 → 9 m/s in the fleet, but not in this mission."
    assert (found["is_stale"], found["stale_causes"]) == (False, [])
    patch(client, f"missions/{mission['id']}", {"uavs": found["uavs"]})
    assert [change["said"] for change in now(client, mission)["uav_changes"]] == [reported]
    copy = post(client, f"missions/{mission['id']}/duplicate").json()
    assert [change["said"] for change in copy["uav_changes"]] == [reported]


def test_a_figure_that_is_said_anew_or_as_in_the_fleet_by_now_is_not_told(here: World, client: Client, kite: int) -> None:
    mission = made(client, here, {"id": kite, "cruise_speed_mps": 7.0})
    change(client, kite, {"cruise_speed_mps": 9.0})
    patch(client, f"missions/{mission['id']}", {"uavs": [{"id": kite, "cruise_speed_mps": 6.0}]})
    assert now(client, mission)["uav_changes"] == []
    change(client, kite, {"cruise_speed_mps": 6.0})
    assert now(client, mission)["uav_changes"] == []


def test_a_page_that_sends_the_kept_figures_again_does_not_make_them_its_own(here: World, client: Client, kite: int) -> None:
    """What "undo" sends after the present figures were taken: the notice is back."""
    mission = made(client, here, {"id": kite})
    change(client, kite, {"battery_wh": 40.0, "mass_kg": 1.545})
    before = now(client, mission)["uavs"]
    patch(client, f"missions/{mission['id']}", {"uavs": [{"id": kite, "own_figures": []}]})
    assert now(client, mission)["uav_changes"] == []
    patch(client, f"missions/{mission['id']}", {"uavs": before})
    assert figures(now(client, mission)) == {"battery_wh": (56.6, 40.0)}


def test_a_sensor_is_told_where_a_target_needs_it(here: World, client: Client, kite: int, iris: int) -> None:
    needing = made(client, here, {"id": kite}, targets=[{"asset": here.towers[2].pk, "sensor": "thermal"}])
    other = made(client, here, {"id": kite}, name="Looks only")
    UavType.objects.filter(pk=iris).update(sensors=["RGB"])
    assert now(client, needing)["uav_changes"][0]["message"] == "Kite: sensors Thermal → RGB."
    assert now(client, other)["uav_changes"] == []


def test_what_is_flown_already_is_let_be(here: World, client: Client, kite: int) -> None:
    mission = made(client, here, {"id": kite})
    Mission.objects.update(state=MissionState.COMPLETED)
    change(client, kite, {"state": "retired"})
    assert now(client, mission)["uav_changes"] == []


def test_a_mission_of_before_batteries_says_that_there_is_one_now(here: World, client: Client, kite: int) -> None:
    mission = made(client, here, {"id": kite})
    MissionUav.objects.update(performance={})
    assert now(client, mission)["uav_changes"][0]["message"].startswith("Kite: battery not counted → 56.6 Wh")


def test_a_page_that_has_it_open_hears_of_it(here: World, client: Client, kite: int) -> None:
    mission = made(client, here, {"id": kite})
    Uav.objects.filter(pk=kite).update(max_range_m=9_000.0)
    received = post(client, f"missions/{mission['id']}/presence", {"editor": "page"}).json()
    assert [change["figures"] for change in received["uav_changes"]] == [[{"name": "max_range_m", "kept": None, "now": 9000.0}]]


def test_a_copy_keeps_what_is_its_own(here: World, client: Client, kite: int) -> None:
    mission = made(client, here, {"id": kite, "battery_wh": 50.0})
    change(client, kite, {"battery_wh": 40.0, "mass_kg": 1.5})
    copy = post(client, f"missions/{mission['id']}/duplicate").json()
    assert figures(now(client, copy)) == {"mass_kg": (1.545, 1.5)}
    assert copy["uavs"][0]["own_figures"] == ["battery_wh"]


def test_a_plan_of_a_missions_own_figures_is_the_missions(here: World, client: Client, kite: int) -> None:
    """Alternatives are planned by what the mission says, battery or none, not by what the fleet has become."""
    mission = made(client, here, {"id": kite})
    UavType.objects.update(battery_wh=20.0, max_airspeed_mps=9.0)
    [kept] = now(client, mission)["uavs"]
    [route] = post(client, "plans", plan_body(here.towers[2], uavs=[kept])).json()["routes"]
    [stored] = mission["plan"]["routes"]
    assert (route["energy_wh"], route["battery_percent"]) == (stored["energy_wh"], stored["battery_percent"])
    uncounted = post(client, "plans", plan_body(here.towers[2], uavs=[kept | {"battery_wh": None}])).json()
    assert uncounted["total_energy_wh"] is None
