"""What has changed since a mission was planned, and what it affects: which zone, leg, target or base."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any

import numpy as np
from django.db.models import Exists, OuterRef
from django.utils import timezone
from django.utils.translation import gettext as _

from inspection.models import Asset
from inspection.selectors import ground_heights_m, ground_revision
from missions.models import Base, Mission, MissionState, Route
from missions.selectors.ahead import WayAhead, ways_ahead
from missions.selectors.uav_changes import UavChange, uav_change_words
from missions.selectors.zones import MetZone, departure_s, flown_route, zones_met
from planning.clearance.zone_clearance import TAKE_OFF, FloatArray, FlownRoute
from planning.trajectory.waypoints import WaypointKind

TERRAIN_CHANGED_M = 1.0  # smaller differences come from another sampling of the same terrain
MAX_CAUSES = 20


@dataclass(frozen=True)
class StaleCause:
    """One change and the part of the mission it affects. `uav` and `target` are places in the mission."""

    what: str  # zone, uav, base, asset, terrain or elsewhere
    message: str
    uav: int | None = None
    target: int | None = None
    leg: tuple[str, str] | None = None  # "A1", "A2"; a flight's start and end are empty
    position: tuple[float, float] | None = None
    agl_m: tuple[float, float] | None = None  # lowest and highest where it meets a zone
    times: tuple[datetime, datetime] | None = None  # from and to


def landing_routes_without_base() -> Exists:
    """Return an expression for missions: whether one of their routes lands at a base that no longer exists."""
    bases = Base.objects.filter(organisation=OuterRef("mission__organisation"), location=OuterRef("lands_at"))
    return Exists(Route.objects.filter(~Exists(bases), mission=OuterRef("pk"), lands_at__isnull=False))


def bases_landed_at(missions: Sequence[Mission], organisation_id: int) -> frozenset[tuple[float, ...]]:
    """Return positions (lon, lat) of the organisation's bases if any route of its missions lands at one; else empty, without a query."""
    if not any(route.lands_at is not None for mission in missions for route in mission.routes.all()):
        return frozenset()
    return frozenset(location.coords for location in Base.objects.filter(organisation=organisation_id).values_list("location", flat=True))


def has_lost_base(mission: Mission, bases: frozenset[tuple[float, ...]]) -> bool:
    """Whether the mission, with routes loaded, lands at a base that no longer exists."""
    return any(route.lands_at is not None and route.lands_at.coords not in bases for route in mission.routes.all())


def is_stale(mission: Mission, revision: int, *, has_lost_base: bool, has_other_uavs: bool) -> bool:
    """Whether assets, zones, terrain, the bases to land at or the UAVs have changed since the mission was planned.

    `revision` is the current dataset version, `has_other_uavs` comes from uav_change_selectors.
    """
    return mission.state != MissionState.DRAFT and (mission.ground_revision != revision or has_lost_base or has_other_uavs)


def stale_causes(mission: Mission, uavs: Sequence[UavChange]) -> list[StaleCause]:
    """Return what the changes mean for the mission, worst first; empty if nothing changed. `uavs`: its uav_changes."""
    if not is_stale(mission, ground_revision(), has_lost_base=False, has_other_uavs=False):
        return [*_uavs(mission, uavs), *_bases(mission)]
    return causes_on_the_routes(mission, uavs) or [StaleCause("elsewhere", _("No zone in force touches the routes."))]


def causes_on_the_routes(mission: Mission, uavs: Sequence[UavChange]) -> list[StaleCause]:
    """Return what makes the stored routes invalid on the current map data, worst first, whatever they were planned on."""
    causes = [*_zones(mission), *_uavs(mission, uavs), *_bases(mission), *_vanished_targets(mission), *_passed_assets_gone(mission)]
    return (causes or _terrain(mission))[:MAX_CAUSES]


def stale_reason(causes: list[StaleCause]) -> str:
    """Return a headline with the worst cause; empty where there is none."""
    if not causes:
        return ""
    headline = {
        "zone": _("A zone changed since this was planned."),
        "uav": _("A UAV changed since this was planned."),
        "base": _("A base changed since this was planned."),
        "asset": _("An asset changed since this was planned."),
        "terrain": _("The terrain changed since this was planned."),
        "elsewhere": _("The ground has changed since this was planned."),
    }[causes[0].what]
    return f"{headline} {causes[0].message}"


def cause_json(cause: StaleCause) -> dict[str, Any]:
    return {
        "what": cause.what,
        "message": cause.message,
        "uav": cause.uav,
        "target": cause.target,
        "leg": list(cause.leg) if cause.leg else None,
        "position": list(cause.position) if cause.position else None,
        "agl_m": list(cause.agl_m) if cause.agl_m else None,
        "from": cause.times[0] if cause.times else None,
        "to": cause.times[1] if cause.times else None,
    }


def _zones(mission: Mission) -> list[StaleCause]:
    """Return conflicts of the routes with current zones, at the mission's time if it has one, else at any time.

    For a flying mission only the remaining legs count, at the times at which they are flown now.
    """
    if mission.state == MissionState.ACTIVE:
        ways = ways_ahead(mission, timezone.now())
    else:
        begins_s = departure_s(mission)
        ways = [WayAhead(route, flown_route(route, begins_s), TAKE_OFF) for route in mission.routes.all() if route.geometry is not None]
    causes = []
    for way, met in zip(ways, zones_met([way.flown for way in ways]), strict=True):
        ahead = [meeting for meeting in met if meeting.breach.leg >= way.first_leg]
        causes += _zone_causes(way.route, way.flown, ahead)
    return causes


def _zone_causes(route: Route, flown: FlownRoute, met: Sequence[MetZone]) -> list[StaleCause]:
    """Return one cause per zone and pair of neighbouring targets between which the route meets it."""
    parts: dict[tuple[int, tuple[str, str]], list[MetZone]] = {}
    for meeting in met:
        parts.setdefault((meeting.zone, leg_names(route, meeting.breach.leg)), []).append(meeting)
    causes = []
    for (_zone, ends), meetings in parts.items():
        first = _waypoints_of(meetings[0].breach.leg, flown)
        heights_m = np.concatenate([_heights_m(meeting.breach.leg, flown) for meeting in meetings])
        agl_m = float(heights_m.min()), float(heights_m.max())
        times = _times(meetings)
        causes.append(
            StaleCause(
                "zone",
                f"{_leg_words(meetings[0].name, ends, route.mission_uav.name)} {_how_high(agl_m)}",
                route.mission_uav.sequence,
                leg=ends,
                position=(float(flown.position[first, 0].mean()), float(flown.position[first, 1].mean())),
                agl_m=agl_m,
                times=times,
            )
        )
    return causes


def _waypoints_of(leg: int, flown: FlownRoute) -> list[int]:
    """Return the waypoints at a leg's ends; the vertical columns at start and end have one."""
    return [max(leg, 0), min(leg + 1, len(flown.position) - 1)]


def _heights_m(leg: int, flown: FlownRoute) -> FloatArray:
    """Return the heights above ground at a leg's ends [m]."""
    on_ground = leg < 0 or (flown.lands and leg == len(flown.position) - 1)
    return np.append(flown.agl_m[_waypoints_of(leg, flown)], [0.0] if on_ground else [])


def _times(meetings: Sequence[MetZone]) -> tuple[datetime, datetime] | None:
    known = [(meeting.breach.from_s, meeting.breach.to_s) for meeting in meetings]
    starts, ends = [start for start, _end in known if start is not None], [end for _start, end in known if end is not None]
    if len(starts) < len(known) or len(ends) < len(known):
        return None
    return datetime.fromtimestamp(min(starts), UTC), datetime.fromtimestamp(max(ends), UTC)


def _how_high(agl_m: tuple[float, float]) -> str:
    low, high = (f"{height_m:.0f}" for height_m in agl_m)
    heights = low if low == high else _("%(low)s to %(high)s") % {"low": low, "high": high}
    return _("It is flown %(heights)s m above ground.") % {"heights": heights}


def leg_names(route: Route, leg: int) -> tuple[str, str]:
    """The targets before and after a leg, as the map numbers them."""
    letter = route_letter(route.mission_uav.sequence)
    visits = [place for place, waypoint in enumerate(route.waypoints.all()) if waypoint.kind == WaypointKind.TARGET]
    before = sum(place <= leg for place in visits)
    return f"{letter}{before}" if before else "", f"{letter}{before + 1}" if before < len(visits) else ""


def _leg_words(zone: str, ends: tuple[str, str], uav: str) -> str:
    values = {"zone": zone, "start": ends[0], "end": ends[1], "uav": uav}
    if all(ends):
        return _("%(zone)s touches the leg from %(start)s to %(end)s of %(uav)s.") % values
    if ends[1]:
        return _("%(zone)s touches the leg from the start to %(end)s of %(uav)s.") % values
    if ends[0]:
        return _("%(zone)s touches the leg after %(start)s of %(uav)s.") % values
    return _("%(zone)s touches the route of %(uav)s.") % values


def route_letter(sequence: int) -> str:
    """Return A to Z, then AA, as on the map."""
    return chr(65 + sequence) if sequence < 26 else f"{chr(64 + sequence // 26)}{chr(65 + sequence % 26)}"


def _uavs(mission: Mission, changes: Sequence[UavChange]) -> list[StaleCause]:
    if mission.state == MissionState.DRAFT:
        return []
    return [StaleCause("uav", uav_change_words(change), change.uav) for change in changes if change.concerns_plan]


def _bases(mission: Mission) -> list[StaleCause]:
    landing = [(route, (route.lands_at.x, route.lands_at.y)) for route in mission.routes.all() if route.lands_at is not None]
    if mission.state == MissionState.DRAFT or not landing:
        return []
    bases = bases_landed_at([mission], mission.organisation_id)
    return [
        StaleCause(
            "base",
            _("%(uav)s is to land at %(base)s, which is no longer there.") % {"uav": route.mission_uav.name, "base": route.base_name},
            route.mission_uav.sequence,
            position=place,
        )
        for route, place in landing
        if place not in bases
    ]


def _vanished_targets(mission: Mission) -> list[StaleCause]:
    return [
        StaleCause(
            "asset",
            _("%(asset)s is no longer in the data.") % {"asset": target.label},
            target=target.sequence,
            position=(target.asset.centre.x, target.asset.centre.y),
        )
        for target in mission.targets.all()
        if target.asset is not None and target.asset.vanished_at is not None
    ]


def _passed_assets_gone(mission: Mission) -> list[StaleCause]:
    waypoints = (waypoint for route in mission.routes.all() for waypoint in route.waypoints.all())
    passed = {waypoint.asset_id for waypoint in waypoints if waypoint.asset_id is not None}
    targets = {target.asset_id for target in mission.targets.all()}
    gone = set(Asset.objects.filter(vanished_at__isnull=False, pk__in=passed - targets).values_list("pk", flat=True))
    causes: dict[int, StaleCause] = {}
    for route in mission.routes.all():
        for waypoint in route.waypoints.all():
            if waypoint.asset_id in gone:
                words = _("The route of %(uav)s passes something that is no longer in the data.") % {"uav": route.mission_uav.name}
                where = (waypoint.position.x, waypoint.position.y)
                causes.setdefault(route.pk, StaleCause("asset", words, route.mission_uav.sequence, position=where))
    return list(causes.values())


def _terrain(mission: Mission) -> list[StaleCause]:
    """Return a cause if the terrain under the waypoints differs from the one planned over; that height is AMSL less AGL."""
    waypoints = [(route, waypoint) for route in mission.routes.all() for waypoint in route.waypoints.all()]
    if not waypoints:
        return []
    now_m = ground_heights_m(np.array([waypoint.position.coords for _route, waypoint in waypoints]))
    then_m = np.array([
        np.nan if waypoint.altitude_amsl_m is None else waypoint.altitude_amsl_m - waypoint.altitude_agl_m
        for _route, waypoint in waypoints
    ])  # fmt: skip
    off_m = np.abs(now_m - then_m)
    if (off_m > TERRAIN_CHANGED_M).any():
        worst = int(np.nanargmax(off_m))
        route, waypoint = waypoints[worst]
        values = {"uav": route.mission_uav.name, "height": f"{off_m[worst]:.0f}"}
        words = _("Under the route of %(uav)s it differs by up to %(height)s m.") % values
        return [StaleCause("terrain", words, route.mission_uav.sequence, position=(waypoint.position.x, waypoint.position.y))]
    if (~np.isnan(then_m) & np.isnan(now_m)).any():
        return [StaleCause("terrain", _("Under a route it is no longer known."))]
    for route in mission.routes.all():
        under = [height for (own, _waypoint), height in zip(waypoints, now_m.tolist(), strict=True) if own is route]
        if under and not np.isnan(under).any() and route.waypoints.all()[0].altitude_amsl_m is None:
            words = _("Terrain has come in: %(uav)s flies as over flat ground.") % {"uav": route.mission_uav.name}
            return [StaleCause("terrain", words, route.mission_uav.sequence)]
    return []
