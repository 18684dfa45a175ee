"""Flies all routes of a mission together: each UAV flies its approved items, in lock-step of simulated time."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np

from inspection.geodesy import LonLat
from mavlink.approved_route import HOVER, Flight, FrozenRoute
from mavlink.vehicle_plan import MissionItem
from operation.reasons import Reason
from simulation.assessment.flown import MAX_PHOTOS, NO_WAYPOINT, AssessedRoute, FlownFlight, FlownPhoto, FlownTrack, TrackEnding
from simulation.flight.events import PhotoTaken

TAKE_OFF, LAND_ITEM = 22, 21  # MAV_CMD_NAV_TAKEOFF, MAV_CMD_NAV_LAND
STEP_S = 0.04  # of a UAV's step
STEPS_A_SAMPLE = 5
TOGETHER_S = 1.0  # maximum lead of one UAV over another
HOVERS_S = 10.0  # after its last waypoint, until a flight that ends there is over
TIMEOUT = 3.0  # factor on the planned duration
TIMEOUT_S = 600.0  # in addition: after both a flight counts as unfinished
UP_THERE = 0.95  # of a take-off's height


class RehearsedVehicle(Protocol):
    """The part of a simulated UAV that a rehearsal uses; see simulation.flight.uav.SimulatedUav."""

    @property
    def now_s(self) -> float: ...
    @property
    def state(self) -> Any: ...
    def step(self) -> None: ...
    def load(self, items: Sequence[MissionItem], rally: Sequence[MissionItem]) -> Any: ...
    def arm(self) -> Any: ...
    def take_off(self, height_relative_m: float) -> Any: ...
    def start_mission(self) -> Any: ...
    def take_texts(self) -> Sequence[Reason | str]: ...
    def take_photos(self) -> Sequence[PhotoTaken]: ...


@dataclass(frozen=True)
class Start:
    """Start of a flight; `seed` is that of this flight."""

    uav: int
    flight: int
    home: LonLat
    ground_amsl_m: float | None
    heading_deg: float
    seed: int


MakeVehicle = Callable[[Start], RehearsedVehicle]
OnProgress = Callable[[float], None]


@dataclass(frozen=True, eq=False)
class RouteToFly:
    """A route with the items and rally points of each flight. planned_s is its planned duration.

    limit_mps: the UAV's airspeed limit in plans.
    """

    uav: int
    name: str
    route: FrozenRoute
    items: tuple[tuple[MissionItem, ...], ...]
    reserve_percent: float
    planned_wh: float | None = None
    planned_s: float | None = None
    rally: tuple[tuple[MissionItem, ...], ...] = ()
    limit_mps: float = math.inf


def fly(routes: Sequence[RouteToFly], make: MakeVehicle, *, turnaround_s: float, seed: int, on_progress: OnProgress) -> list[AssessedRoute]:
    """Fly all routes from the first take-off to the last landing. on_progress receives the completed share and may raise to stop."""
    flyers = [_Flyer(route, make, turnaround_s, seed * 1_000 + number) for number, route in enumerate(routes)]
    now_s = min((flyer.next_s for flyer in flyers), default=math.inf)
    while not all(flyer.is_over for flyer in flyers):
        now_s = max(now_s + TOGETHER_S, min(flyer.next_s for flyer in flyers if not flyer.is_over))
        for flyer in flyers:
            flyer.fly_until(now_s)
        on_progress(sum(flyer.share for flyer in flyers) / len(flyers))
    return [flyer.flown() for flyer in flyers]


@dataclass(eq=False)
class _Rows:
    """A track during its flight."""

    rows: list[tuple[float, ...]] = field(default_factory=list)
    texts: list[Reason | str] = field(default_factory=list)
    photos: list[FlownPhoto] = field(default_factory=list)


class _Flyer:
    """One UAV through all flights of its route, each with a new battery."""

    def __init__(self, route: RouteToFly, make: MakeVehicle, turnaround_s: float, seed: int) -> None:
        self._route, self._make, self._turnaround_s, self._seed = route, make, turnaround_s, seed
        self._flights = route.route.flights
        self._flown: list[FlownFlight] = []
        self._vehicle: RehearsedVehicle | None = None
        self._rows = _Rows()
        self._begins_s = route.route.departs_s
        self._was_up = self._is_waiting_to_start = False
        self._complete_s = math.inf
        self._failed = False

    @property
    def is_over(self) -> bool:
        return self._failed or len(self._flown) >= len(self._flights)

    @property
    def next_s(self) -> float:
        """Return when its next step is due, after the mission's departure."""
        if self.is_over:
            return math.inf
        return self._begins_s if self._vehicle is None else self._begins_s + self._vehicle.now_s

    @property
    def share(self) -> float:
        """Return the completed share of its route, by planned times."""
        if self.is_over:
            return 1.0
        begun = 0.0 if self._vehicle is None else min(self._vehicle.now_s / max(self._planned_s(self._flight), 1.0), 1.0)
        return (len(self._flown) + begun) / len(self._flights)

    def fly_until(self, now_s: float) -> None:
        while not self.is_over and self.next_s < now_s - 1e-9:
            if self._vehicle is None:
                self._begin()
            else:
                self._sample_and_step(self._vehicle)

    def flown(self) -> AssessedRoute:
        route = self._route
        missing = tuple(FlownFlight(flight, None) for flight in self._flights[len(self._flown) :])
        return AssessedRoute(
            route.uav, route.name, route.route, (*self._flown, *missing), route.reserve_percent, route.planned_wh, route.planned_s
        )

    @property
    def _flight(self) -> Flight:
        return self._flights[len(self._flown)]

    @property
    def _items(self) -> tuple[MissionItem, ...]:
        return self._route.items[len(self._flown)]

    def _planned_s(self, flight: Flight) -> float:
        known = [waypoint.arrival_s for waypoint in flight.waypoints if waypoint.arrival_s is not None]
        return max(max(known) - min(known), 60.0) if known else 600.0

    def _begin(self) -> None:
        flight = self._flight
        self._rows, self._was_up, self._complete_s = _Rows(), False, math.inf
        seed = self._seed * 100 + flight.number
        start = Start(self._route.uav, flight.number, flight.take_off.position, flight.take_off.altitude_amsl_m, _heading_deg(flight), seed)
        self._vehicle = vehicle = self._make(start)
        self._note(vehicle)
        has_take_off = bool(self._items) and self._items[0].command == TAKE_OFF
        self._is_waiting_to_start = not has_take_off
        rally = self._route.rally[len(self._flown)] if self._route.rally else ()
        orders = [vehicle.load(self._items, rally), vehicle.arm()]
        orders.append(vehicle.start_mission() if has_take_off else vehicle.take_off(flight.waypoints[0].altitude_relative_m))
        refused = next((order for order in orders if not order.is_done), None)
        if refused is not None:
            self._rows.texts.append(refused.words)
            self._end(TrackEnding.REFUSED)

    def _sample_and_step(self, vehicle: RehearsedVehicle) -> None:
        for _ in range(STEPS_A_SAMPLE):
            vehicle.step()
        self._note(vehicle)
        state = vehicle.state
        self._was_up = self._was_up or state.is_in_air
        if self._is_waiting_to_start and state.altitude_relative_m >= UP_THERE * self._flight.waypoints[0].altitude_relative_m:
            self._is_waiting_to_start = False
            vehicle.start_mission()
        if state.mission_state == "complete" and math.isinf(self._complete_s):
            self._complete_s = vehicle.now_s
        if state.is_crashed:
            self._end(TrackEnding.CRASHED)
        elif self._was_up and not state.is_in_air and not state.is_armed:
            self._end(TrackEnding.LANDED)
        elif self._flight.end_action == HOVER and vehicle.now_s >= self._complete_s + HOVERS_S:
            self._end(TrackEnding.HOVERING)
        elif vehicle.now_s > TIMEOUT * self._planned_s(self._flight) + TIMEOUT_S:
            self._end(TrackEnding.UNFINISHED)

    def _note(self, vehicle: RehearsedVehicle) -> None:
        state = vehicle.state
        index = state.current_item
        item = self._items[index] if 0 <= index < len(self._items) else None
        is_on_mission = state.mode == "mission" and item is not None
        waypoint = NO_WAYPOINT if item is None or item.waypoint is None or not is_on_mission else item.waypoint
        is_coming_down = state.mode in ("land", "return") or (is_on_mission and item is not None and item.command == LAND_ITEM)
        lon, lat = state.true_position
        self._rows.rows.append((
            self._begins_s + vehicle.now_s, lon, lat, state.altitude_amsl_m, state.altitude_relative_m, state.battery_percent,
            state.battery_used_wh, waypoint, state.is_in_air, is_coming_down, state.roll_deg, state.pitch_deg, state.heading_deg,
        ))  # fmt: skip
        self._rows.texts += vehicle.take_texts()
        self._rows.photos += map(self._photo, vehicle.take_photos())

    def _photo(self, taken: PhotoTaken) -> FlownPhoto:
        pose = taken.pose
        waypoint = None if taken.item is None else self._items[taken.item].waypoint
        return FlownPhoto(
            self._begins_s + taken.at_s, pose.position, pose.altitude_amsl_m, pose.altitude_relative_m, pose.yaw_deg, pose.pitch_deg,
            pose.roll_deg, NO_WAYPOINT if waypoint is None else waypoint, taken.item, taken.sequence,
        )  # fmt: skip

    def _end(self, ending: TrackEnding) -> None:
        columns = np.array(self._rows.rows, dtype=np.float64)
        track = FlownTrack(
            t_s=columns[:, 0],
            position=columns[:, 1:3],
            amsl_m=columns[:, 3],
            relative_m=columns[:, 4],
            battery_percent=columns[:, 5],
            used_wh=columns[:, 6],
            waypoint=columns[:, 7].astype(np.int64),
            is_in_air=columns[:, 8].astype(bool),
            is_coming_down=columns[:, 9].astype(bool),
            attitude_deg=columns[:, 10:13],
            ending=ending,
            stated=tuple(self._rows.texts),
            photos=tuple(self._rows.photos[:MAX_PHOTOS]),
        )
        self._flown.append(FlownFlight(self._flight, track))
        self._begins_s, self._vehicle = float(track.t_s[-1]) + self._turnaround_s, None
        self._failed = not track.is_over_well


def _heading_deg(flight: Flight) -> float:
    """Return the heading at the start: towards the second waypoint."""
    if len(flight.waypoints) < 2:
        return 0.0
    (lon, lat), (to_lon, to_lat) = flight.waypoints[0].position, flight.waypoints[1].position
    east, north = (to_lon - lon) * math.cos(math.radians(lat)), to_lat - lat
    return math.degrees(math.atan2(east, north)) % 360.0
