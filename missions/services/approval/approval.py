"""Approve a plan and revoke the approval. An approved mission is frozen: only what was approved may be flown.

A revocation takes effect at once while no part of the mission has been sent. Later it waits until every UAV that may hold the mission
was read back without it. Until then the approval stays in force, so that no UAV flies an unapproved mission.
"""

from functools import partial
from typing import Any
from uuid import UUID

from django.db import transaction
from django.db.models import Exists, OuterRef, Q, QuerySet
from django.db.models.functions import Now
from django.utils import timezone
from django.utils.translation import gettext as _

from inspection.selectors.ground import held_ground_revision
from missions.command_rules import SETS_IN_MOTION
from missions.hooks.approval import further_reasons
from missions.models import (
    ENDED_STATES,
    OPEN_COMMANDS,
    Approval,
    CommandKind,
    CommandState,
    Mission,
    MissionState,
    TargetState,
    Uav,
    UavCommand,
)
from missions.selectors.missions import approval_in_force, mission_of_organisation
from missions.services.approval.checks import incomplete_reasons, reasons_against
from missions.services.approval.document import approval_document, content_sha256
from missions.services.commands.call_signs import give_call_sign
from missions.services.commands.outbox import end_commands, queue_command
from missions.services.commands.refused import refuse, refuse_for
from missions.services.missions import MissionChanged, note
from operation.reasons import Reason
from workspace.live.changes import publish_live
from workspace.models import User

REVOKED = "revoked"
ACKNOWLEDGE_FAILED_REHEARSAL = "acknowledge_failed_rehearsal"  # code of the one reason that a user may overrule


def approve_mission(
    *,
    mission: Mission,
    actor: User,
    expected_revision: int | None = None,
    longest_leg_m: float | None = None,
    failed_rehearsal_reason: str = "",
    is_under_way: bool = False,
) -> Approval:
    """Freeze a planned mission as it is. Raises MissionChanged, or Refused with every reason against flying it so.

    The checks of later apps are skipped for a mission that takes over while UAVs are in the air, which cannot wait for a rehearsal, and for
    one flown only by simulated twins. Incomplete UAVs are refused, except in the air.

    A failed rehearsal of this plan is among these reasons unless `failed_rehearsal_reason` says why the mission is approved nevertheless.

    With `longest_leg_m` autopilots get extra points on each longer leg; the flown lines stay the same.
    """
    with transaction.atomic():
        held = locked_mission(mission.pk, expected_revision)
        if held.state == MissionState.DRAFT:
            raise refuse("not_planned", _("A draft cannot be approved. Plan it first."))
        if held.state != MissionState.PLANNED:
            raise refuse("not_planned", _("Only a planned mission can be approved."))
        checked_revision = held_ground_revision()
        loaded = mission_of_organisation(held.organisation, held.pk)
        further = [] if is_under_way or _is_flown_by_twins(held) else further_reasons(loaded)
        unanswered = [reason for reason in further if not (failed_rehearsal_reason and reason.code == ACKNOWLEDGE_FAILED_REHEARSAL)]
        incomplete = [] if is_under_way else incomplete_reasons(loaded)
        refuse_for([*incomplete, *reasons_against(loaded, now=timezone.now()), *unanswered])
        document = approval_document(loaded, longest_leg_m=longest_leg_m)
        if document["ground"]["revision"] != checked_revision:
            raise refuse("ground_changed", _("Zones, assets or terrain were changed in this moment. Approve it again."))
        approval = Approval.objects.create(
            mission=held,
            document=document,
            content_sha256=content_sha256(document),
            approved_by=actor,
            failed_rehearsal_reason=failed_rehearsal_reason,
        )
        held.ground_revision = checked_revision  # the routes have just been checked against it
        held.targets.update(
            state=TargetState.PENDING, state_at=None, state_reason="", state_why=None, reached_at=None, held_s=None, visit_stored_at=None
        )
        held.routes.update(flights_flown=0, has_failed=False)
        facts: dict[str, Any] = {"approval": str(approval.pk), "sha256": approval.content_sha256}
        facts |= {} if longest_leg_m is None else {"longest_leg_m": longest_leg_m}
        facts |= {"failed_rehearsal_reason": failed_rehearsal_reason} if failed_rehearsal_reason else {}
        change_state(held, MissionState.APPROVED, actor, "approve", facts)
    return approval


def _is_flown_by_twins(mission: Mission) -> bool:
    """Whether it is an unmodified simulated copy. If a user gives it another UAV, it is an ordinary mission."""
    return mission.simulates_id is not None and not mission.mission_uavs.filter(Q(uav=None) | Q(uav__twin_of=None)).exists()


def revoke_approval(*, mission: Mission, actor: User, reason: str, expected_revision: int | None = None) -> Approval:
    """Revoke the approval: the mission becomes planned again. Raises MissionChanged or Refused.

    Each UAV that may hold the mission gets the command to clear it, and the approval stays in force until all have done so. A repeated call
    sends the command again to those that failed. A mission that is being flown is aborted instead of revoked.
    """
    with transaction.atomic():
        held = locked_mission(mission.pk, expected_revision)
        approval = approval_in_force(held)
        if approval is None or held.state not in {MissionState.APPROVED, MissionState.DISPATCHED}:
            raise refuse("not_approved", _("Only a mission that is approved and not yet flown can be revoked. Abort one that is flown."))
        if approval.revoke_requested_at is None:
            approval.revoke_requested_at, approval.revoked_by, approval.revoke_reason = timezone.now(), actor, reason
            approval.save(update_fields=["revoke_requested_at", "revoked_by", "revoke_reason"])
        never_left = Q(kind=CommandKind.UPLOAD_MISSION, attempts=0)
        end_commands(approval.commands.filter(never_left | Q(kind__in=SETS_IN_MOTION)), code=REVOKED, why=(Reason("revoked"),))
        for uav in uavs_that_may_hold(approval).order_by("pk"):
            if not _is_being_cleared(uav, approval):
                queue_command(uav=uav, kind=CommandKind.CLEAR_MISSION, actor=actor, why=reason, mission=held, approval=approval)
        if not _finish(held, approval):
            change_state(held, MissionState(held.state), actor, "revoke-asked", {"approval": str(approval.pk), "reason": reason})
    return approval


def finish_revocation(*, approval_id: UUID) -> bool:
    """End the approval after a readback without the mission, if it was to be revoked and no UAV holds it any more."""
    with transaction.atomic():
        mission_id = Approval.objects.values_list("mission", flat=True).get(pk=approval_id)
        held = Mission.objects.select_for_update(no_key=True).get(pk=mission_id)
        approval = approval_in_force(held)
        if approval is None or approval.pk != approval_id or approval.revoke_requested_at is None:
            return False
        return _finish(held, approval)


def _finish(held: Mission, approval: Approval) -> bool:
    if held.state not in {MissionState.APPROVED, MissionState.DISPATCHED} or uavs_that_may_hold(approval).exists():
        return False
    approval.revoked_at = timezone.now()
    approval.save(update_fields=["revoked_at"])
    facts = {"approval": str(approval.pk), "reason": approval.revoke_reason}
    change_state(held, MissionState.PLANNED, approval.revoked_by, "revoke", facts)
    return True


def uavs_that_may_hold(approval: Approval) -> QuerySet[Uav]:
    """Return the UAVs to which some of the mission was or may have been sent, unless a later clearing or other upload was applied."""
    emptied_or_loaded = Q(kind=CommandKind.CLEAR_MISSION) | (Q(kind=CommandKind.UPLOAD_MISSION) & ~Q(approval=approval))
    later = UavCommand.objects.filter(emptied_or_loaded, uav=OuterRef("uav"), sequence__gt=OuterRef("sequence"), state=CommandState.APPLIED)
    went = UavCommand.objects.filter(~Exists(later), approval=approval, kind=CommandKind.UPLOAD_MISSION)
    open_or_tried = Q(state__in=OPEN_COMMANDS) | Q(attempts__gt=0)
    return Uav.objects.filter(pk__in=went.filter(open_or_tried).values("uav"))


def _is_being_cleared(uav: Uav, approval: Approval) -> bool:
    return approval.commands.filter(uav=uav, kind=CommandKind.CLEAR_MISSION, state__in=OPEN_COMMANDS).exists()


def locked_mission(mission_id: UUID, expected_revision: int | None) -> Mission:
    """Return the row, locked until the caller's transaction ends. Raises MissionChanged."""
    held = Mission.objects.select_for_update(no_key=True).get(pk=mission_id)
    if held.deleted_at is not None or (expected_revision is not None and held.revision != expected_revision):
        raise MissionChanged
    return held


def change_state(held: Mission, state: MissionState, actor: User | None, action: str, facts: dict[str, Any]) -> None:
    """Change the state, write its history entry, and notify live pages after the commit; the caller holds the row."""
    before = {"state": str(held.state), "revision": held.revision}
    if state == MissionState.ACTIVE and held.started_at is None:
        held.started_at = timezone.now()
    if state in ENDED_STATES and held.state not in ENDED_STATES:
        held.ended_at = timezone.now()
        held.targets.filter(state=TargetState.IN_PROGRESS).update(state=TargetState.PENDING, state_at=Now())  # none is after the end
    if state == MissionState.DISPATCHED and held.state != MissionState.DISPATCHED:
        give_call_sign(held)
    held.state, held.revision = state, held.revision + 1
    held.save(update_fields=["state", "revision", "ground_revision", "call_number", "colours", "started_at", "ended_at", "updated_at"])
    transaction.on_commit(partial(publish_live, held.organisation_id))
    note(held, actor, action, before=before, after={"state": str(state), "revision": held.revision, **facts})
