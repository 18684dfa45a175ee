"""Whether a UAV may be started now, beside those that are in the air: planned delays keep routes apart only if they are kept."""

from dataclasses import replace
from datetime import datetime, timedelta

import numpy as np
from django.conf import settings
from django.db.models import Q
from django.utils import timezone
from django.utils.translation import gettext as _

from missions.flight_plan.rules import SeparationRules
from missions.flight_plan.separation import TimedRoute, conflicts, keep_apart
from missions.flight_selectors import STILL_FLOWN, route_in_time
from missions.models import OPEN_COMMANDS, CommandKind, CommandState, Route, Uav, UavCommand
from missions.services.flying import ON_ITS_WAY
from missions.services.refused import Reason

OUT_OF_SLOT = "out_of_slot"  # a start's parameter: whoever gave it has answered that it is to take off all the same
KEPT_SHARE = 0.5  # of the planned time between two UAVs, which has to be left after all that a start is late or early


def reasons_to_wait(*, uav: Uav, route: Route, flight: int, now: datetime, given_at: datetime | None = None) -> list[Reason]:
    """Return why this flight cannot start now beside the flights that were started, with how long it has to wait; empty where it may.

    given_at: of a start that was given already, so that those given later do not count until they are carried out. One that goes on in the
    air does not take off.
    """
    if route.begun_by is not None:
        return []
    own = _since(route, flight, started_s=0.0)
    others = [] if own is None else _in_the_air(uav, now, given_at)
    if own is None or not others:
        return []
    planned = settings.SEPARATION_RULES
    rules = SeparationRules(planned.lateral_m, planned.vertical_m, KEPT_SHARE * planned.time_s)
    found = conflicts([own], others, rules=rules)
    if not found:
        return []
    apart = keep_apart([own], others, rules=rules)
    nearest = min(found, key=lambda encounter: (encounter.seconds, encounter.metres))
    values = {"uav": uav.name, "other": nearest.uavs[1], "metres": f"{nearest.metres:.0f}", "seconds": f"{apart.delays_s[0]:.0f}"}
    if apart.unresolved:
        words = _("Started now, %(uav)s would come within %(metres)s m of %(other)s, which is in the air. Wait until that is down.")
    else:
        words = _(
            "Started now, %(uav)s would come within %(metres)s m of %(other)s, which is in the air. It can be started in %(seconds)s s."
        )
    return [Reason("start_slot", words % values, route.mission_uav.sequence)]


def _in_the_air(uav: Uav, now: datetime, given_at: datetime | None) -> list[TimedRoute]:
    """Flights of the organisation that were started and have not ended, in seconds from now; one that is about to start counts from now."""
    since = now - timedelta(seconds=settings.FLIGHT_RULES.longest_flight_s)
    about_to = Q(state__in=OPEN_COMMANDS) if given_at is None else Q(state__in=OPEN_COMMANDS, created_at__lt=given_at)
    starts = (
        UavCommand.objects.filter(
            about_to | Q(state=CommandState.APPLIED, finished_at__gt=since),
            organisation=uav.organisation_id, kind=CommandKind.START, mission__state__in=ON_ITS_WAY, mission__deleted_at=None,
        )
        .exclude(uav=uav)
        .order_by("uav_id", "-sequence")
        .distinct("uav_id")
    )  # fmt: skip
    found = []
    for start in starts:
        route = (
            Route.objects.select_related("mission", "mission_uav")
            .filter(mission=start.mission_id, mission_uav__uav=start.uav_id, has_failed=False, **STILL_FLOWN)
            .first()
        )
        flight = int(start.parameters.get("flight", 1))
        if route is None or flight <= route.flights_flown:
            continue
        started_s = 0.0 if start.finished_at is None else (start.finished_at - now).total_seconds()
        flown = _since(route, flight, started_s=started_s)
        if flown is not None:
            found.append(flown)
    return found


def _since(route: Route, flight: int, *, started_s: float) -> TimedRoute | None:
    """One flight of a route as it is flown when it takes off at started_s; None where its times are not known."""
    timed = route_in_time(route)
    if timed is None:
        return None
    own = timed if timed.on_ground is None else _flight_of(timed, flight)
    return own.delayed(started_s - own.take_off_s)


def _flight_of(timed: TimedRoute, flight: int) -> TimedRoute:
    """Cut at the waypoints where it stands between two flights."""
    assert timed.on_ground is not None  # noqa: S101 - asked for by the caller
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


def reasons_to_carry_later(start: UavCommand) -> list[Reason]:
    """The same for a start that was given some time ago and is about to be carried out."""
    if start.parameters.get(OUT_OF_SLOT):
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
