"""Start a mission's UAVs in planned order: on the server, each checked against those in the air, stoppable from any page."""

from collections.abc import Collection, Sequence
from dataclasses import asdict, dataclass
from datetime import datetime, timedelta
from enum import StrEnum
from uuid import UUID

from django.db import transaction
from django.db.models import QuerySet
from django.utils import timezone
from django.utils.translation import gettext as _

from missions.command_rules import SAFETY_RANKS
from missions.hooks.approval import reasons_against_starts
from missions.models import (
    OPEN_COMMANDS,
    Approval,
    CommandKind,
    CommandState,
    Mission,
    PlannedStarts,
    Route,
    StartsEnd,
    Uav,
)
from missions.selectors.commands import places_in_flight, upload_of
from missions.selectors.missions import approval_in_force
from missions.services.approval.approval import locked_mission
from missions.services.approval.checks import incomplete_reasons
from missions.services.commands.flight_progress import ON_ITS_WAY
from missions.services.commands.outbox import withdraw
from missions.services.commands.refused import RefusalReason, Refused, refuse, refuse_for
from missions.services.commands.steering import command_uav, mission_in_hand
from missions.services.missions import note
from workspace.models import User

LEAD_S = 10.0  # before the first start: time to stop it
MAX_GAP_S = 60.0  # an interruption this long ends the run: its overdue starts would be a surprise
WHY = "Start in planned order"
WAITS_FOR = frozenset({"start_slot", "too_early"})  # temporary reasons
BEGUN = (*OPEN_COMMANDS, CommandState.APPLIED)
STOPPING = frozenset({*SAFETY_RANKS, "pause"})


class StartState(StrEnum):
    WAITING = "waiting"
    STARTED = "started"  # the command was given
    REFUSED = "refused"


@dataclass
class PlannedStart:
    """One UAV's start. `why` is what it waits for after its time, or why it was refused."""

    uav: int
    name: str
    place: int
    due_at: str  # ISO 8601, UTC
    state: str = StartState.WAITING
    command: str | None = None
    why: str = ""


def begin_planned_starts(
    *, mission: Mission, actor: User, uavs: Collection[int] | None = None, pilot_checked: bool = False
) -> PlannedStarts:
    """Plan the first starts of the UAVs that have their route and have not started; the first one in LEAD_S seconds.

    uavs: ids of those to start, the others wait on the ground; None: all. Later apps check each again: link, position, battery.

    pilot_checked: the actor has confirmed the checks that only a pilot can make; the history records it.
    Raises Refused, also where one of them does not have its route as approved.
    """
    wanted = [uav_id for route in waiting_for_start(mission) if (uav_id := route.mission_uav.uav_id)] if uavs is None else uavs
    against = reasons_against_starts(mission, wanted)  # before the lock: it may take seconds, and an abort must not wait
    with transaction.atomic():
        held = locked_mission(mission.pk, None)
        approval = approval_in_force(held)
        if approval is None or held.state not in ON_ITS_WAY:
            raise refuse("not_on_its_way", _("Only an uploaded mission can be started."))
        if held.planned_starts.filter(ended_at=None).exists():
            raise refuse("already_starting", _("Its UAVs are being started in planned order already."))
        routes = _chosen(_routes_to_start(held, approval), wanted)
        if not routes:
            raise refuse("nothing_to_start", _("No UAV of this mission waits for its first start."))
        refuse_for([*_not_loaded(routes, approval), *incomplete_reasons(held, wanted)])
        refuse_for(against)
        first_s = routes[0].departs_s
        begin = timezone.now() + timedelta(seconds=LEAD_S)
        if held.departs_at is not None:
            begin = max(begin, held.departs_at + timedelta(seconds=first_s))
        entries = [
            PlannedStart(
                uav_id, route.mission_uav.name, route.mission_uav.sequence, _iso(begin + timedelta(seconds=route.departs_s - first_s))
            )
            for route in routes
            if (uav_id := route.mission_uav.uav_id) is not None
        ]
        starts = PlannedStarts.objects.create(mission=held, created_by=actor, uavs=[asdict(entry) for entry in entries])
        starts.refresh_from_db()
        after = {"uavs": [entry.uav for entry in entries], "pilot_checked": pilot_checked}
        note(held, actor, "begin-starts", before=None, after=after)
    return starts


def _chosen(routes: Sequence[Route], uavs: Collection[int]) -> list[Route]:
    """Return the routes of these UAVs. Raises Refused where one of them does not wait for its first start."""
    chosen = [route for route in routes if route.mission_uav.uav_id in uavs]
    if len(chosen) < len(set(uavs)):
        raise refuse("not_waiting", _("One of these UAVs does not wait for its first start in this mission."))
    return chosen


def uavs_being_started(mission: Mission) -> set[int]:
    """Return the UAVs whose start in planned order is still due."""
    return {
        entry["uav"]
        for starts in mission.planned_starts.filter(ended_at=None)
        for entry in starts.uavs
        if entry["state"] == StartState.WAITING
    }


def waiting_for_start(mission: Mission) -> list[Route]:
    """Return the routes that could be started in planned order now, in that order; none where the mission is not on its way."""
    approval = approval_in_force(mission)
    return [] if approval is None or mission.state not in ON_ITS_WAY else _routes_to_start(mission, approval)


def stop_planned_starts(*, mission: Mission, actor: User) -> PlannedStarts:
    """Stop starting UAVs and withdraw a start that was given and not yet sent. UAVs in the air fly on. Raises Refused."""
    with transaction.atomic():
        starts = PlannedStarts.objects.select_for_update().filter(mission=mission, ended_at=None).first()
        if starts is None:
            raise refuse("not_starting", _("Its UAVs are not being started in planned order."))
        withdraw([UUID(entry["command"]) for entry in starts.uavs if entry["command"]])
        _end(starts, StartsEnd.STOPPED, actor)
        note(mission, actor, "stop-starts", before=None, after={"waiting": [e["uav"] for e in starts.uavs if e["state"] == "waiting"]})
    return starts


def carry_on_planned_starts() -> None:
    """Give the starts of all missions that are due now. Safe to run concurrently: each run of starts is locked by one worker."""
    for key in PlannedStarts.objects.filter(ended_at=None).values_list("pk", flat=True):
        _carry_on(key)


def _carry_on(key: UUID) -> None:
    with transaction.atomic():
        locked = PlannedStarts.objects.select_for_update(skip_locked=True, of=("self",))
        starts = locked.select_related("mission", "created_by").filter(pk=key, ended_at=None).first()
        if starts is None:
            return
        now, actor = timezone.now(), starts.created_by
        end = _end_of(starts, now)
        if end is None and actor is not None:
            entries = [PlannedStart(**entry) for entry in starts.uavs]
            for entry in entries:
                if entry.state == StartState.WAITING and datetime.fromisoformat(entry.due_at) <= now:
                    _start(starts, entry, actor)
            starts.uavs, starts.looked_at = [asdict(entry) for entry in entries], now
            starts.save(update_fields=["uavs", "looked_at"])
            end = None if any(entry.state == StartState.WAITING for entry in entries) else StartsEnd.DONE
        if end is not None:
            _end(starts, end)


def _end_of(starts: PlannedStarts, now: datetime) -> StartsEnd | None:
    """Return why no further UAV is started; None where the starts continue."""
    if starts.mission.state not in ON_ITS_WAY or starts.mission.deleted_at is not None:
        return StartsEnd.MISSION_OVER
    if now - starts.looked_at > timedelta(seconds=MAX_GAP_S) or starts.created_by is None or not starts.created_by.is_active:
        return StartsEnd.INTERRUPTED
    if starts.mission.commands.filter(kind__in=STOPPING, created_at__gt=starts.created_at).exists():
        return StartsEnd.COMMANDED
    return None


def _start(starts: PlannedStarts, entry: PlannedStart, actor: User) -> None:
    """Start a UAV with the checks of a single start: its onboard mission, zones, and the UAVs in the air."""
    mission = starts.mission
    given = mission.commands.filter(uav=entry.uav, kind=CommandKind.START, created_at__gt=starts.created_at, state__in=BEGUN).first()
    if given is not None:  # a user has started it separately meanwhile
        entry.state, entry.command, entry.why = StartState.STARTED, str(given.pk), ""
        return
    try:
        with transaction.atomic():
            uav = Uav.objects.get(pk=entry.uav)
            if mission_in_hand(uav) != mission:
                raise refuse("not_in_mission", _("%(uav)s has no route of this mission sent or in flight.") % {"uav": uav.name})
            command = command_uav(uav=uav, kind=CommandKind.START, actor=actor, why=WHY)
    except Refused as error:
        entry.why = str(error)
        if not {reason.code for reason in error.reasons} <= WAITS_FOR:
            entry.state = StartState.REFUSED
    else:
        entry.state, entry.command, entry.why = StartState.STARTED, str(command.pk), ""


def _end(starts: PlannedStarts, end: StartsEnd, actor: User | None = None) -> None:
    starts.end, starts.ended_at, starts.ended_by = end, timezone.now(), actor
    starts.save(update_fields=["uavs", "looked_at", "end", "ended_at", "ended_by"])


def routes_not_begun(mission: Mission, approval: Approval) -> QuerySet[Route]:
    """Return routes of fleet UAVs whose first flight has not begun and has no open start, in the order of their departures."""
    begun = approval.commands.filter(kind=CommandKind.START, state__in=BEGUN).values("uav")
    routes = mission.routes.select_related("mission_uav").filter(
        mission_uav__uav__isnull=False, geometry__isnull=False, begun_by=None, continued_by=None, has_failed=False, flights_flown=0
    )
    return routes.exclude(mission_uav__uav__in=begun).order_by("departs_s", "mission_uav__sequence")


def _routes_to_start(mission: Mission, approval: Approval) -> list[Route]:
    return list(routes_not_begun(mission, approval).filter(mission_uav__uav__in=places_in_flight(mission)))


def _not_loaded(routes: Sequence[Route], approval: Approval) -> list[RefusalReason]:
    found = []
    for route in routes:
        place = route.mission_uav
        upload = upload_of(approval, place.uav_id)
        if upload is None or upload.state != CommandState.APPLIED:
            found.append(RefusalReason("not_loaded", _("%(uav)s does not have its mission yet.") % {"uav": place.name}, place.sequence))
    return found


def _iso(moment: datetime) -> str:
    return moment.isoformat()
