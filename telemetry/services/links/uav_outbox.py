"""Commands for UAVs on the HTTP link, and their acknowledgements."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any
from uuid import UUID

from django.db import transaction
from django.utils import timezone

from missions.models import OPEN_COMMANDS, CommandKind, CommandState, LinkKind, UavCommand
from missions.selectors.given import Given, given_to
from missions.services.commands.commands import claim_commands, note_acknowledged, note_applied, note_failed, note_sent
from missions.services.commands.dispatch import ApprovedLoad, load_of
from missions.services.commands.start_slots import START_SLOT, reasons_to_carry_later
from operation.reasons import Reason, Why, english
from telemetry.models import AlertLevel, UavLink
from telemetry.services.alerts.alerts import close_alert, open_alert

HOLDER = "http-link"  # shared by all processes: a UAV may ask any of them
LEASE_S = 30.0
MAX_CONCURRENT = 10
OTHER_CONTENT = "other-content"
REFUSED = "refused-by-uav"
HOLDS_OTHER = "holds-other-content"  # an alert's code
HOLDS = "The UAV %(uav)s holds something else than what was approved."
SAYS_NOTHING = "The UAV %(uav)s does not say what it holds."


@dataclass(frozen=True)
class Acknowledgement:
    """An acknowledgement. For an upload, `content_sha256` is the hash of what the UAV holds."""

    command_id: UUID
    state: CommandState
    reason: str = ""
    content_sha256: str | None = None


@dataclass(frozen=True)
class Noted:
    """The result of an acknowledgement. `state` is the command's state afterwards; None: not a command of this UAV."""

    command_id: UUID
    noted: bool
    state: str | None
    words: str = ""


def handed_to(uav_id: int, given: Given) -> Given:
    """Mark the waiting commands as sent, and return the updated response data."""
    if not given.has_unclaimed:
        return given
    for command in claim_commands(uav_ids=[uav_id], holder=HOLDER, lease_s=LEASE_S, limit=MAX_CONCURRENT, link=LinkKind.HTTP):
        holding: dict[str, Any] = {"attempt": command.attempts, "holder": HOLDER}
        to_wait = reasons_to_carry_later(command) if command.kind == CommandKind.START else []
        if to_wait:
            note_failed(command.pk, START_SLOT, to_wait[0].message, **holding)
        else:
            note_sent(command.pk, **holding)
    return given_to(uav_id)


def note_acknowledgements(*, uav_id: int, acknowledgements: Sequence[Acknowledgement]) -> list[Noted]:
    """Store acknowledgements in order. Idempotent."""
    return [_note(uav_id, acknowledgement) for acknowledgement in acknowledgements]


@transaction.atomic
def _note(uav_id: int, reported: Acknowledgement) -> Noted:
    command = (
        UavCommand.objects.select_related("approval", "uav", "mission")
        .filter(pk=reported.command_id, uav_id=uav_id, link=LinkKind.HTTP, uav__link=LinkKind.HTTP)
        .first()
    )
    if command is None:
        return Noted(reported.command_id, False, None, "There is no such command to this UAV.")
    if command.state not in OPEN_COMMANDS:
        is_known = command.state == reported.state
        return Noted(command.pk, is_known, command.state, "" if is_known else f"The command has ended before: {command.outcome}"[:500])
    holding: dict[str, Any] = {"attempt": command.attempts, "holder": command.holder}
    words = ""
    if reported.state == CommandState.ACKNOWLEDGED:
        noted = note_acknowledged(command.pk, **holding)
    elif reported.state == CommandState.FAILED:
        why: Why = reported.reason or (Reason("no_reason_given"),)
        words = english(why)
        noted = note_failed(command.pk, REFUSED, why, **holding)
        _hold(command, None, is_known=False)
    elif command.kind == CommandKind.UPLOAD_MISSION:
        noted, words = _note_upload(command, reported, holding)
    else:
        noted = note_applied(command.pk, note=reported.reason, **holding)
        if noted and command.kind == CommandKind.CLEAR_MISSION:
            _hold(command, None)
    command.refresh_from_db(fields=["state"])
    return Noted(command.pk, noted, command.state, words)


def _note_upload(command: UavCommand, reported: Acknowledgement, holding: dict[str, Any]) -> tuple[bool, str]:
    """Store the end of an upload. The UAV is ready only if it holds the approved content."""
    load = load_of(command)
    if reported.content_sha256 == load.content_sha256:
        noted = note_applied(command.pk, note=reported.reason, **holding)
        if noted:
            _hold(command, load)
        return noted, ""
    why = Reason("uav_holds_other" if reported.content_sha256 else "uav_holds_unknown")
    noted = note_failed(command.pk, OTHER_CONTENT, (why,), **holding)
    _hold(command, None)
    if noted:
        open_alert(
            uav=command.uav, level=AlertLevel.CRITICAL, code=HOLDS_OTHER, message=HOLDS if reported.content_sha256 else SAYS_NOTHING,
            values={"uav": command.uav.name}, mission=command.mission,
        )  # fmt: skip
    return noted, str(why)


def _hold(command: UavCommand, load: ApprovedLoad | None, *, is_known: bool = True) -> None:
    """Store what the UAV holds. After a failed upload it is unknown, and an open alert stays open."""
    if command.kind not in {CommandKind.UPLOAD_MISSION, CommandKind.CLEAR_MISSION}:
        return
    if load is not None or (is_known and command.kind == CommandKind.CLEAR_MISSION):
        close_alert(uav=command.uav, code=HOLDS_OTHER)
    UavLink.objects.update_or_create(
        uav_id=command.uav_id,
        defaults={
            "loaded_sha256": load.content_sha256 if load else "",
            "loaded_approval": load.approval if load else None,
            "loaded_flight": load.flight if load else None,
            "loaded_read_at": timezone.now() if load else None,
            "loaded_doubt": "",
        },
    )
