"""Commands to UAVs, and their effects on missions.

The dispatcher works with this module; `outbox` keeps the rows.
"""

from uuid import UUID

from django.db import transaction

from missions.command_rules import HAND_OVER, THEN_RETURN
from missions.models import CommandKind, Mission, UavCommand
from missions.services.approval.approval import finish_revocation
from missions.services.commands import outbox
from missions.services.commands.flight_progress import mark_started
from missions.services.commands.outbox import (
    CHANNEL,
    claim_commands,
    expire_overdue,
    is_wanted,
    note_acknowledged,
    note_failed,
    note_progress,
    note_read_back,
    note_released,
    note_sent,
    note_sent_unacknowledged,
    queue_command,
    release_claims_of_others,
    renew_claims,
)
from missions.services.commands.route_swap import go_on_after
from missions.services.commands.staggered_returns import return_after
from operation.reasons import Why

__all__ = [
    "CHANNEL",
    "claim_commands",
    "expire_overdue",
    "is_wanted",
    "note_acknowledged",
    "note_applied",
    "note_failed",
    "note_progress",
    "note_read_back",
    "note_released",
    "note_sent",
    "note_sent_unacknowledged",
    "queue_command",
    "release_claims_of_others",
    "renew_claims",
]


def note_applied(command_id: UUID, *, attempt: int, holder: str, note: Why = (), warnings: Why = ()) -> bool:
    """Record that the vehicle did the command. A start makes its mission active; the last clearing completes a revocation.

    A step of a route swap is followed by the next one, and a command with THEN_RETURN by the return.
    """
    with transaction.atomic():
        command = UavCommand.objects.only("kind", "uav_id", "mission_id", "approval_id", "parameters").filter(pk=command_id).first()
        if command is not None and command.mission_id is not None:
            Mission.objects.select_for_update(no_key=True).values_list("pk").get(pk=command.mission_id)  # lock missions before commands
        if not outbox.note_applied(command_id, attempt=attempt, holder=holder, note=note, warnings=warnings):
            return False
        assert command is not None  # noqa: S101 - the call above wrote to it
        if command.kind == CommandKind.START and command.mission_id is not None:
            mark_started(mission_id=command.mission_id, uav_id=command.uav_id)
        if command.kind == CommandKind.CLEAR_MISSION and command.approval_id is not None:
            finish_revocation(approval_id=command.approval_id)
        if command.parameters.get(HAND_OVER):
            go_on_after(UavCommand.objects.select_related("uav", "mission", "approval", "created_by").get(pk=command_id))
        if command.parameters.get(THEN_RETURN):
            return_after(UavCommand.objects.select_related("uav", "mission", "approval", "created_by").get(pk=command_id))
    return True
