"""Things that go wrong in flight, each in many ways. A fault says what the UAV reports from then on, and when that must be told."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any

import numpy as np
import shapely

from telemetry.alerting.detection import CRITICAL, WARNING
from telemetry.alerting.detector_input import WatchedUav
from telemetry.alerting.limits import AlertLimits
from telemetry.alerting.surroundings import IssuedOrder, NearZone, OnboardState
from tests.telemetry.alerting.truth import START_S, State, TrueFlight

LIMITS = AlertLimits()
ANY_LEVEL = (WARNING, CRITICAL)


@dataclass
class Fault:
    """`begins_s` is the second of the flight at which it begins; `due` names code, level and the second from which it counts.

    `truth` changes where the UAV is, `reported` what its report says (None: there is none), `around` what else is known.
    """

    name: str
    begins_s: int
    due: list[tuple[str, tuple[str, ...], float]]
    truth: Callable[[State], State] = lambda state: state
    reported: Callable[[State, dict[str, Any]], dict[str, Any] | None] = lambda _state, values: values
    around: Callable[[State, WatchedUav], dict[str, Any]] = lambda _state, _uav: {}
    lasts_s: int = 90
    is_received: Callable[[State], bool] = lambda _state: True
    extra: dict[str, Any] = field(default_factory=dict)


def _begin(flight: TrueFlight, random: np.random.Generator, least_s: int = 20, from_s: int = 40) -> int:
    choices = [second for second in flight.cruising(least_s) if second >= from_s]
    return int(random.choice(choices))


def _across(flight: TrueFlight, second: int) -> tuple[float, float]:
    state = flight.states[second]
    speed = math.hypot(state.east_mps, state.north_mps)
    return state.north_mps / speed, -state.east_mps / speed


def link_lost(flight: TrueFlight, random: np.random.Generator) -> Fault:
    begins = _begin(flight, random)
    return Fault(
        "link lost", begins, [("link-lost", ANY_LEVEL, begins)], reported=lambda state, values: None if state.seconds >= begins else values,
        is_received=lambda state: state.seconds < begins,
    )  # fmt: skip


def off_route(flight: TrueFlight, random: np.random.Generator) -> Fault:
    begins = _begin(flight, random)
    side, speed_mps = random.choice([-1, 1]), float(random.uniform(2, 8))
    east, north = _across(flight, begins)
    far_m = float(random.uniform(45, 90))

    def truth(state: State) -> State:
        if state.seconds < begins:
            return state
        off_m = min(far_m, speed_mps * (state.seconds - begins))
        moved = flight.states[min(int(state.seconds), begins + 10)]
        return replace(moved, seconds=state.seconds, east=moved.east + side * east * off_m, north=moved.north + side * north * off_m)

    due_s = begins + math.ceil((LIMITS.off_route_m + 8.0) / speed_mps)
    return Fault("off the route", begins, [("off-route", ANY_LEVEL, due_s)], truth=truth, lasts_s=30)


def height_off(flight: TrueFlight, random: np.random.Generator) -> Fault:
    begins = _begin(flight, random)
    side, far_m = random.choice([-1, 1]), float(random.uniform(20, 50))

    def truth(state: State) -> State:
        off_m = min(far_m, CLIMB * (state.seconds - begins))
        moved = flight.states[min(int(state.seconds), begins + 20)]
        return state if state.seconds < begins else replace(moved, seconds=state.seconds, height_m=moved.height_m + side * off_m)

    heights_m = flight.model.line.heights_m
    spread_m = max(abs(one - other) for one, other in pairwise(heights_m))
    far_m += spread_m
    return Fault(
        "height", begins, [("height-off", ANY_LEVEL, begins + (LIMITS.height_off_m + 4.0 + spread_m) / CLIMB)], truth=truth, lasts_s=45
    )


CLIMB = 3.0


def _square(flight: TrueFlight, east: float, north: float, half_m: float, turn: float, **facts: Any) -> NearZone:
    corners = [(half_m * math.cos(turn + k * math.pi / 2), half_m * math.sin(turn + k * math.pi / 2)) for k in range(4)]
    polygon = shapely.Polygon([flight.position(east + de, north + dn) for de, dn in corners])
    shapely.prepare(polygon)
    return NearZone(**{"zone_id": 7, "name": "EKR-7", "polygon": polygon, "floor_agl_m": -math.inf, "ceiling_agl_m": math.inf, **facts})


def zone_ahead(flight: TrueFlight, random: np.random.Generator) -> Fault:
    """A zone that was saved since lies across a leg that is flown straight on for longer than is looked ahead."""
    begins = _begin(flight, random, least_s=40)
    entry = flight.states[begins + 36]
    half_m = 30.0 / math.sqrt(0.5)
    speed = math.hypot(entry.east_mps, entry.north_mps)
    turn = math.atan2(entry.north_mps, entry.east_mps) + math.pi / 4
    zone = _square(flight, entry.east + 30 * entry.east_mps / speed, entry.north + 30 * entry.north_mps / speed, half_m, turn)
    due = [("zone", ANY_LEVEL, begins + 36 - LIMITS.zone_ahead_s + 4), ("zone", (CRITICAL,), begins + 36 + math.ceil(8 / speed))]
    # it stands there then: it must not come to the next leg
    return Fault("zone ahead", begins, due, truth=_stops(flight, begins + 39), around=lambda _state, _uav: {"zones": (zone,)}, lasts_s=56)


def zone_entered(flight: TrueFlight, random: np.random.Generator) -> Fault:
    """A zone comes into force where it is, at its height."""
    begins = _begin(flight, random)
    here = flight.states[begins]
    agl_m = here.height_m
    spans = ((START_S + begins, START_S + begins + 3_600.0),)
    facts = [{}, {"spans": spans}, {"floor_agl_m": agl_m - 40.0, "ceiling_agl_m": agl_m + 40.0}, {"floor_agl_m": 0.0}]
    zone = _square(flight, here.east, here.north, 400.0, float(random.uniform(0, 3)), **facts[int(random.integers(4))])

    def around(state: State, _uav: WatchedUav) -> dict[str, Any]:
        return {"zones": (zone,) if state.seconds >= begins or zone.spans is not None else ()}

    begins_before = begins - 40 if zone.spans is not None else begins
    del begins_before
    return Fault("zone entered", begins, [("zone", (CRITICAL,), begins)], truth=_stops(flight, begins + 5), around=around, lasts_s=25)


def _stops(flight: TrueFlight, second: int) -> Callable[[State], State]:
    stands = replace(flight.states[second], east_mps=0.0, north_mps=0.0, up_mps=0.0)
    return lambda state: replace(stands, seconds=state.seconds) if state.seconds >= second else state


def battery_drops(flight: TrueFlight, random: np.random.Generator) -> Fault:
    begins = _begin(flight, random)
    energy = flight.model.energy
    lacks = max(0.0, 100.0 - 1.02 * energy.until_percent[-1] - 17.0) + float(random.uniform(5, 25))

    def reported(state: State, values: dict[str, Any]) -> dict[str, Any]:
        return values if state.seconds < begins else values | {"battery_percent": max(values["battery_percent"] - lacks, 0.0)}

    return Fault("battery drops", begins, [("battery-short", ANY_LEVEL, begins)], reported=reported, lasts_s=40)


def battery_drains(flight: TrueFlight, random: np.random.Generator) -> Fault:
    """It takes two to three times as much as planned: told by the time 8 % more of the battery were to have been used."""
    begins = int(_begin(flight, random, from_s=30) * 0.4) + 35
    factor = float(random.uniform(2.2, 3.0))
    used = flight.states[begins].used_percent
    rest = flight.model.energy.until_percent[-1] - used
    lacks = 100.0 - used - factor * rest < 17.0 - 3.0
    due = next((state.seconds for state in flight.states if state.used_percent >= used + 9.0), None)

    def reported(state: State, values: dict[str, Any]) -> dict[str, Any]:
        more = max(0.0, (factor - 1.0) * (state.used_percent - used))
        return values | {"battery_percent": max(round(values["battery_percent"] - more), 0.0)}

    is_due = lacks and due is not None
    return Fault("battery drains", begins, [("battery-short", ANY_LEVEL, due)] if is_due else [], reported=reported, lasts_s=220)


def no_progress(flight: TrueFlight, random: np.random.Generator) -> Fault:
    line = flight.model.line
    fit = [
        second
        for second in flight.cruising(5)
        if second >= 40 and not any(abs(along - line.place(flight.position(flight.states[second].east, flight.states[second].north),
        flight.states[second].vertex).along_m) < 45.0 for along in line.along_m)
    ]  # fmt: skip
    begins = int(random.choice(fit))
    return Fault("no progress", begins, [("no-progress", ANY_LEVEL, begins)], truth=_stops(flight, begins), lasts_s=120)


def mode_changed(flight: TrueFlight, random: np.random.Generator) -> Fault:
    begins = _begin(flight, random)
    mode = str(random.choice(["RTL", "LAND", "POSCTL", "LOITER", "STABILIZE", "GUIDED"]))
    stops = _stops(flight, begins)
    speed_mps = float(random.uniform(3, 10))
    here = flight.states[begins]
    home_m = math.hypot(here.east, here.north)

    def truth(state: State) -> State:
        if state.seconds < begins or mode in ("LAND", "LOITER"):
            return stops(state)
        gone = min(1.0, speed_mps * (state.seconds - begins) / max(home_m, 1.0))
        return replace(here, seconds=state.seconds, east=here.east * (1 - gone), north=here.north * (1 - gone), height_m=here.height_m + 10)

    levels = (CRITICAL,) if mode in ("RTL", "LAND") else (WARNING,)
    order = IssuedOrder("start", START_S + 5) if random.random() < 0.5 else None
    return Fault(
        f"mode {mode}", begins, [("mode-changed", levels, begins)], truth=truth, around=lambda _state, _uav: {"order": order},
        reported=lambda state, values: values | ({"mode": mode} if state.seconds >= begins else {}), lasts_s=60,
    )  # fmt: skip


def gps_trouble(flight: TrueFlight, random: np.random.Generator) -> Fault:
    begins = _begin(flight, random)
    kind = str(random.choice(["no fix", "no position", "few", "weak"]))
    changed = {
        "no fix": {"gps_fix": 1}, "no position": {"longitude_deg": None, "latitude_deg": None},
        "few": {"satellites": 5}, "weak": {"hdop": 3.4},
    }[kind]  # fmt: skip
    levels = (CRITICAL,) if kind.startswith("no") else (WARNING,)
    return Fault(
        f"gps {kind}", begins, [("gps", levels, begins)],
        reported=lambda state, values: values | (changed if state.seconds >= begins else {}),
    )  # fmt: skip


def position_jumps(flight: TrueFlight, random: np.random.Generator) -> Fault:
    begins = _begin(flight, random)
    back = begins + int(random.integers(2, 9))
    far_m, turn = float(random.uniform(150, 800)), float(random.uniform(0, 6.3))

    def truth(state: State) -> State:
        if not begins <= state.seconds < back:
            return state
        return replace(state, east=state.east + far_m * math.cos(turn), north=state.north + far_m * math.sin(turn))

    return Fault("position jumps", begins, [("gps", ANY_LEVEL, begins)], truth=truth, extra={"most_interval_s": 2})


def other_mission(flight: TrueFlight, random: np.random.Generator) -> Fault:
    begins = _begin(flight, random)
    kind = int(random.integers(4))

    def around(state: State, uav: WatchedUav) -> dict[str, Any]:
        approved = OnboardState(approval_id=uav.approval_id, is_approved=True, items=12)
        if state.seconds < begins:
            return {"held": approved}
        return {"held": [OnboardState(), replace(approved, is_approved=False), replace(approved, doubt="mission-changed"), approved][kind]}

    def reported(state: State, values: dict[str, Any]) -> dict[str, Any]:
        return values | {"mission_item": 14 if kind == 3 and state.seconds >= begins else 3}

    return Fault("other mission", begins, [("other-mission", (CRITICAL,), begins)], around=around, reported=reported)


def wind(flight: TrueFlight, random: np.random.Generator) -> Fault:
    begins = _begin(flight, random)
    limit_mps = flight.model.max_airspeed_mps * LIMITS.wind_share_percent / 100.0
    wind_mps = limit_mps + float(random.uniform(2.5, 6.0))
    turn = float(random.uniform(0, 6.3))

    def reported(state: State, values: dict[str, Any]) -> dict[str, Any]:
        if state.seconds < begins:
            return values
        gust = wind_mps + float(random.normal(0, 0.3))
        return values | {"wind_north_mps": gust * math.cos(turn), "wind_east_mps": gust * math.sin(turn)}

    return Fault("wind", begins, [("weather", ANY_LEVEL, begins)], reported=reported)


FAULTS = (
    link_lost, off_route, height_off, zone_ahead, zone_entered, battery_drops, battery_drains, no_progress, mode_changed, gps_trouble,
    position_jumps, other_mission, wind,
)  # fmt: skip
