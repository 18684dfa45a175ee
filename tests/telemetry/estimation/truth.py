"""A flight as it really went: a seeded UAV that flies a route step by step, and never quite as it was told.

It shares nothing with the estimator's profile: it steers towards its next waypoint with an acceleration that it cannot exceed, cuts corners
by a radius of its own, climbs and flies at speeds of its own, is blown about, waits at tasks longer than it was told, and is now and then
paused, called back or landed.
"""

import math
import random
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from inspection.geodesy.local_frame import LocalFrame
from mavlink.approved_route import HOVER, Flight
from telemetry.estimation.knowledge import Knowledge

STEP_S = 0.1
MAX_DURATION_S = 3_600.0
FloatArray = NDArray[np.float64]
MODES = {
    "px4": {"mission": "MISSION", "hold": "LOITER", "return": "RTL", "land": "LAND"},
    "ardupilot": {"mission": "AUTO", "hold": "BRAKE", "return": "RTL", "land": "LAND"},
}


@dataclass(frozen=True)
class Events:
    """What happens to it besides, by shares of flights: it is paused and goes on, is called back, or lands where it is."""

    paused: float = 0.15
    returned: float = 0.07
    landed: float = 0.03


@dataclass
class Truth:
    """Every STEP_S: columns time since the start, east, north, height, their speeds; the mode, whether in the air, the waypoint.

    `armed` is left empty where it was armed all the time.
    """

    frame: LocalFrame
    rows: FloatArray
    modes: list[str]
    in_air: list[bool]
    sequence: list[int]
    reached: dict[int, float] = field(default_factory=dict)  # waypoint's sequence: seconds
    armed: list[bool] = field(default_factory=list)

    @property
    def duration_s(self) -> float:
        return float(self.rows[-1, 0])

    def at(self, second: float) -> FloatArray:
        """east, north, height, and their speeds."""
        place = min(max(second / STEP_S, 0.0), len(self.rows) - 1.0)
        low = min(int(place), len(self.rows) - 2)
        share = place - low
        found: FloatArray = self.rows[low, 1:] + share * (self.rows[low + 1, 1:] - self.rows[low, 1:])
        return found


@dataclass
class _Uav:
    """Where it is and how it flies; `pull` moves it by one step."""

    chance: random.Random
    accelerates_mps2: float
    climbs_mps: float
    sinks_mps: float
    lags_s: float
    gust_mps: float
    east: float = 0.0
    north: float = 0.0
    up: float = 0.0
    v_east: float = 0.0
    v_north: float = 0.0
    v_up: float = 0.0
    gust_east: float = 0.0
    gust_north: float = 0.0

    def pull(self, want_east: float, want_north: float, want_up: float) -> None:
        keep, kick = math.exp(-STEP_S / 6.0), math.sqrt(1.0 - math.exp(-2.0 * STEP_S / 6.0))
        self.gust_east = keep * self.gust_east + kick * self.chance.gauss(0.0, self.gust_mps)
        self.gust_north = keep * self.gust_north + kick * self.chance.gauss(0.0, self.gust_mps)
        a_east = (want_east + self.gust_east - self.v_east) / self.lags_s
        a_north = (want_north + self.gust_north - self.v_north) / self.lags_s
        size = math.hypot(a_east, a_north)
        most = min(1.0, self.accelerates_mps2 / size) if size > 0 else 1.0
        self.v_east += a_east * most * STEP_S
        self.v_north += a_north * most * STEP_S
        self.v_up += min(max((want_up - self.v_up) / 0.6, -1.5), 1.5) * STEP_S
        self.east += self.v_east * STEP_S
        self.north += self.v_north * STEP_S
        self.up += self.v_up * STEP_S


def fly(flight: Flight, knowledge: Knowledge, seed: int, events: Events | None = None) -> Truth:
    chance = random.Random(f"truth {seed}")
    events = events or Events()
    frame = LocalFrame.around(*flight.take_off.position)
    pilot = _Pilot(flight, knowledge, frame, chance, events)
    return pilot.fly()


class _Pilot:
    def __init__(self, flight: Flight, knowledge: Knowledge, frame: LocalFrame, chance: random.Random, events: Events) -> None:
        self.flight, self.knowledge, self.frame, self.chance = flight, knowledge, frame, chance
        self.uav = _Uav(
            chance,
            chance.uniform(1.6, 3.2),
            chance.uniform(1.9, 3.2),
            chance.uniform(1.3, 2.4),
            chance.uniform(0.5, 1.0),
            chance.uniform(0.1, 0.5),
        )
        self.along_track = chance.gauss(1.0, 0.04)
        self.radius_m = chance.uniform(1.5, 8.0)
        self.corner = chance.uniform(0.25, 0.75)
        self.slow_below_m = chance.uniform(5.0, 10.0)
        self.settle_s = chance.uniform(0.3, 3.0)
        self.names = MODES[chance.choice(["px4", "ardupilot"])]
        layer = knowledge.conditions.wind_at(60.0)
        turn, share = chance.gauss(0.0, 0.25), max(chance.gauss(1.0, 0.25), 0.0)
        self.wind = (
            share * (layer[0] * math.cos(turn) - layer[1] * math.sin(turn)), share * (layer[0] * math.sin(turn) + layer[1] * math.cos(turn))
        )  # fmt: skip
        self.places = frame.to_metres(np.array([waypoint.position for waypoint in flight.waypoints]))
        self.ground_s = chance.uniform(0.0, 12.0)
        length_s = self._about_s()
        stated = chance.random()
        self.pause_at = chance.uniform(0.1, 0.9) * length_s if stated < events.paused else math.inf
        self.pause_s = chance.uniform(15.0, 90.0)
        called = events.paused <= stated < events.paused + events.returned + events.landed
        self.call_at = chance.uniform(0.1, 0.9) * length_s if called else math.inf
        self.is_return = stated < events.paused + events.returned
        self.rows: list[tuple[float, ...]] = []
        self.modes: list[str] = []
        self.air: list[bool] = []
        self.sequence: list[int] = []
        self.reached: dict[int, float] = {}
        self.now_s = 0.0

    def _about_s(self) -> float:
        steps = np.hypot(*np.diff(self.places, axis=0).T) if len(self.places) > 1 else np.zeros(1)
        holds = sum(waypoint.task.hold_s for waypoint in self.flight.waypoints if waypoint.task is not None)
        return float(steps.sum()) / self.knowledge.cruise_speed_mps + holds + 60.0

    def fly(self) -> Truth:
        self._stand(self.ground_s, "mission", in_air=False)
        for number, waypoint in enumerate(self.flight.waypoints):
            if self._called():
                return self._go_home()
            self._to(number)
            if self._called():
                return self._go_home()
            self.reached[waypoint.sequence] = self.now_s
            if waypoint.task is not None and waypoint.task.hold_s > 0:
                self._hover(math.ceil(waypoint.task.hold_s) + self.settle_s + abs(self.chance.gauss(0.0, 0.5)), number)
        if self.flight.end_action == HOVER:
            self._hover(20.0, len(self.places) - 1)
        else:
            self._land("mission", self.flight.waypoints[-1].ground_relative_m)
        return self._truth()

    def _called(self) -> bool:
        return self.now_s >= self.call_at

    def _go_home(self) -> Truth:
        if not self.is_return:
            self._land("land", 0.0)
            return self._truth()
        target_m, stay = max(self.uav.up, 50.0), self._braked()
        while self.uav.up < target_m - 1.0:
            self._stay(stay, self.uav.climbs_mps, "return")
        while (far_m := math.hypot(self.uav.east, self.uav.north)) > 2.0 and self.now_s < MAX_DURATION_S:
            speed = min(self._ground_speed(-self.uav.east, -self.uav.north, self.knowledge.cruise_speed_mps), self._stopping(far_m))
            self._step(-self.uav.east / far_m * speed, -self.uav.north / far_m * speed, 0.0, "return")
        self._land("return", 0.0)
        return self._truth()

    def _to(self, number: int) -> None:
        waypoint, (east, north) = self.flight.waypoints[number], self.places[number]
        start = (0.0, 0.0, 0.0) if number == 0 else (*self.places[number - 1], self.flight.waypoints[number - 1].altitude_relative_m)
        stops = number == len(self.places) - 1 or (waypoint.task is not None and waypoint.task.hold_s > 0)
        passing = 0.0 if stops else self._passing_mps(number)
        wished = (waypoint.speed_mps or self.knowledge.cruise_speed_mps) * self.along_track
        length_m = math.hypot(east - start[0], north - start[1])
        rise_m = waypoint.altitude_relative_m - start[2]
        while self.now_s < MAX_DURATION_S:
            if self.now_s >= self.pause_at:
                self.pause_at = math.inf
                self._wait_paused()
            if self._called():
                return
            d_east, d_north, d_up = east - self.uav.east, north - self.uav.north, waypoint.altitude_relative_m - self.uav.up
            far_m = math.hypot(d_east, d_north)
            slow = math.hypot(self.uav.v_east, self.uav.v_north) < 0.8
            if (far_m < 1.2 and abs(d_up) < 0.6 and slow) if passing == 0.0 else (far_m < self.radius_m and abs(d_up) < 3.0):
                return
            self._steer(start, (east, north), length_m, rise_m, far_m, d_up, wished, passing, waypoint.sequence)

    def _steer(self, start, end, length_m, rise_m, far_m, d_up, wished, passing, sequence) -> None:
        uav = self.uav
        want_up = min(max(d_up / 1.0, -uav.sinks_mps), uav.climbs_mps)
        if far_m < 0.05 or length_m < 1.0:
            self._step((end[0] - uav.east) * 0.8, (end[1] - uav.north) * 0.8, want_up, "mission", sequence)
            return
        limit_s = abs(rise_m) / (uav.climbs_mps if rise_m > 0 else uav.sinks_mps)
        if limit_s > 0:
            wished = min(wished, max(length_m / limit_s, 1.0))
            gone = min(max(1.0 - far_m / length_m, 0.0), 1.0)
            rate = rise_m / length_m * math.hypot(uav.v_east, uav.v_north)
            want_up = min(max(rate + (start[2] + gone * rise_m - uav.up), -uav.sinks_mps), uav.climbs_mps)
        along_e, along_n = (end[0] - start[0]) / length_m, (end[1] - start[1]) / length_m
        ahead_m = min(12.0, far_m)
        to_e, to_n = end[0] - along_e * (far_m - ahead_m) - uav.east, end[1] - along_n * (far_m - ahead_m) - uav.north
        size = math.hypot(to_e, to_n) or 1.0
        speed = min(self._ground_speed(to_e, to_n, wished), self._stopping(far_m - (0.5 * self.radius_m if passing else 0.0), passing))
        self._step(to_e / size * speed, to_n / size * speed, want_up, "mission", sequence)

    def _passing_mps(self, number: int) -> float:
        before = self.places[number] - (self.places[number - 1] if number else (0.0, 0.0))
        after = self.places[number + 1] - self.places[number]
        sizes = float(np.hypot(*before)), float(np.hypot(*after))
        if min(sizes) < 1.0:
            return 0.0
        bend = math.acos(min(max(float(before @ after) / (sizes[0] * sizes[1]), -1.0), 1.0))
        if bend > 2.6:
            return 0.0
        return max(self.knowledge.cruise_speed_mps * (1.0 - self.corner * bend), 1.5)

    def _stopping(self, far_m: float, end_mps: float = 0.0) -> float:
        return (
            math.sqrt(end_mps**2 + 2.0 * 0.7 * self.uav.accelerates_mps2 * max(far_m, 0.0))
            if far_m > 1.0 or end_mps
            else max(0.8 * far_m, 0.0)
        )

    def _ground_speed(self, to_e: float, to_n: float, wished: float) -> float:
        size = math.hypot(to_e, to_n) or 1.0
        along = (self.wind[0] * to_e + self.wind[1] * to_n) / size
        across = (self.wind[1] * to_e - self.wind[0] * to_n) / size
        limit = self.knowledge.max_airspeed_mps or math.inf
        if math.isinf(limit):
            return wished
        return max(min(wished, along + math.sqrt(max(limit**2 - across**2, 0.0))), 1.0)

    def _wait_paused(self) -> None:
        until_s, stay = self.now_s + self.pause_s, self._braked()
        while self.now_s < until_s and not self._called():
            self._stay(stay, 0.0, "hold")

    def _braked(self) -> tuple[float, float]:
        """Where it comes to a stand."""
        uav = self.uav
        speed = math.hypot(uav.v_east, uav.v_north)
        reach_s = 0.5 * speed / uav.accelerates_mps2
        return uav.east + uav.v_east * reach_s, uav.north + uav.v_north * reach_s

    def _stay(self, place: tuple[float, float], up_mps: float, mode: str) -> None:
        to_e, to_n = place[0] - self.uav.east, place[1] - self.uav.north
        far_m = math.hypot(to_e, to_n)
        share = self._stopping(far_m) / far_m if far_m > 0 else 0.0
        self._step(to_e * min(share, 0.8), to_n * min(share, 0.8), up_mps, mode)

    def _hover(self, seconds: float, number: int) -> None:
        (east, north), waypoint = self.places[number], self.flight.waypoints[number]
        until_s = self.now_s + seconds
        while self.now_s < until_s and not self._called():
            up = 0.7 * (waypoint.altitude_relative_m - self.uav.up)
            self._step(0.7 * (east - self.uav.east), 0.7 * (north - self.uav.north), up, "mission", waypoint.sequence)

    def _land(self, mode: str, ground_m: float) -> None:
        stay = self._braked()
        while self.uav.up > ground_m + 0.1 and self.now_s < MAX_DURATION_S:
            sinks = self.uav.sinks_mps if self.uav.up > ground_m + self.slow_below_m else 0.7
            self._stay(stay, -sinks, mode)
        self._stand(8.0, mode, in_air=False)

    def _stand(self, seconds: float, mode: str, *, in_air: bool) -> None:
        self.uav.v_east = self.uav.v_north = self.uav.v_up = 0.0
        for _ in range(int(seconds / STEP_S)):
            self._note(mode, in_air=in_air)

    def _step(self, east_mps: float, north_mps: float, up_mps: float, mode: str, sequence: int | None = None) -> None:
        self.uav.pull(east_mps, north_mps, up_mps)
        self._note(mode, in_air=True, sequence=sequence)

    def _note(self, mode: str, *, in_air: bool, sequence: int | None = None) -> None:
        uav = self.uav
        self.rows.append((self.now_s, uav.east, uav.north, uav.up, uav.v_east, uav.v_north, uav.v_up))
        self.modes.append(self.names[mode])
        self.air.append(in_air)
        self.sequence.append(sequence if sequence is not None else self.sequence[-1] if self.sequence else 0)
        self.now_s += STEP_S

    def _truth(self) -> Truth:
        return Truth(self.frame, np.array(self.rows), self.modes, self.air, self.sequence, self.reached)
