"""Reasons against flying a mission's stored routes, checked before it is approved and again before it is sent."""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta

from django.conf import settings
from django.utils.translation import gettext as _

from inspection.selectors import ground_heights_m, ground_revision
from inspection.selectors.planning import planning_read
from missions.models import Mission, MissionState, Route
from missions.selectors.fleet import incomplete_uavs
from missions.selectors.missions import mission_of_organisation
from missions.selectors.stale_plans import causes_on_the_routes
from missions.selectors.uav_changes import uav_changes
from missions.services.commands.refused import RefusalReason
from missions.services.manual_edits.still_separated import separation_of_stored
from missions.services.missions import MissionChanged
from missions.services.stored_routes import stored_routes
from operation.reasons import Reason
from planning.checks.wires import spans_in_the_way
from workspace.reason_texts import reason_text

TOO_NEAR = {"too_near", "hovers_in_the_way"}


def reasons_against(mission: Mission, *, now: datetime, is_under_way: bool = False) -> list[RefusalReason]:
    """Return all reasons, for a mission with routes as loaded by selectors.mission_of_organisation; empty where it may be flown.

    A mission under way has departed, and other missions have been deconflicted with it, so departure and separation are skipped.
    """
    flown = [route for route in mission.routes.all() if route.geometry is not None]
    if not flown:
        return [RefusalReason("no_routes", _("The plan reaches no target, so no UAV flies."))]
    return [
        *([] if is_under_way else [*_departure(mission, now), *_separation(mission)]),
        *_reversed_visits(mission),
        *_height_references(mission, flown),
        *_ground(mission),
        *([] if is_under_way else _photos_on_another_map(flown, mission)),
    ]


def _photos_on_another_map(flown: Sequence[Route], mission: Mission) -> list[RefusalReason]:
    """Return a refusal for photos beside wires that were planned before the last change of the map.

    The final look at wires does not see wider crossarms or a higher voltage, which photo flights keep clear of.
    """
    has_photos = any((waypoint.task or {}).get("view") for route in flown for waypoint in route.waypoints.all())
    if not has_photos or mission.ground_revision == ground_revision():
        return []
    return [RefusalReason("photos_outdated", _("The map has changed since photos beside wires were planned. Plan again."))]


def _reversed_visits(mission: Mission) -> list[RefusalReason]:
    """Return refusals for twins in real missions: separation ignores simulated twins, so they may fly only their own copies."""
    if mission.simulates_id is not None:
        return []
    twins = mission.mission_uavs.filter(uav__twin_of__isnull=False).values_list("sequence", "name")
    words = _("%(uav)s is a simulated twin, which flies simulated copies of missions alone. Choose another UAV.")
    return [RefusalReason("simulated_twin", words % {"uav": name}, sequence) for sequence, name in twins]


def incomplete_reasons(mission: Mission, uavs: Collection[int] | None = None) -> list[RefusalReason]:
    """Return a reason for each UAV with a route that lacks its type or range; of `uavs` alone if given."""
    rows = (
        mission.mission_uavs.filter(route__geometry__isnull=False, uav__isnull=False).select_related("uav__uav_type").order_by("sequence")
    )
    chosen = [row for row in rows if uavs is None or row.uav_id in uavs]
    lacking = incomplete_uavs(row.uav for row in chosen if row.uav is not None)
    return [
        RefusalReason("uav_incomplete", reason_text(Reason(f"uav_{lacking[row.uav_id]}", {"uav": row.name})), row.sequence)
        for row in chosen
        if row.uav_id in lacking
    ]


@dataclass(frozen=True)
class ApprovalCheck:
    """Reasons against a mission, computed before its row is locked: that may take seconds, and an abort must not wait for it."""

    mission_revision: int
    ground: int
    is_under_way: bool
    reasons: tuple[RefusalReason, ...]

    def still_counts(self, held: Mission) -> bool:
        """Whether neither the mission nor the map data have changed since. The caller holds the mission's row."""
        now = (held.revision, held.state == MissionState.ACTIVE)
        return now == (self.mission_revision, self.is_under_way) and self.ground == ground_revision()


def check_approval(mission: Mission, *, now: datetime) -> ApprovalCheck | None:
    """Return reasons_against with the mission's revision and the dataset version; None for a deleted mission."""
    ground = ground_revision()
    try:
        loaded = mission_of_organisation(mission.organisation, mission.pk)
    except Mission.DoesNotExist:
        return None
    is_under_way = loaded.state == MissionState.ACTIVE
    return ApprovalCheck(loaded.revision, ground, is_under_way, tuple(reasons_against(loaded, now=now, is_under_way=is_under_way)))


def valid_check(check: ApprovalCheck | None, held: Mission, *, now: datetime) -> ApprovalCheck:
    """Return the check made before the row was locked if it is still valid, else a new one. Raises MissionChanged for a deleted mission."""
    current = check if check is not None and check.still_counts(held) else check_approval(held, now=now)
    if current is None:
        raise MissionChanged
    return current


def _departure(mission: Mission, now: datetime) -> Iterator[RefusalReason]:
    """Yield a reason if the departure has passed: zones and other missions were checked for its time, with a margin."""
    margin = timedelta(seconds=settings.ZONE_RULES.time_margin_s)
    if mission.departs_at is not None and mission.departs_at + margin < now:
        yield RefusalReason("departure_past", _("Its departure is over. Plan it for another time."))


def _height_references(mission: Mission, routes: Sequence[Route]) -> Iterator[RefusalReason]:
    """Yield a reason for each real UAV whose heights are relative to an assumed flat ground."""
    for route in routes:
        uav = route.mission_uav
        is_real = uav.uav is None or not uav.uav.is_simulated
        if is_real and (mission.flat_ground_assumed is not False or any(row.altitude_amsl_m is None for row in route.waypoints.all())):
            words = _("%(uav)s would fly as over flat ground: there is no terrain data here. Only a simulated UAV may.")
            yield RefusalReason("flat_ground", words % {"uav": uav.name}, uav.sequence)


def _ground(mission: Mission) -> Iterator[RefusalReason]:
    """Yield reasons from current zones, bases, assets and terrain, and from masts, wires and bridges beside the routes."""
    for cause in causes_on_the_routes(mission, uav_changes(mission.pk)):
        yield RefusalReason(f"{cause.what}_changed" if cause.what != "zone" else "zone", cause.message, cause.uav)
    routes = stored_routes(mission)
    if routes is None:
        yield RefusalReason("times_not_known", _("The times of a route are not known. Plan it again."))
        return
    names = [row.name for row in mission.mission_uavs.all()]
    for number in sorted(spans_in_the_way(routes, planning_read().ground().network(), ground_heights_m, settings.FLIGHT_RULES)):
        words = _("The route of %(uav)s passes a mast, wires or a bridge too near.") % {"uav": names[number]}
        yield RefusalReason("wires", words, number)


def _separation(mission: Mission) -> Iterator[RefusalReason]:
    found = separation_of_stored(mission)
    for encounter in [] if found is None else found["unresolved"]:
        if encounter["code"] not in TOO_NEAR:
            continue
        others = set(encounter["missions"]) - {None, str(mission.pk)}
        values = {"uavs": _(" and ").join(encounter["uavs"]), "metres": f"{encounter['metres']:.0f}"}
        words = _("%(uavs)s come within %(metres)s m of each other.") % values
        if others:
            names = Mission.objects.filter(pk__in=others).order_by("name").values_list("name", flat=True)
            words = f"{words} {_('The other one flies %(missions)s.') % {'missions': ', '.join(names)}}"
        yield RefusalReason("separation", words)
