"""Separation of a mission's stored routes after an edit; no route is delayed or raised."""

from typing import Any

from django.conf import settings

from missions.models import Mission
from missions.selectors.flights import flights_at_the_same_time, routes_of_mission_in_time
from planning.context import OtherFlights
from planning.separation.report import separation_json
from planning.separation.separation import Separation, closest_encounter, conflicts


def separation_of_stored(mission: Mission) -> dict[str, Any] | None:
    """Return the separation in the shape of the plan's; None where the times of a route are unknown."""
    found = routes_of_mission_in_time(mission)
    timed = tuple(route for route in found if route is not None)
    if len(timed) < len(found):
        return None
    others = _others(mission, max((route.end_s for route in timed), default=0.0))
    rules, layers = settings.SEPARATION_RULES, (mission.separation or {}).get("layers") or [0.0] * len(timed)
    delays = tuple(route.take_off_s for route in timed)
    closest = closest_encounter(timed, others.routes, rules=rules)
    left = conflicts(timed, others.routes, rules=rules)
    return separation_json(Separation(rules, timed, delays, tuple(layers), closest, left), others.untimed)


def _others(mission: Mission, ends_s: float) -> OtherFlights:
    if mission.departs_at is None:
        return OtherFlights()
    from_s = mission.departs_at.timestamp()
    to_s = from_s + max(ends_s, settings.FLIGHT_RULES.longest_flight_s)
    return flights_at_the_same_time(mission.organisation_id, from_s, to_s, but=mission.pk)
