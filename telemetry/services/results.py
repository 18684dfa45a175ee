"""Results of targets and ends of flights as UAVs report them: each stored once, and applied to the mission."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Any
from uuid import UUID

from django.db import transaction
from django.db.models.functions import Least

from missions.models import Approval, InspectionTarget, LinkKind, TargetState, Uav
from missions.selectors.given import approvals_given_to, is_end_known, number_of_flights, places_of_targets
from missions.services.commands.flight_progress import FlightEnd, mark_flight_ended, mark_target
from missions.services.replanning import suggest
from telemetry.models import InspectionResult, TelemetryStream
from telemetry.services.alerts.down_alerts import raise_failed_flight
from telemetry.services.alerts.replan_hooks import UAV_OUT
from telemetry.services.flight_events import note_landing
from telemetry.services.links.http_messages import note_on_ground_over_http


@dataclass(frozen=True)
class NewResult:
    """A result. `place` is the target's in the mission as approved."""

    sequence: int
    approval_id: UUID
    place: int
    outcome: TargetState
    measured_at: datetime
    note: str
    values: dict[str, Any]


@dataclass(frozen=True)
class EndedFlight:
    """The end of a flight. `flight` counts from 1."""

    approval_id: UUID
    flight: int
    end: FlightEnd


@dataclass(frozen=True)
class TakenResults:
    """Counts and refusals. Refused entries, by index, were never sent to this UAV; reused ones have the number of another result."""

    stored: int
    known: int
    refused_results: list[int]
    reused_results: list[int]
    refused_flights: list[int]


@transaction.atomic
def take_results(
    *, uav_id: int, stream: str, results: Sequence[NewResult], flights: Sequence[EndedFlight], received_at: datetime
) -> TakenResults:
    """Store results and ends of flights of this UAV's routes in any approval that it was sent, including revoked ones."""
    named = {result.approval_id for result in results} | {flight.approval_id for flight in flights}
    given = approvals_given_to(uav_id, named)
    places = {key: places_of_targets(uav_id, approval) for key, approval in given.items()}
    own = [result for result in results if result.place in places.get(result.approval_id, ())]
    stored = _store(uav_id, stream, own, given, received_at) if own else 0
    reused = _numbers_used_again(uav_id, stream, own) if stored < len(own) else set()
    numbers = {key: number_of_flights(uav_id, approval) for key, approval in given.items()}
    if not Uav.objects.filter(pk=uav_id, link=LinkKind.HTTP).exists():
        numbers = {}  # the gateway detects the end of its flights
    for flight in flights:
        if flight.flight > numbers.get(flight.approval_id, 0):
            continue
        approval = given[flight.approval_id]
        if not is_end_known(uav_id, approval, flight.flight):
            note_on_ground_over_http(uav_id=uav_id)
            note_landing(mission_id=approval.mission_id, uav_id=uav_id, at=received_at)
        if approval.revoked_at is None:
            mission_id = approval.mission_id
            mark_flight_ended(mission_id=mission_id, uav_id=uav_id, flight=flight.flight, end=flight.end)
            if flight.end is FlightEnd.FAILED:
                raise_failed_flight(uav_id=uav_id, approval_id=approval.pk, flight=flight.flight)
                suggest(mission_id=mission_id, code=UAV_OUT, cause={"uav": uav_id, "flight": flight.flight})
    return TakenResults(
        stored=stored,
        known=len(own) - stored - len(reused),
        refused_results=[place for place, result in enumerate(results) if result.place not in places.get(result.approval_id, ())],
        reused_results=[place for place, result in enumerate(results) if id(result) in reused],
        refused_flights=[place for place, flight in enumerate(flights) if flight.flight > numbers.get(flight.approval_id, 0)],
    )


def _store(uav_id: int, stream: str, results: Sequence[NewResult], given: dict[UUID, Approval], received_at: datetime) -> int:
    run, _ = TelemetryStream.objects.get_or_create(uav_id=uav_id, link=LinkKind.HTTP, key=stream)
    run = TelemetryStream.objects.select_for_update(no_key=True).get(pk=run.pk)  # batches of one counter are stored one after the other
    known = set(
        InspectionResult.objects.filter(stream=run, sequence__in=[result.sequence for result in results]).values_list("sequence", flat=True)
    )
    new = {result.sequence: result for result in reversed(results) if result.sequence not in known}  # of a repeated number the first counts
    targets = _targets(given)
    InspectionResult.objects.bulk_create(
        InspectionResult(
            stream=run,
            sequence=result.sequence,
            uav_id=uav_id,
            mission_id=given[result.approval_id].mission_id,
            approval_id=result.approval_id,
            place=result.place,
            target_id=targets.get((given[result.approval_id].pk, result.place)),
            measured_at=result.measured_at,
            received_at=received_at,
            outcome=result.outcome,
            note=result.note,
            values=result.values,
        )
        for result in new.values()
    )
    for approval in sorted(given.values(), key=lambda approval: approval.mission_id):
        if approval.revoked_at is None:
            for place in sorted({result.place for result in new.values() if result.approval_id == approval.pk}):
                mark_target(mission_id=approval.mission_id, target=place, state=_newest_outcome(approval, place))
    return len(new)


def _numbers_used_again(uav_id: int, stream: str, own: Sequence[NewResult]) -> set[int]:
    """Return, by identity, results that differ from the stored one with their number: the counter restarted; it is not a repetition."""
    run = InspectionResult.objects.filter(stream__uav_id=uav_id, stream__link=LinkKind.HTTP, stream__key=stream)
    rows = run.filter(sequence__in=[result.sequence for result in own]).values_list("sequence", "approval", "place", "measured_at")
    stored = {sequence: what for sequence, *what in rows}
    return {id(result) for result in own if stored[result.sequence] != [result.approval_id, result.place, result.measured_at]}


def _targets(given: dict[UUID, Approval]) -> dict[tuple[UUID, int], int]:
    """Return target keys by approval and place, for approvals in force: afterwards another target may have the place."""
    in_force = {approval.mission_id: approval.pk for approval in given.values() if approval.revoked_at is None}
    rows = InspectionTarget.objects.filter(mission__in=in_force).values_list("mission_id", "sequence", "pk")
    return {(in_force[mission_id], place): key for mission_id, place, key in rows}


def _newest_outcome(approval: Approval, place: int) -> TargetState:
    """Return the outcome of the newest result. Its time is that of measurement, at most that of receipt, in case the clock is ahead."""
    results = InspectionResult.objects.filter(approval=approval, place=place).annotate(counts_at=Least("measured_at", "received_at"))
    return TargetState(results.order_by("-counts_at", "-pk").values_list("outcome", flat=True)[0])
