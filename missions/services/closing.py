"""Closing a mission: a user states why each open target is left, and nothing of the mission is flown afterwards."""

from collections.abc import Mapping

from django.db import transaction
from django.utils import timezone
from django.utils.translation import gettext as _

from missions.hooks.in_air import uavs_in_the_air
from missions.models import ENDED_STATES, CommandKind, InspectionTarget, Mission, MissionState, TargetState, Uav
from missions.selectors.missions import approval_in_force
from missions.services.approval.approval import change_state, locked_mission, uavs_that_may_hold
from missions.services.commands.dispatch import busy_elsewhere
from missions.services.commands.flight_progress import ON_ITS_WAY, UNDECIDED
from missions.services.commands.outbox import queue_command
from missions.services.commands.refused import RefusalReason, refuse, refuse_for
from missions.services.missions import note
from workspace.models import User

MAX_REASON_LENGTH = 300


def close_mission(*, mission: Mission, actor: User, reasons: Mapping[int, str], expected_revision: int | None = None) -> Mission:
    """Skip each open target, by its place in the mission, for the given reason, and end a mission that is on its way.

    It ends as completed where no target was open, else as aborted, or failed where a flight has failed. One that has ended already keeps
    its state. UAVs that may hold a mission that was not started get the command to clear it. Raises MissionChanged, or Refused: while one
    of its UAVs is in the air, where an open target has no reason, and where nothing is left to close.
    """
    with transaction.atomic():
        held = locked_mission(mission.pk, expected_revision)
        if held.state not in (*ON_ITS_WAY, *ENDED_STATES):
            raise refuse("not_sent", _("Only an uploaded mission can be closed."))
        refuse_for(_in_the_air(held))
        still_open = {target.sequence: target for target in held.targets.filter(state__in=UNDECIDED)}
        if held.state in ENDED_STATES and not still_open:
            raise refuse("nothing_open", _("This mission is closed: no target is open."))
        stated = {place: reasons.get(place, "").strip() or target.unassigned_message for place, target in still_open.items()}
        missing = [target.label for place, target in still_open.items() if not stated[place]]
        if missing:
            raise refuse("reason_missing", _("Say why each open target is left: %(targets)s.") % {"targets": ", ".join(missing)})
        for place, target in still_open.items():
            target.state, target.state_reason, target.state_at = TargetState.SKIPPED, stated[place][:MAX_REASON_LENGTH], timezone.now()
            target.state_why = None
        facts = {"targets": {str(place): target.state_reason for place, target in still_open.items()}}
        InspectionTarget.objects.bulk_update(still_open.values(), ["state", "state_reason", "state_why", "state_at"])
        if held.state in ENDED_STATES:
            note(held, actor, "close", before={"state": str(held.state)}, after={"state": str(held.state), **facts})
        else:
            _drop_from_uavs(held, actor)
            change_state(held, _end_state(held, bool(still_open)), actor, "close", facts)
    return held


def _in_the_air(held: Mission) -> list[RefusalReason]:
    """Return reasons for UAVs in the air with a route of the mission, unless they fly another one by now."""
    own = held.mission_uavs.filter(uav__isnull=False, route__geometry__isnull=False).exclude(uav__in=busy_elsewhere(held))
    names = dict(own.values_list("uav", "name"))
    return [
        RefusalReason("in_the_air", _("%(uav)s is in the air: the mission can be closed once it is down.") % {"uav": names[uav_id]})
        for uav_id in sorted(uavs_in_the_air(list(names)))
    ]


def _end_state(held: Mission, had_open_targets: bool) -> MissionState:
    if held.routes.filter(has_failed=True).exists():
        return MissionState.FAILED
    return MissionState.ABORTED if had_open_targets else MissionState.COMPLETED


def _drop_from_uavs(held: Mission, actor: User) -> None:
    approval = approval_in_force(held)
    if held.state != MissionState.DISPATCHED or approval is None:
        return
    for uav in Uav.objects.filter(pk__in=uavs_that_may_hold(approval)).order_by("pk"):
        queue_command(uav=uav, kind=CommandKind.CLEAR_MISSION, actor=actor, why="", mission=held, approval=approval)
