"""The flight through the photos of a target, as waypoints of a route: from above the target, and back to there."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from inspection.geodesy.local_frame import LocalFrame
from planning.task import TURN_S, View
from planning.views.camera import Gimbal
from planning.views.solids import FloatArray
from planning.views.view_flight import NO_PHOTO, SAME_PLACE_M
from planning.views.view_plan import ViewPlan
from planning.views.visibility import BoolArray

SPEED_MPS = 4.0  # from photo to photo, beside wires
BEND_HOLD_S = 1.0  # where the flight bends: the UAV stops, so that it does not cut the corner
MAX_OFF_M = 0.4  # of the height above ground at a place from the straight line between those of the waypoints
WHOLE_TURN_DEG = 350.0  # a range of pan above which any direction is reached
STEP_M = 2.0  # between places whose ground is looked at
POSITION_DIGITS, HEIGHT_DIGITS, ANGLE_DIGITS = 8, 2, 1


class GroundUnknown(ValueError):
    """The ground is not known under the whole flight: its heights would have no reference."""


@dataclass(frozen=True, eq=False)
class PhotoFlight:
    """Waypoints, from one above the target's axis back to there; straight from each to the next.

    position float64 (n, 2), lon lat [deg]; amsl_m, agl_m (n,); stops (n,) of bool: whether the UAV stops there, as it does at photos.
    view: of a waypoint with a photo, by its place. clearance_m: kept from wires and supports. seconds: with all stops.
    """

    position: FloatArray
    amsl_m: FloatArray
    agl_m: FloatArray
    stops: BoolArray
    view: Mapping[int, View]
    clearance_m: float
    length_m: float
    seconds: float

    def __len__(self) -> int:
        return len(self.position)

    def to_json(self) -> dict[str, Any]:
        return {
            "position": self.position.tolist(), "amsl_m": self.amsl_m.tolist(), "agl_m": self.agl_m.tolist(), "stops": self.stops.tolist(),
            "view": {str(place): vars(view) for place, view in self.view.items()},
            "clearance_m": self.clearance_m, "length_m": self.length_m, "seconds": self.seconds,
        }  # fmt: skip

    @classmethod
    def from_json(cls, value: Mapping[str, Any]) -> "PhotoFlight":
        position, amsl_m, agl_m = (np.array(value[name], dtype=np.float64) for name in ("position", "amsl_m", "agl_m"))
        views = {int(place): View(**view) for place, view in value["view"].items()}
        stops = np.array(value["stops"], dtype=np.bool_)
        return cls(position, amsl_m, agl_m, stops, views, value["clearance_m"], value["length_m"], value["seconds"])


def photo_flight(
    plan: ViewPlan, frame: LocalFrame, base_amsl_m: float, ground_m: Callable[[FloatArray], FloatArray], clearance_m: float,
    gimbal: Gimbal,
) -> PhotoFlight:  # fmt: skip
    """Return the flight of a plan whose heights count from the target's foot, base_amsl_m above the sea.

    ground_m: of places (n, 2) [m], over that. Waypoints are put in where the ground bends, so that heights above it are straight lines
    between waypoints, but for MAX_OFF_M. Raises GroundUnknown.
    """
    flight, turns_nose = plan.flight, not _pans_around(gimbal)
    points, photos = [flight.position[0]], [int(flight.photo[0])]
    stops = [True]
    for (start, end), photo in zip(pairwise(flight.position), flight.photo[1:].tolist(), strict=True):
        if photo == NO_PHOTO and np.linalg.norm(end - start) < SAME_PLACE_M:
            continue
        bends = _ground_bends(start, end, ground_m)
        points += [*bends, end]
        photos += [NO_PHOTO] * len(bends) + [photo]
        stops += [False] * len(bends) + [True]
    position = np.array(points)
    agl_m = position[:, 2] - ground_m(position[:, :2])
    if np.isnan(agl_m).any():
        raise GroundUnknown
    yaw_deg, pitch_deg = np.round(plan.poses.yaw_deg, ANGLE_DIGITS) % 360.0, np.round(plan.poses.pitch_deg, ANGLE_DIGITS)
    views = {
        place: View(
            float(yaw_deg[photo]), float(pitch_deg[photo]), round(float(plan.distance_m[photo]), HEIGHT_DIGITS), plan.lens.focal_mm,
            round(clearance_m, HEIGHT_DIGITS), float(yaw_deg[photo]) if turns_nose else None,
        )
        for place, photo in enumerate(photos) if photo != NO_PHOTO
    }  # fmt: skip
    return PhotoFlight(
        np.round(frame.to_degrees(position[:, :2]), POSITION_DIGITS),
        np.round(position[:, 2] + base_amsl_m, HEIGHT_DIGITS),
        np.round(agl_m, HEIGHT_DIGITS),
        np.array(stops, dtype=np.bool_),
        views,
        clearance_m,
        flight.length_m,
        plan.seconds + (TURN_S * len(views) if turns_nose else 0.0),
    )


def _pans_around(gimbal: Gimbal) -> bool:
    """Whether the camera looks in every direction without the UAV's turning for it on purpose.

    Without a range of yaw the UAV follows the region of interest by itself.
    """
    low_deg, high_deg = gimbal.yaw_min_deg, gimbal.yaw_max_deg
    return low_deg is None or high_deg is None or high_deg - low_deg >= WHOLE_TURN_DEG


def _ground_bends(start: FloatArray, end: FloatArray, ground_m: Callable[[FloatArray], FloatArray]) -> list[FloatArray]:
    """Places on the straight way from start to end, (3,) each, between which the ground is nearly straight."""
    count = int(np.ceil(np.linalg.norm((end - start)[:2]) / STEP_M))
    if count < 2:
        return []
    way = start + (end - start) * np.linspace(0.0, 1.0, count + 1)[:, None]
    under_m = ground_m(way[:, :2])
    if np.isnan(under_m).any():
        raise GroundUnknown
    chosen: list[int] = []
    todo = [(0, count)]
    while todo:
        first, last = todo.pop()
        inner = np.arange(first + 1, last)
        if not len(inner):
            continue
        straight_m = under_m[first] + (under_m[last] - under_m[first]) * (inner - first) / (last - first)
        off_m = np.abs(under_m[inner] - straight_m)
        if off_m.max() > MAX_OFF_M:
            middle = int(inner[off_m.argmax()])
            chosen.append(middle)
            todo += [(first, middle), (middle, last)]
    return [way[place] for place in sorted(chosen)]
