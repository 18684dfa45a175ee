"""Whether the stored routes of a mission keep apart after one of them was changed; nothing is put off or raised."""

from typing import Any

from django.conf import settings

from missions.flight_plan.separation import Separation, closest_encounter, conflicts, separation_json
from missions.flight_selectors import routes_of_mission_in_time
from missions.models import Mission


def separation_of_stored(mission: Mission) -> dict[str, Any] | None:
    """In the shape of the plan's; None where the times of a route are not known."""
    found = routes_of_mission_in_time(mission)
    timed = tuple(route for route in found if route is not None)
    if len(timed) < len(found):
        return None
    rules, layers = settings.SEPARATION_RULES, (mission.separation or {}).get("layers") or [0.0] * len(timed)
    delays = tuple(route.take_off_s for route in timed)
    return separation_json(
        Separation(rules, timed, delays, tuple(layers), closest_encounter(timed, rules=rules), conflicts(timed, rules=rules))
    )
