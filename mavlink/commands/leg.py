"""Position of a vehicle relative to the mission leg that it would resume. The way to that leg is unchecked."""

from dataclasses import dataclass

import numpy as np

from inspection.geodesy import LonLat
from inspection.geodesy.local_frame import LocalFrame
from mavlink.intermediate_waypoints import FLOWN, position_of
from mavlink.vehicle_plan import FlightLoad, MissionItem


@dataclass(frozen=True)
class BesideLeg:
    """Offset from a leg.

    `away_m` is the distance over the ground. `above_m` is the height above the higher end, negative below the lower end, 0 in between.
    """

    away_m: float
    above_m: float


def beside_leg(load: FlightLoad, item: int, take_off: LonLat, position: LonLat, relative_m: float) -> BesideLeg | None:
    """Return the offset of a vehicle at `position`, `relative_m` above home, from the leg to the mission item `item`.

    The leg begins at the previous item with a position, else at the take-off. Returns None if no such item is left.
    """
    flown = [(place, position_of(one), one.altitude_m) for place, one in enumerate(load.mission) if one.command in FLOWN]
    ahead = next((number for number, (place, _, _) in enumerate(flown) if place >= item), None)
    if ahead is None:
        return None
    _, end, end_m = flown[ahead]
    _, start, start_m = flown[ahead - 1] if ahead else (0, take_off, 0.0)
    lowest_m, highest_m = min(start_m, end_m), max(start_m, end_m)
    above_m = relative_m - highest_m if relative_m > highest_m else min(relative_m - lowest_m, 0.0)
    return BesideLeg(_away_m(position, start, end), above_m)


def beside_place(item: MissionItem, position: LonLat, relative_m: float) -> BesideLeg:
    """Return the offset from a single place in the air."""
    at = position_of(item)
    return BesideLeg(_away_m(position, at, at), relative_m - item.altitude_m)


def _away_m(position: LonLat, start: LonLat, end: LonLat) -> float:
    here, one, other = LocalFrame.around(*position).to_metres(np.array([position, start, end]))
    along = other - one
    length_m2 = float(along @ along)
    share = 0.0 if length_m2 == 0 else min(max(float((here - one) @ along) / length_m2, 0.0), 1.0)
    return float(np.hypot(*(one + share * along - here)))
