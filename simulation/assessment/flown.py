"""Flown tracks as input of the assessment: one row for each moment."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from inspection.geodesy import LonLat
from inspection.geodesy.local_frame import LocalFrame
from mavlink.approved_route import Flight, FrozenRoute, FrozenWaypoint
from operation.reasons import Reason

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]
NO_WAYPOINT = -1
MAX_PHOTOS = 5_000  # of a flight: more than a battery lasts for at one a second


class TrackEnding(StrEnum):
    LANDED = "landed"
    HOVERING = "hovering"  # after its last waypoint, as planned
    CRASHED = "crashed"
    UNFINISHED = "unfinished"  # not finished within the time limit
    REFUSED = "refused"  # it did not take off


@dataclass(frozen=True, slots=True)
class FlownPhoto:
    """One photo: the true pose of its lens. t_s as in a track; yaw from true north, pitch from the horizon (negative down).

    `item` is the place of the request in the flight's list, `sequence` its number there; `waypoint` as in a track.
    """

    t_s: float
    position: LonLat
    amsl_m: float
    relative_m: float
    yaw_deg: float
    pitch_deg: float
    roll_deg: float
    waypoint: int
    item: int | None
    sequence: int | None


@dataclass(frozen=True, eq=False)
class FlownTrack:
    """One flight. All columns have n rows.

    t_s             seconds after the mission's departure
    position        (n, 2), lon, lat [deg]
    amsl_m          AMSL, or above the assumed flat ground without terrain data
    relative_m      above this flight's take-off
    battery_percent, used_wh
    waypoint        sequence of the route's waypoint that it flies to, NO_WAYPOINT before and after
    is_coming_down  whether it descends to land
    attitude_deg    (n, 3), roll right wing down, pitch nose up, heading from true north
    photos          the first MAX_PHOTOS
    """

    t_s: FloatArray
    position: FloatArray
    amsl_m: FloatArray
    relative_m: FloatArray
    battery_percent: FloatArray
    used_wh: FloatArray
    waypoint: IntArray
    is_in_air: BoolArray
    is_coming_down: BoolArray
    attitude_deg: FloatArray
    ending: TrackEnding
    stated: tuple[Reason | str, ...] = ()
    photos: tuple[FlownPhoto, ...] = ()

    def __len__(self) -> int:
        return len(self.t_s)

    @property
    def is_over_well(self) -> bool:
        return self.ending in (TrackEnding.LANDED, TrackEnding.HOVERING)


@dataclass(frozen=True, eq=False)
class FlownFlight:
    """A flight of a route with its track; None if it never began, because the previous flight failed."""

    flight: Flight
    track: FlownTrack | None


@dataclass(frozen=True, eq=False)
class AssessedRoute:
    """A UAV's whole route. `uav` is its place in the mission; reserve_percent is the reserve of its plan."""

    uav: int
    name: str
    route: FrozenRoute
    flights: tuple[FlownFlight, ...]
    reserve_percent: float
    planned_wh: float | None = None
    planned_s: float | None = None

    @property
    def tracks(self) -> tuple[FlownTrack, ...]:
        return tuple(flown.track for flown in self.flights if flown.track is not None)


def frame_of(routes: Sequence[AssessedRoute]) -> LocalFrame | None:
    """Return one flat frame for all routes; None if nothing was flown."""
    flown = [track.position for route in routes for track in route.tracks if len(track)]
    if not flown:
        return None
    lon, lat = np.concatenate(flown).mean(axis=0).tolist()
    return LocalFrame.around(lon, lat)


def waypoint_of(flight: Flight, sequence: int) -> FrozenWaypoint | None:
    return next((waypoint for waypoint in flight.waypoints if waypoint.sequence == sequence), None)
