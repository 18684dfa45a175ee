"""A mission's progress as seen by telemetry, from the start of the first UAV to the end of the last flight.

Telemetry decides what has happened and calls these functions. Repeated calls change nothing, nor do calls after a mission has ended.
"""

from datetime import datetime
from enum import StrEnum
from functools import partial
from uuid import UUID

from django.db import transaction
from django.db.models import Exists, OuterRef, Q, QuerySet
from django.db.models.functions import Now

from missions.models import InspectionTarget, Mission, MissionState, Route, TargetState
from missions.selectors.missions import approval_in_force
from missions.services.approval.approval import change_state
from missions.services.missions import note
from planning.trajectory.waypoints import WaypointKind
from workspace.live.changes import publish_live

ON_ITS_WAY = (MissionState.DISPATCHED, MissionState.ACTIVE)
UNDECIDED = (TargetState.PENDING, TargetState.IN_PROGRESS)
SETTLED = (TargetState.COMPLETE, TargetState.SKIPPED, TargetState.FAILED)
FLIGHT_FAILED = "flight-failed"  # reason of a target that failed without a report
NOT_REACHED, NOT_HELD = "not-reached", "not-held"  # reasons of a skipped target that the vehicle counted as passed


class FlightEnd(StrEnum):
    FLOWN = "flown"
    FAILED = "failed"


def mark_started(*, mission_id: UUID, uav_id: int) -> bool:
    """Record that a UAV flies its part. Returns whether the mission became active by it."""
    with transaction.atomic():
        held = Mission.objects.select_for_update(no_key=True).get(pk=mission_id)
        if held.state != MissionState.DISPATCHED:
            return False
        change_state(held, MissionState.ACTIVE, None, "start", {"uav": uav_id})
    return True


def mark_waypoint_reached(*, mission_id: UUID, uav_id: int, waypoint: int) -> None:
    """Record that a UAV is at a waypoint, by its place in the route: the target there is in progress, those before it are complete.

    A target that takes several waypoints, as photos and stretches do, is complete behind the last of them.
    """
    with transaction.atomic():
        held = Mission.objects.select_for_update(no_key=True).get(pk=mission_id)
        if held.state not in ON_ITS_WAY:
            return
        rows = Route.objects.filter(mission=held, mission_uav__uav=uav_id, continued_by=None, waypoints__target__isnull=False)
        visits = list(rows.order_by("waypoints__sequence").values_list("waypoints__sequence", "waypoints__target"))
        here = {target for sequence, target in visits if sequence == waypoint}
        to_come = {target for sequence, target in visits if sequence > waypoint}
        before = {target for sequence, target in visits if sequence < waypoint} - here - to_come
        targets = InspectionTarget.objects.filter(mission=held)
        _put(held, targets.filter(pk__in=here, state=TargetState.PENDING), TargetState.IN_PROGRESS)
        _put(held, targets.filter(pk__in=before, state__in=UNDECIDED), TargetState.COMPLETE)


def mark_target(*, mission_id: UUID, target: int, state: TargetState) -> bool:
    """Set the final state of a target, by its place in the mission, from a UAV's report: complete, skipped or failed."""
    with transaction.atomic():
        held = Mission.objects.select_for_update(no_key=True).get(pk=mission_id)
        if held.state in {MissionState.DRAFT, MissionState.PLANNED, MissionState.APPROVED}:
            return False
        found = InspectionTarget.objects.filter(mission=held, sequence=target)
        return _put(held, found.exclude(state=state), state) or found.exists()


def mark_missed(*, mission_id: UUID, target: int, reason: str) -> bool:
    """Skip a target, by its place in the mission, that counts as passed although the UAV's track shows it was not done.

    reason: NOT_REACHED or NOT_HELD. Returns whether it counted as complete before.
    """
    with transaction.atomic():
        held = Mission.objects.select_for_update(no_key=True).get(pk=mission_id)
        found = InspectionTarget.objects.filter(mission=held, sequence=target, state=TargetState.COMPLETE)
        return _put(held, found, TargetState.SKIPPED, reason)


def store_visit(*, mission_id: UUID, target: int, reached_at: datetime | None, held_s: float) -> bool:
    """Store when a settled target, by its place in the mission, was reached (None: never) and the most seconds its UAV can have stayed.

    Returns whether that is new.
    """
    settled = InspectionTarget.objects.filter(mission=mission_id, sequence=target, state__in=SETTLED)
    as_stored = Q(held_s=held_s) & (Q(reached_at__isnull=True) if reached_at is None else Q(reached_at=reached_at))
    is_new = ~Exists(InspectionTarget.objects.filter(as_stored, pk=OuterRef("pk")))
    return bool(settled.filter(is_new).update(reached_at=reached_at, held_s=held_s, visit_stored_at=Now()))


def mark_flight_ended(*, mission_id: UUID, uav_id: int, flight: int, end: FlightEnd) -> MissionState:
    """Record the end of a UAV's flight, counted from 1. The mission ends with the last flight of its last UAV.

    A failed flight ends its own route only: others fly on, and are paused and aborted as before; the mission then fails, else it is
    completed. Targets on a flown route without another report are complete, those on a failed one have failed. A route that another mission
    continues has ended. Returns the mission's state.
    """
    with transaction.atomic():
        held = Mission.objects.select_for_update(no_key=True).get(pk=mission_id)
        route = Route.objects.select_for_update().filter(mission=held, mission_uav__uav=uav_id, geometry__isnull=False).first()
        if held.state not in ON_ITS_WAY or route is None or route.has_failed or route.continued_by_id is not None:
            return MissionState(held.state)
        flights = _flights(held)
        if end is FlightEnd.FAILED:
            route.has_failed = True
            route.save(update_fields=["has_failed"])
            _settle(held, route, TargetState.FAILED)
            note(held, None, "fail-route", before=None, after={"uav": uav_id, "flight": flight})
        elif flight > route.flights_flown:
            route.flights_flown = flight
            route.save(update_fields=["flights_flown"])
        if not route.has_failed and route.flights_flown >= flights.get(uav_id, 1):
            _settle(held, route, TargetState.COMPLETE)
        _end_with_the_last(held, flights)
        return MissionState(held.state)


def end_if_over(held: Mission) -> None:
    """End the mission if another one took over its remaining routes; the caller holds the row."""
    _end_with_the_last(held, _flights(held))


def _end_with_the_last(held: Mission, flights: dict[int, int]) -> None:
    """End the mission if all routes ended: failed if a flight failed, aborted if a route was taken over, else completed.

    flights: the number of flights of each UAV.
    """
    routes = {route.mission_uav.uav_id: route for route in held.routes.filter(geometry__isnull=False).select_related("mission_uav")}
    failed = sorted(uav for uav in flights if uav in routes and routes[uav].has_failed)
    continued = sorted(uav for uav in flights if uav in routes and routes[uav].continued_by_id is not None)
    ended = {*failed, *continued, *(uav for uav, number in flights.items() if uav in routes and routes[uav].flights_flown >= number)}
    if not ended.issuperset(flights):
        return
    if failed:
        change_state(held, MissionState.FAILED, None, "fail", {"uavs": failed})
    elif continued:
        change_state(held, MissionState.ABORTED, None, "continue-elsewhere", {"uavs": continued})
    else:
        change_state(held, MissionState.COMPLETED, None, "complete", {})


def _settle(held: Mission, route: Route, state: TargetState) -> None:
    on_route = route.waypoints.filter(kind=WaypointKind.TARGET).values("target")
    reason = FLIGHT_FAILED if state == TargetState.FAILED else ""
    _put(held, InspectionTarget.objects.filter(pk__in=on_route, state__in=UNDECIDED), state, reason)


def _put(held: Mission, targets: QuerySet[InspectionTarget], state: TargetState, reason: str = "") -> bool:
    """Return whether any targets were updated. Live pages are notified after the commit."""
    if not targets.update(state=state, state_at=Now(), state_reason=reason, state_why=None):
        return False
    transaction.on_commit(partial(publish_live, held.organisation_id))
    return True


def _flights(mission: Mission) -> dict[int, int]:
    """Return the number of flights of each UAV, as approved."""
    approval = approval_in_force(mission)
    return {} if approval is None else {route["uav"]: len(route["flights"]) for route in approval.document["routes"]}
