"""Random missions with all that a flight has: zones with heights and times, hills, wind, batteries, charging, others in the air."""

import random
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np

from inspection.geodesy import LonLat
from inspection.models import Asset, NoFlyZone
from inspection.selectors import current_graph
from inspection.services import build_graph, import_osm, mark_ground_changed
from missions.models import Mission, MissionState
from missions.services import PlanRequest, UavRequest, create_mission, make_plan, store_plan
from planning.clearance.lost_link import LostLink
from planning.energy.conditions import Conditions, WindLayer
from planning.energy.performance import IRIS_BATTERY_WH, IRIS_MAX_AIRSPEED_MPS, Performance
from planning.problem import Objective
from planning.request import EndAction, LostLinkRequest
from tests.missions.oracles.terrain_oracle import Hills
from tests.missions.property_tests.random_missions import Region, put_random_zones
from workspace.models import User

# With hills; elsewhere limits above sea level cannot be compared.
HILLY = ("quillmoor.osm.pbf", "columbus-ohio.osm.pbf", "liechtenstein-2021-infra.osm.pbf")
ASSETS = 300  # of each region
ZONES = 12
MIN_NODES = 100  # that zones leave of a network
TALL_SHARE = 0.06  # of its towers stick out above what is cleared between targets
APPROVED = 2  # missions of each departure
AIRS = 8  # conditions that are drawn from: what they make of a network is worked out once
A_MONDAY = datetime(2026, 11, 23, tzinfo=UTC)
EVENTS = ("BMCT", "SR", "SS", "EECT")


def bring_in(path: Path, folder: Path, draw: random.Random, *, is_hilly: bool) -> Hills | None:
    """Import the middle of a region, with some tall towers; return its hills, if it is to have any."""
    import_osm(path=path)
    cut_out(ASSETS)
    _make_tall(draw)
    if not is_hilly:
        return None
    hills = Hills()
    hills.bring_in(folder / "hills.tif")
    return hills


def cut_out(most: int) -> None:
    """Leaves the assets nearest to the middle of the region: a small network is cleared of zones in no time."""
    rows = [(key, *centre.coords) for key, centre in Asset.objects.values_list("pk", "centre")]
    places = np.array([row[1:3] for row in rows])
    away = np.hypot(*((places - np.median(places, axis=0)) * (np.cos(np.radians(places[:, 1].mean())), 1.0)).T)
    Asset.objects.filter(pk__in=[rows[row][0] for row in np.argsort(away)[most:].tolist()]).delete()
    mark_ground_changed()


def _make_tall(draw: random.Random) -> None:
    towers = list(Asset.objects.filter(kind="tower").order_by("pk"))
    for tower in draw.sample(towers, int(TALL_SHARE * len(towers))):
        tower.height_m = draw.uniform(50.0, 110.0)
        tower.save(update_fields=["height_m"])
    mark_ground_changed()


def put_zones(seed: int, draw: random.Random) -> None:
    """Random zones, as few as a small network leaves room for, with random heights and times."""
    for number in count():
        put_random_zones(seed + 1_000 * number)
        _give_heights_and_times(draw)
        if len(current_graph().position) >= MIN_NODES:
            return


def _give_heights_and_times(draw: random.Random) -> None:
    zones = draw.sample(list(NoFlyZone.objects.order_by("pk")), ZONES)
    NoFlyZone.objects.exclude(pk__in=[zone.pk for zone in zones]).delete()
    for zone in zones:
        for name, value in _band(draw).items():
            setattr(zone, name, value)
        zone.schedule = _schedule(draw)
    NoFlyZone.objects.bulk_update(zones, ["lower_limit_m", "lower_reference", "upper_limit_m", "upper_reference", "schedule"])
    mark_ground_changed()
    build_graph()


def _band(draw: random.Random) -> dict[str, Any]:
    """None, from the ground up, aloft, above the sea, or in a reference that cannot be compared."""
    kind = draw.choice(["none", "none", "low", "aloft", "aloft", "sea", "pressure"])
    if kind == "low":
        return {"upper_limit_m": draw.uniform(5, 200), "upper_reference": "AGL"}
    if kind == "aloft":
        lower_m = draw.uniform(20, 250)
        return {
            "lower_limit_m": lower_m, "lower_reference": "AGL",
            "upper_limit_m": lower_m + draw.uniform(10, 500), "upper_reference": "AGL",
        }  # fmt: skip
    if kind == "sea":
        lower_m = draw.uniform(0, 900)
        return {
            "lower_limit_m": lower_m, "lower_reference": "AMSL",
            "upper_limit_m": lower_m + draw.uniform(20, 900), "upper_reference": "AMSL",
        }  # fmt: skip
    if kind == "pressure":
        return {"lower_limit_m": 1_000.0, "lower_reference": "STD", "upper_limit_m": draw.choice([None, 3_000.0]), "upper_reference": "STD"}
    return {}


def _schedule(draw: random.Random) -> list[dict[str, Any]] | None:
    kind = draw.choice(["always", "always", "hours", "hours", "sun", "dates", "long ago"])
    if kind == "always":
        return None
    if kind == "long ago":
        return [period([], end="2020-01-01T00:00:00Z")]
    if kind == "dates":
        start = A_MONDAY + timedelta(hours=draw.randrange(0, 150))
        return [period([], start=_text(start), end=_text(start + timedelta(hours=draw.randrange(1, 40))))]
    days = draw.choice([["ANY"], draw.sample(["MON", "TUE", "WED", "THU", "FRI", "SAT", "SUN"], 3)])
    entry: dict[str, Any] = {"day": days, "startTime": None, "startEvent": None, "endTime": None, "endEvent": None}
    for side in ("start", "end"):
        if kind == "sun" and draw.random() < 0.7:
            entry[f"{side}Event"] = draw.choice(EVENTS)
        elif draw.random() < 0.9:
            entry[f"{side}Time"] = f"{draw.randrange(24):02}:{draw.randrange(60):02}:00Z"
    return [period([entry])]


def period(entries: list[dict[str, Any]], start: str | None = None, end: str | None = None) -> dict[str, Any]:
    return {"startDateTime": start, "endDateTime": end, "schedule": entries}


def _text(moment: datetime) -> str:
    return f"{moment:%Y-%m-%dT%H:%M:%SZ}"


def departures(draw: random.Random, number: int) -> list[datetime | None]:
    """At any time, and so many times: for each the network is cleared anew of the zones that apply then."""
    return [None, *(A_MONDAY + timedelta(minutes=draw.randrange(7 * 24 * 60)) for _ in range(number))]


def airs(draw: random.Random) -> list[Conditions]:
    """Half of them with wind that turns and grows with height."""
    found = []
    for number in range(AIRS):
        wind = (WindLayer(10.0, draw.uniform(0, 6), draw.uniform(0, 359)), WindLayer(100.0, draw.uniform(0, 8), draw.uniform(0, 359)))
        found.append(Conditions(wind if number % 2 else (), draw.uniform(-10, 35)))
    return found


def flight(region: Region, draw: random.Random, air: Conditions, departs_at: datetime | None, author: User) -> PlanRequest:
    """A mission of the region in this air, with batteries, several flights or charging, and a wish for a lost link."""
    charging_w = draw.uniform(60.0, 400.0) if draw.random() < 0.15 else None
    asked = replace(region.mission(draw), departs_at=departs_at, conditions=air, charging_w=charging_w)
    if draw.random() < 0.25:
        asked = replace(asked, organisation=author.organisation_id)
    uavs = tuple(_equipped(asked, number, uav, draw) for number, uav in enumerate(asked.uavs))
    return replace(asked, uavs=uavs, lost_link=_lost_link(asked, draw))


def _equipped(asked: PlanRequest, number: int, uav: UavRequest, draw: random.Random) -> UavRequest:
    """Half of the UAVs with a battery, some with a limit of airspeed that the wind stays below. Small batteries are flown with again."""
    sorties = draw.choice([1, 1, 2, 3]) if asked.end_action(number) == EndAction.RETURN else 1
    batteries_wh = [IRIS_BATTERY_WH, 200.0]
    if sorties > 1 or asked.charging_w is not None:
        batteries_wh = [20.0, 35.0, IRIS_BATTERY_WH]
    return replace(
        uav,
        sorties=sorties,
        performance=Performance(
            battery_wh=draw.choice(batteries_wh if asked.objective is Objective.ENERGY else [None, None, *batteries_wh]),
            max_airspeed_mps=draw.choice([None, None, IRIS_MAX_AIRSPEED_MPS, 15.0]),
            reserve_percent=draw.choice([0.0, 20.0]),
        ),
    )


def _lost_link(asked: PlanRequest, draw: random.Random) -> LostLinkRequest:
    if draw.random() < 0.75:
        return LostLinkRequest()
    near = [uav.position for uav in asked.uavs] + [base.position for base in asked.bases]
    rally = [LonLat(at.lon + draw.uniform(-0.02, 0.02), at.lat + draw.uniform(-0.02, 0.02)) for at in draw.sample(near, draw.randint(0, 2))]
    if draw.random() < 0.5:
        return LostLinkRequest(LostLink.RETURN, tuple(rally))
    return LostLinkRequest(LostLink.HOLD, tuple(rally), draw.uniform(0.0, 120.0))


def stored(asked: PlanRequest, plan: dict[str, Any], author: User) -> Mission:
    """The mission with its plan, as the program keeps it."""
    mission = create_mission(organisation=author.organisation, author=author, name="Drawn", request=asked)
    return store_plan(mission=mission, actor=author, revision=mission.revision, plan=plan)


def approve_some(region: Region, draw: random.Random, air: Conditions, departs_at: datetime, author: User) -> None:
    """Missions that are to be flown at about that time."""
    for _ in range(APPROVED):
        asked = flight(region, draw, air, departs_at + timedelta(seconds=draw.randrange(-900, 1_800)), author)
        mission = stored(asked, make_plan(request=asked), author)
        Mission.objects.filter(pk=mission.pk).update(state=MissionState.APPROVED)
