"""Current zones across the remaining routes of UAVs."""

from datetime import datetime

from django.core.cache import cache
from django.utils import timezone

from inspection.selectors import ground_revision
from missions.models import Mission, MissionState, ReplanOffer
from missions.selectors.missions import mission_of_organisation
from missions.selectors.stale_plans import leg_names
from missions.selectors.zones import MetZone, flown_route, zones_met
from missions.services.replanning.offers import suggest
from missions.services.replanning.rest import OfferCause, Rest, rests_of

ZONE_ACTIVE = "zone-active"
CHECKED_FOR_S = 3_600


def zone_ahead(rest: Rest, now: datetime) -> MetZone | None:
    """Return the first zone that it would meet; the zone's leg starts at the last waypoint to which it may still fly."""
    if rest.here is None:
        return None
    began_s = now.timestamp() - rest.here.at_s(rest.points)
    (met,) = zones_met([flown_route(rest.route, began_s)])
    ahead = [meeting for meeting in met if meeting.breach.leg >= rest.here.ahead - 1]
    return min(ahead, key=lambda meeting: meeting.breach.leg, default=None)


def suggest_for_zones() -> list[ReplanOffer]:
    """Suggest offers for flying missions when the map data change: once for each zone that crosses a remaining route.

    The cache records each checked mission after its check: if a worker is killed or runs out of time, the next one does the rest. Without
    the cache missions are checked again, but suggested only once.
    """
    revision, now = ground_revision(), timezone.now()
    flying = Mission.objects.filter(state=MissionState.ACTIVE, deleted_at=None).exclude(ground_revision=revision)
    found = []
    for mission in flying.select_related("organisation"):
        checked_at = f"replan-zones:{mission.pk}:{revision}"
        if cache.get(checked_at):
            continue
        loaded = mission_of_organisation(mission.organisation, mission.pk)
        for rest in rests_of(loaded, OfferCause(ZONE_ACTIVE), now):
            met = None if rest.is_out else zone_ahead(rest, now)
            if met is None:
                continue
            uav = None if rest.uav is None else rest.uav.pk
            cause = {
                "zone": met.zone,
                "zone_name": met.name,
                "first_uav": uav,
                "uav_name": rest.name,
                "leg": list(leg_names(rest.route, met.breach.leg)),
            }
            offer = suggest(mission_id=mission.pk, code=ZONE_ACTIVE, cause=cause)
            found += [] if offer is None else [offer]
        cache.set(checked_at, 1, CHECKED_FOR_S)
    return found
