"""What an import would change for missions that are flown, or that are already onboard UAVs."""

from datetime import timedelta

from django.conf import settings
from django.db.models.functions import Now

from inspection.auto_apply_hooks import AutoApplyRefusal, WrittenGround
from missions.hooks.in_air import uavs_in_the_air
from missions.models import ENDED_STATES, InspectionTarget, MissionState, Route, Waypoint
from missions.selectors.flights import STILL_FLOWN
from operation.reasons import Reason

ON_UAVS = (MissionState.DISPATCHED, MissionState.ACTIVE)
TOUCHES_WITHIN_M = 200.0  # of a route: more than any margin that planning keeps from zones and tall obstacles


def flown_missions_touched(written: WrittenGround) -> list[AutoApplyRefusal]:
    """Return why an import may not be applied automatically; empty where it touches no mission of any organisation.

    An ended mission counts while its UAVs are in the air: those of an aborted one are returning. Assets count within 200 m of a route, or
    as its target or waypoint. Zones count anywhere on a straight return from the route to its take-off, at any height and time.
    """
    touched = {route.mission_id for route in _routes() if _touches(written, route)}
    if not touched:
        return []
    return [AutoApplyRefusal("flown_missions", Reason("touches_flown_missions", {"number": len(touched)}))]


def _routes() -> list[Route]:
    routes = Route.objects.filter(mission__deleted_at=None, **STILL_FLOWN).select_related("mission_uav")
    longest = timedelta(seconds=settings.FLIGHT_RULES.longest_flight_s)
    ended = list(routes.filter(mission__state__in=ENDED_STATES, mission__ended_at__gt=Now() - longest))
    in_the_air = uavs_in_the_air({route.mission_uav.uav_id for route in ended if route.mission_uav.uav_id is not None})
    return [*routes.filter(mission__state__in=ON_UAVS), *(route for route in ended if route.mission_uav.uav_id in in_the_air)]


def _touches(written: WrittenGround, route: Route) -> bool:
    assets = set(Waypoint.objects.filter(route=route, asset__isnull=False).values_list("asset", flat=True))
    assets |= set(InspectionTarget.objects.filter(mission=route.mission_id, asset__isnull=False).values_list("asset", flat=True))
    if written.changes_any_of(assets):
        return True
    line = route.geometry
    return line is not None and (
        written.has_assets_within(line, TOUCHES_WITHIN_M) or written.has_zones_within(line.convex_hull, TOUCHES_WITHIN_M)
    )
