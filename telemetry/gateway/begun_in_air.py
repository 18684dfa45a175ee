"""With which item a UAV that is held in the air begins its route: it may be anywhere on the first part of the way."""

from django.conf import settings

from mavlink.commands.leg import BesideLeg, beside_leg, beside_place
from mavlink.intermediate_waypoints import FLOWN
from mavlink.vehicle_plan import FlightLoad
from mavlink.vehicle_state import VehicleState

SAME_M = 1.0  # of two legs that are as near it is on the first


def item_to_begin_with(load: FlightLoad, begun_by: int, state: VehicleState) -> int | None:
    """The item, from 0 without home, to which the leg leads on which the vehicle is; None where it is on none until `begun_by`.

    `begun_by` is a waypoint of the route. The first leg has no beginning: it is the first item's place.
    """
    places = [number for number, item in enumerate(load.mission) if item.command in FLOWN]
    last = max((number for number in places if load.mission[number].waypoint == begun_by), default=None)
    if last is None or state.position is None or state.altitude_relative_m is None:
        return None
    found, nearest_m = None, settings.RESUME_DISTANCE_M
    beside: BesideLeg | None
    for number in (place for place in places if place <= last):
        if number == places[0]:
            beside = beside_place(load.mission[number], state.position, state.altitude_relative_m)
        else:
            beside = beside_leg(load, number, state.position, state.position, state.altitude_relative_m)
        if beside is None or abs(beside.above_m) > settings.TAKE_OFF_HEIGHT_M:
            continue
        if beside.away_m <= nearest_m - (0.0 if found is None else SAME_M):
            found, nearest_m = number, beside.away_m
    return found
