"""Inspection results that UAVs report: each stored once, and the states of their targets follow the newest."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Any
from uuid import UUID

from django.db import transaction
from django.db.models.functions import Least

from missions.given_selectors import targets_given_to
from missions.models import InspectionTarget, LinkKind, TargetState
from missions.services.target_states import move_target
from telemetry.models import InspectionResult, TelemetryStream


@dataclass(frozen=True)
class NewResult:
    sequence: int
    mission_id: UUID
    target_id: int
    outcome: TargetState
    measured_at: datetime
    note: str
    values: dict[str, Any]


@dataclass(frozen=True)
class TakenResults:
    """`refused` are places in what was given, whose target is none that the UAV was given."""

    stored: int
    known: int
    refused: list[int]


@transaction.atomic
def take_results(*, uav_id: int, stream: str, results: Sequence[NewResult], received_at: datetime) -> TakenResults:
    """Of targets on this UAV's own routes, of any approval that it was sent: a mission may have changed while the UAV could not be reached."""
    given = {mission_id: targets_given_to(uav_id, mission_id) for mission_id in {result.mission_id for result in results}}
    refused = [place for place, result in enumerate(results) if result.target_id not in given[result.mission_id]]
    taken = [result for place, result in enumerate(results) if place not in set(refused)]
    stored = _store(uav_id, stream, taken, received_at) if taken else 0
    return TakenResults(stored=stored, known=len(taken) - stored, refused=refused)


def _store(uav_id: int, stream: str, results: Sequence[NewResult], received_at: datetime) -> int:
    """Targets are taken in the order of their keys, so that two batches at once do not wait for each other."""
    wanted = sorted({result.target_id for result in results})
    there = set(InspectionTarget.objects.select_for_update(no_key=True).filter(pk__in=wanted).order_by("pk").values_list("pk", flat=True))
    run, _ = TelemetryStream.objects.get_or_create(uav_id=uav_id, link=LinkKind.HTTP, key=stream)
    before = InspectionResult.objects.filter(stream=run).count()
    InspectionResult.objects.bulk_create(
        [
            InspectionResult(
                stream=run,
                sequence=result.sequence,
                uav_id=uav_id,
                mission_id=result.mission_id,
                target_id=result.target_id if result.target_id in there else None,
                measured_at=result.measured_at,
                outcome=result.outcome,
                note=result.note,
                values=result.values,
            )
            for result in results
        ],
        ignore_conflicts=True,
    )
    for target_id, outcome in _newest_outcomes(there).items():
        move_target(target_id=target_id, state=TargetState(outcome))
    return InspectionResult.objects.filter(stream=run).count() - before


def _newest_outcomes(target_ids: Collection[int]) -> dict[int, str]:
    """By target. A result counts from when it was measured, but not from later than it came: a clock that is ahead settles nothing."""
    results = InspectionResult.objects.filter(target_id__in=target_ids).annotate(counts_at=Least("measured_at", "received_at"))
    return dict(results.order_by("counts_at", "pk").values_list("target_id", "outcome"))
