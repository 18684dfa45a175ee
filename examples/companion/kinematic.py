"""A stand-in for an autopilot: a point that flies from waypoint to waypoint at a constant speed, hovers for tasks, returns and lands.

It has no dynamics, wind or battery model; it is there to try the link. Time comes from whoever asks.
"""

import copy
import math
from typing import Any

from examples.companion.autopilot import Events, Refused

METRES_A_DEGREE = 111_195.0  # of latitude, on the mean sphere
CLIMB_MPS = 3.0
STEP_S = 0.5
FULL_FLIGHT_S = 1_800.0  # that a battery lasts
GROUND, FLYING, HOLDING, RETURNING, LANDING = "Standby", "Mission", "Hold", "Return", "Land"


class KinematicAutopilot:
    """Stands at `place` (longitude, latitude [deg]) until it is started."""

    def __init__(self, place: tuple[float, float], *, ground_amsl_m: float = 0.0) -> None:
        self.place = self.home = place
        self.height_m = 0.0  # above take-off
        self.mode = GROUND
        self.is_armed = False
        self.held: dict[str, Any] | None = None  # the flight that is on it
        self.next = 0  # which waypoint it flies to
        self.has_started = False
        self.speed_mps: float | None = None
        self._ground_amsl_m = ground_amsl_m
        self._now_s: float | None = None
        self._hover_until_s: float | None = None
        self._velocity = (0.0, 0.0, 0.0)
        self._flown_s = 0.0
        self._targets: list[tuple[int, str, str]] = []
        self._ended: str | None = None
        self._photos: list[tuple[float, dict[str, Any]]] = []
        self._images = 0

    # --- what it is told ---

    def load(self, content: dict[str, Any], now_s: float) -> dict[str, Any]:
        self._advance(now_s)
        if self.is_in_air:
            raise Refused("It is flying.")
        if not content["waypoints"]:
            raise Refused("A flight needs waypoints.")
        self.held, self.next, self.has_started, self.speed_mps = copy.deepcopy(content), 0, False, None
        return copy.deepcopy(self.held)

    def clear(self, now_s: float) -> None:
        self._advance(now_s)
        if self.mode == FLYING:
            raise Refused("It is flying it.")
        self.held = None

    def command(self, kind: str, parameters: dict[str, Any], now_s: float) -> None:
        self._advance(now_s)
        if kind == "arm":
            self.is_armed = True
        elif kind in {"start", "resume", "take-off"}:
            self._start(kind)
        elif kind in {"pause", "hold"}:
            self._only_in_air()
            self.mode = HOLDING
        elif kind in {"return", "abort"}:
            if self.is_in_air:
                self.mode = RETURNING
        elif kind == "land":
            if self.is_in_air:
                self.mode = LANDING
        elif kind == "change-speed":
            self.speed_mps = float(parameters["speed_mps"])
        else:
            raise Refused(f"{kind} is not known here.")

    def has_done(self, kind: str, now_s: float) -> bool:
        self._advance(now_s)
        wanted = {"pause": HOLDING, "hold": HOLDING, "return": RETURNING, "abort": RETURNING, "land": LANDING}
        if kind in wanted:
            return self.mode == wanted[kind] or not self.is_in_air
        return self.is_in_air if kind in {"start", "take-off", "resume"} else True

    # --- what it says ---

    def report(self, now_s: float) -> dict[str, Any]:
        self._advance(now_s)
        north, east, up = self._velocity
        return {
            "position": [round(self.place[0], 8), round(self.place[1], 8)],
            "altitude_relative_m": round(self.height_m, 2),
            "altitude_amsl_m": round(self._ground_amsl_m + self.height_m, 2),
            "velocity_north_mps": round(north, 2),
            "velocity_east_mps": round(east, 2),
            "velocity_down_mps": round(0.0 - up, 2),
            "heading_deg": round(math.degrees(math.atan2(east, north)) % 360.0, 1) % 360.0 if north or east else None,
            "battery_percent": round(max(0.0, 100.0 * (1.0 - self._flown_s / FULL_FLIGHT_S)), 1),
            "mode": self.mode,
            "is_armed": self.is_armed,
            "is_in_air": self.is_in_air,
            "waypoint_sequence": self._flies_to,
        }

    def events(self, now_s: float) -> Events:
        self._advance(now_s)
        events = Events(self._targets, self._ended, self._photos)
        self._targets, self._ended, self._photos = [], None, []
        return events

    @property
    def _flies_to(self) -> int | None:
        """The waypoint's place in the route."""
        waypoints = self.held["waypoints"] if self.held and self.has_started else []
        return int(waypoints[self.next]["sequence"]) if self.next < len(waypoints) else None

    @property
    def is_in_air(self) -> bool:
        return self.height_m > 0.0 or self.mode == FLYING

    # --- how it flies ---

    def _start(self, kind: str) -> None:
        if self.held is None:
            raise Refused("There is no mission on it.")
        if kind == "resume":
            self._only_in_air()
        self.is_armed, self.has_started, self.mode = True, True, FLYING
        if not self.height_m:
            self.home = self.place

    def _only_in_air(self) -> None:
        if not self.is_in_air:
            raise Refused("It is not flying.")

    def _advance(self, now_s: float) -> None:
        at_s = now_s if self._now_s is None else self._now_s
        while at_s < now_s:
            dt_s = min(STEP_S, now_s - at_s)
            at_s += dt_s
            self._fly(dt_s, at_s)
        self._now_s = now_s

    def _fly(self, dt_s: float, at_s: float) -> None:
        self._velocity = (0.0, 0.0, 0.0)
        if self.is_in_air:
            self._flown_s += dt_s
        if self.mode == FLYING and self.held is not None:
            self._follow(self.held, dt_s, at_s)
        elif self.mode == RETURNING and self._move(self.home, self.height_m, self._cruise_mps, dt_s):
            self.mode = LANDING
        elif self.mode == LANDING and self._move(self.place, 0.0, self._cruise_mps, dt_s):
            self.mode, self.is_armed = GROUND, False
            if self.has_started and self._ended is None:
                self._ended = "flown" if self.held and self.next >= len(self.held["waypoints"]) else "failed"
                self.has_started = False

    def _follow(self, flight: dict[str, Any], dt_s: float, at_s: float) -> None:
        if self._hover_until_s is not None:
            if at_s < self._hover_until_s:
                return
            self._hover_until_s = None
            if flight["waypoints"][self.next]["task"]["kind"] == "photo":
                self._take_photo(at_s)
            self._pass(flight)
        elif self.next < len(flight["waypoints"]):
            waypoint = flight["waypoints"][self.next]
            speed_mps = self.speed_mps or waypoint["speed_mps"] or flight["cruise_speed_mps"]
            longitude, latitude = waypoint["position"]
            if not self._move((longitude, latitude), waypoint["altitude_relative_m"], speed_mps, dt_s):
                return
            if waypoint["task"]:
                self._hover_until_s = at_s + waypoint["task"]["hold_s"]
                return
            self._pass(flight)
        if self.next >= len(flight["waypoints"]):
            self.mode = {"return": RETURNING, "hover": HOLDING}.get(flight["end_action"], LANDING)

    def _pass(self, flight: dict[str, Any]) -> None:
        place = flight["waypoints"][self.next]["target"]
        self.next += 1
        later = {waypoint["target"] for waypoint in flight["waypoints"][self.next :]}
        if place is not None and place not in later:
            self._targets.append((place, "complete", "seen"))

    def _take_photo(self, at_s: float) -> None:
        """Its camera looks straight down."""
        photo = {
            "position": [round(self.place[0], 8), round(self.place[1], 8)],
            "altitude_relative_m": round(self.height_m, 2),
            "pitch_deg": -90.0,
            "image_index": self._images,
            "waypoint_sequence": self._flies_to,
        }
        self._images += 1
        self._photos.append((at_s, photo))

    @property
    def _cruise_mps(self) -> float:
        return self.speed_mps or (self.held["cruise_speed_mps"] if self.held else 8.0)

    def _move(self, place: tuple[float, float], height_m: float, speed_mps: float, dt_s: float) -> bool:
        """Straight on, and up or down at the same time. Whether it is there."""
        across = math.cos(math.radians(self.place[1])) * METRES_A_DEGREE
        east_m, north_m = (place[0] - self.place[0]) * across, (place[1] - self.place[1]) * METRES_A_DEGREE
        up_m, far_m = height_m - self.height_m, math.hypot(east_m, north_m)
        part = min(1.0, speed_mps * dt_s / far_m) if far_m else 1.0
        climb_m = max(-CLIMB_MPS * dt_s, min(CLIMB_MPS * dt_s, up_m))
        self.place = (self.place[0] + (place[0] - self.place[0]) * part, self.place[1] + (place[1] - self.place[1]) * part)
        self.height_m = height_m if climb_m == up_m else self.height_m + climb_m
        self._velocity = (north_m * part / dt_s, east_m * part / dt_s, climb_m / dt_s)
        return part == 1.0 and self.height_m == height_m
