"""Whether a UAV may start now beside those in the air: planned delays separate routes only if they are kept."""

import math
from dataclasses import replace
from datetime import datetime, timedelta

import numpy as np
from django.conf import settings
from django.db.models import Max, Q
from django.utils import timezone
from django.utils.translation import gettext as _

from inspection.geodesy import LonLat
from inspection.network.zones.zone_index import METRES_PER_DEGREE_LAT, METRES_PER_DEGREE_LON
from missions.hooks.in_air import places_in_the_air
from missions.models import CommandAxis, CommandKind, CommandState, Route, Uav, UavCommand, UavState
from missions.selectors.flights import STILL_FLOWN, route_in_time
from missions.services.commands.flight_progress import ON_ITS_WAY
from missions.services.commands.refused import RefusalReason
from planning.rules import SeparationRules
from planning.separation.separation import TimedRoute, conflicts, keep_apart
from workspace.leases import lock_until_end

START_SLOT = "start-slot"  # outcome code of a refused start
OUT_OF_SLOT = "out_of_slot"  # a start's parameter: its user confirmed the take-off although it conflicts
STARTS_LOCK = 0x05A7_0031  # advisory lock, with the organisation
NOT_CONFIRMED = (CommandState.FAILED, CommandState.EXPIRED)
FREE_MARGIN_M = 300.0  # about a route, for UAVs without a known flight, which are steered manually
KEPT_SHARE = 0.5  # of the planned time between two UAVs that must remain after early or late starts


def hold_starts(organisation_id: int) -> None:
    """Lock the starts of an organisation until the end of the transaction."""
    lock_until_end(STARTS_LOCK, organisation_id)


def reasons_to_wait(*, uav: Uav, route: Route, flight: int, now: datetime, given_at: datetime | None = None) -> list[RefusalReason]:
    """Return why this flight cannot start now beside those in the air, with the time to wait; empty where it may.

    given_at: when an already given start was given; starts given later do not count until they are sent. A route that continues in the air
    has no take-off and is not checked.
    """
    if route.begun_by is not None:
        return []
    own = _since(route, flight, started_s=0.0)
    if own is None:
        return []
    timely, untimely, free = _in_the_air(uav, now, given_at)
    place = route.mission_uav.sequence
    planned = settings.SEPARATION_RULES
    values = {"uav": uav.name}
    for other in untimely:
        if _share_an_area(own, other, planned.lateral_m):
            words = _(
                "%(other)s is in the air, not at the times of its plan, and in the area of the route of %(uav)s. Wait until that is down."
            )
            return [RefusalReason("start_slot", words % {**values, "other": other.uav}, place)]
    for name, place_in_air in free:
        if place_in_air is None or _is_near(own, place_in_air, FREE_MARGIN_M):
            words = _(
                "%(other)s is in the air without a flight of a mission, and perhaps in the area of the route of %(uav)s."
                " Wait until that is down."
            )
            return [RefusalReason("start_slot", words % {**values, "other": name}, place)]
    rules = SeparationRules(planned.lateral_m, planned.vertical_m, KEPT_SHARE * planned.time_s)
    found = conflicts([own], timely, rules=rules)
    if not found:
        return []
    apart = keep_apart([own], timely, rules=rules)
    nearest = min(found, key=lambda encounter: (encounter.seconds, encounter.metres))
    values |= {"other": nearest.uavs[1], "metres": f"{nearest.metres:.0f}", "seconds": f"{apart.delays_s[0]:.0f}"}
    if apart.unresolved:
        words = _("Started now, %(uav)s would come within %(metres)s m of %(other)s, which is in the air. Wait until that is down.")
    else:
        words = _(
            "Started now, %(uav)s would come within %(metres)s m of %(other)s, which is in the air. It can be started in %(seconds)s s."
        )
    return [RefusalReason("start_slot", words % values, place)]


def _in_the_air(
    uav: Uav, now: datetime, given_at: datetime | None
) -> tuple[list[TimedRoute], list[TimedRoute], list[tuple[str, LonLat | None]]]:
    """Return the organisation's flights that have started and not ended, in seconds from now; a pending start counts from now.

    First those that are as planned. Then those in the air of which that is unknown: held, commanded to return or to another speed since,
    failed, aborted, or with a start that was sent and not confirmed. Then UAVs in the air without such a flight, for example manually
    flown, by name with their last position.
    """
    since = now - timedelta(seconds=settings.FLIGHT_RULES.longest_flight_s)
    is_real = uav.twin_of_id is None  # twins and other UAVs do not obstruct each other
    waits = Q(state=CommandState.QUEUED) if given_at is None else Q(state=CommandState.QUEUED, created_at__lt=given_at)
    starts = list(
        UavCommand.objects.filter(
            waits | Q(sent_at__gt=since),
            organisation=uav.organisation_id,
            kind=CommandKind.START,
            mission__isnull=False,
            uav__twin_of__isnull=is_real,
        )
        .exclude(uav=uav)
        .select_related("mission")
        .order_by("uav_id", "-sequence")
        .distinct("uav_id")
    )
    uav_ids = [start.uav_id for start in starts]
    later = UavCommand.objects.filter(uav__in=uav_ids, sent_at__gt=since, axis__in=[CommandAxis.FLIGHT, CommandAxis.SPEED])
    last = dict(later.values_list("uav_id").annotate(Max("sequence")))
    others = Uav.objects.filter(organisation=uav.organisation_id, twin_of__isnull=is_real).exclude(pk=uav.pk)
    gone = {"is_simulated": True, "state": UavState.RETIRED}  # possibly in mid-flight; real ones are not retired in the air
    names = dict(others.exclude(**gone).values_list("pk", "name"))
    in_the_air = places_in_the_air(names)
    planned = Route.objects.filter(mission__in=[start.mission_id for start in starts], mission_uav__uav__in=uav_ids)
    routes = {(route.mission_id, route.mission_uav.uav_id): route for route in planned.select_related("mission", "mission_uav")}
    timely, untimely, with_flight = [], [], set()
    for start in starts:
        route = None if start.mission_id is None else routes.get((start.mission_id, start.uav_id))
        flight = int(start.parameters.get("flight", 1))
        if route is None or route.geometry is None:
            continue
        has_ended = route.continued_by_id is not None or route.has_failed or flight <= route.flights_flown
        was_ordered_otherwise = start.state in NOT_CONFIRMED or last.get(start.uav_id, 0) > start.sequence
        if has_ended or was_ordered_otherwise or start.mission is None or start.mission.state not in ON_ITS_WAY:
            flown = _since(route, flight, started_s=0.0) if start.uav_id in in_the_air else None
            untimely += [] if flown is None else [flown]
            with_flight |= set() if flown is None else {start.uav_id}
            continue
        started_s = 0.0 if start.finished_at is None else (start.finished_at - now).total_seconds()
        flown = _since(route, flight, started_s=started_s)
        timely += [] if flown is None else [flown]
        with_flight |= set() if flown is None else {start.uav_id}
    return timely, untimely, [(names[uav_id], place) for uav_id, place in in_the_air.items() if uav_id not in with_flight]


def _share_an_area(one: TimedRoute, other: TimedRoute, margin_m: float) -> bool:
    """Whether the bounding boxes of two routes come within the margin of each other; they include the RTL paths."""
    return _come_near(one, other.position.min(axis=0), other.position.max(axis=0), margin_m)


def _is_near(route: TimedRoute, place: LonLat, margin_m: float) -> bool:
    return _come_near(route, np.array(place), np.array(place), margin_m)


def _come_near(route: TimedRoute, other_low: np.ndarray, other_high: np.ndarray, margin_m: float) -> bool:
    """Whether a box comes within the margin of the bounding box of a route."""
    low, high = route.position.min(axis=0), route.position.max(axis=0)
    metres_per_degree_lon = METRES_PER_DEGREE_LON * max(math.cos(math.radians(low[1])), 0.01)
    margin_deg = margin_m / np.array([metres_per_degree_lon, METRES_PER_DEGREE_LAT])
    return bool(((low - margin_deg <= other_high) & (other_low <= high + margin_deg)).all())


def _since(route: Route, flight: int, *, started_s: float) -> TimedRoute | None:
    """Return one flight of a route as flown with a take-off at started_s; None where its times are unknown."""
    timed = route_in_time(route)
    if timed is None:
        return None
    own = timed if timed.on_ground is None else _flight_of(timed, flight)
    return own.delayed(started_s - own.take_off_s)


def _flight_of(timed: TimedRoute, flight: int) -> TimedRoute:
    """Return one flight, cut at the waypoints where the UAV is on the ground between two flights."""
    assert timed.on_ground is not None  # noqa: S101 - the caller has checked it
    stands = np.flatnonzero(timed.on_ground)
    first = 0 if flight == 1 else int(stands[flight - 2])
    last = len(timed.position) - 1 if flight > len(stands) else int(stands[flight - 1])
    rows = slice(first, last + 1)
    hold_s = timed.hold_s[rows].copy()
    take_off_s, take_off_m, arrival_s = timed.take_off_s, timed.take_off_m, timed.arrival_s[rows].copy()
    if first > 0:
        take_off_s = float(arrival_s[0] + hold_s[0])
        arrival_s[0], hold_s[0], take_off_m = take_off_s, 0.0, float(timed.height_m[first])
    lands_s, landing_m = timed.lands_s, timed.landing_m
    if last < len(timed.position) - 1:
        hold_s[-1] = 0.0
        lands_s, landing_m = float(arrival_s[-1]), float(timed.height_m[last])
    return replace(
        timed, position=timed.position[rows], height_m=timed.height_m[rows], arrival_s=arrival_s, hold_s=hold_s, take_off_s=take_off_s,
        take_off_m=take_off_m, lands_s=lands_s, landing_m=landing_m, on_ground=None,
    )  # fmt: skip


def reasons_to_carry_later(start: UavCommand) -> list[RefusalReason]:
    """Return reasons to delay a start that was given some time ago and is about to be delivered; a sent one may be in the air."""
    if start.parameters.get(OUT_OF_SLOT) or start.sent_at is not None:
        return []
    route = (
        Route.objects.select_related("mission", "mission_uav")
        .filter(mission=start.mission_id, mission_uav__uav=start.uav_id, **STILL_FLOWN)
        .first()
    )
    if route is None:
        return []
    flight = int(start.parameters.get("flight", 1))
    return reasons_to_wait(uav=start.uav, route=route, flight=flight, now=timezone.now(), given_at=start.created_at)
