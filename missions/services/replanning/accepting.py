"""Accept an offer: after one confirmation each UAV concerned is held, gets its other route, and continues.

One transaction moves the rest of the flying mission to the continuing one: routes, targets, approval and first commands. No mission mixes
two plans.
"""

from collections.abc import Mapping
from typing import Any

from django.db import transaction
from django.utils import timezone
from django.utils.translation import gettext as _

from missions.command_rules import HAND_OVER
from missions.models import (
    CommandAxis,
    CommandKind,
    CommandState,
    InspectionTarget,
    Mission,
    MissionState,
    OfferState,
    ReplanOffer,
    TargetState,
    Uav,
    UavCommand,
)
from missions.services.approval.approval import approve_mission, change_state, locked_mission
from missions.services.commands.flight_progress import end_if_over
from missions.services.commands.outbox import queue_command
from missions.services.commands.refused import refuse
from missions.services.replanning.offers import end_offer, held_offer
from missions.services.replanning.rest import COMING_BACK
from missions.services.replanning.staleness import why_outdated
from operation.reasons import Reason
from workspace.models import User
from workspace.reason_texts import reason_text, text_and_column

GIVEN_UP = ("changed", "recalled", "out")


def accept_offer(*, offer: ReplanOffer, actor: User) -> ReplanOffer:
    """Approve and dispatch the continuing mission. A repeated call changes nothing. Raises Refused with every reason."""
    with transaction.atomic():
        held = held_offer(offer)
        if held.state == OfferState.ACCEPTED:
            return held
        if held.state != OfferState.OPEN or held.continuation is None:
            raise refuse("decided", _("This offer is no longer open."))
        stale = why_outdated(held, timezone.now())
        if stale is not None:
            raise refuse("outdated", reason_text(stale) + " " + _("Plan the rest again."))
        mission, uavs = locked_mission(held.mission_id, None), held.difference["uavs"]
        given_up = [uav["place"] for uav in uavs if uav["change"] in GIVEN_UP]
        mission.routes.filter(mission_uav__sequence__in=given_up).update(continued_by=held.continuation)
        approval = approve_mission(mission=held.continuation, actor=actor, is_under_way=True)
        continuation = locked_mission(held.continuation.pk, None)
        _hand_over_targets(mission, continuation, held.difference)
        why = str(Reason("continues", {"mission": mission.name}))
        reported = []
        for uav in sorted(uavs, key=lambda one: one["uav"] or 0):
            row = Uav.objects.filter(pk=uav["uav"]).first()
            if row is None:
                continue
            if uav["change"] == "changed":
                reported.append(
                    queue_command(
                        uav=row, kind=CommandKind.HOLD, actor=actor, why=why, mission=continuation, approval=approval,
                        parameters={HAND_OVER: True},
                    )
                )  # fmt: skip
            elif uav["change"] in GIVEN_UP and _is_on_its_own(row, mission):
                reported.append(queue_command(uav=row, kind=CommandKind.RETURN, actor=actor, why=why, mission=mission))
        commands = [{"uav": command.uav_id, "kind": command.kind, "command": str(command.pk)} for command in reported]
        change_state(
            continuation,
            MissionState.DISPATCHED,
            actor,
            "dispatch",
            {"approval": str(approval.pk), "commands": commands, "continues": str(mission.pk)},
        )
        end_if_over(mission)
        end_offer(held, OfferState.ACCEPTED, actor=actor)
    return held


def _is_on_its_own(uav: Uav, mission: Mission) -> bool:
    """Whether it may continue with what others took over: it was started, and has no later command to come down."""
    done = UavCommand.objects.filter(uav=uav, axis=CommandAxis.FLIGHT, state=CommandState.APPLIED)
    last = done.order_by("-sequence").first()
    was_started = done.filter(mission=mission, kind=CommandKind.START).exists()
    has_failed = mission.routes.filter(mission_uav__uav=uav, has_failed=True).exists()
    return was_started and not has_failed and last is not None and last.kind not in COMING_BACK


def _hand_over_targets(mission: Mission, continuation: Mission, difference: Mapping[str, Any]) -> None:
    """Settle each target of routes that end: moved to the other mission, done, or skipped with the reason."""
    now = timezone.now()
    rows = {target.sequence: target for target in mission.targets.all()}
    taken = sorted(target for uav in difference["uavs"] if uav["change"] == "changed" for target in uav["order"])
    over = text_and_column(Reason("taken_over", {"mission": continuation.name}), 300)
    done = []
    for place, target in enumerate(taken):
        row = rows[target]
        if row.state == TargetState.COMPLETE:  # before its UAV leaves the route
            done.append(place)
            continue
        row.state, row.state_at = TargetState.SKIPPED, now
        row.state_reason, row.state_why = over
    for entry in difference["targets"]:
        if entry["to"] is None:
            row = rows[entry["target"]]
            row.state, row.state_at, row.state_reason = TargetState.SKIPPED, now, entry["message"][:300]
            row.state_why = {"text": row.state_reason, "reasons": entry["why"]} if entry.get("why") else None
    given_up = [uav["place"] for uav in difference["uavs"] if uav["change"] in GIVEN_UP]
    own = InspectionTarget.objects.filter(mission=mission, waypoints__route__mission_uav__sequence__in=given_up)
    for key in own.values_list("sequence", flat=True).distinct():
        if rows[key].state == TargetState.IN_PROGRESS:  # its UAV had left it
            rows[key].state, rows[key].state_at = TargetState.COMPLETE, now
    InspectionTarget.objects.bulk_update(rows.values(), ["state", "state_at", "state_reason", "state_why"])
    continuation.targets.filter(sequence__in=done).update(state=TargetState.COMPLETE, state_at=now)
