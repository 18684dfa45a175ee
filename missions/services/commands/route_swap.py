"""Route swap in the air, step by step: hold, confirmed holding, upload while it hovers, readback, start.

Each step is given in the transaction that records the previous one as done. Another flight command given to the UAV meanwhile ends the
swap and takes effect. If a step fails, the UAV keeps hovering where it is.
"""

from missions.command_rules import HAND_OVER
from missions.models import OPEN_COMMANDS, CommandAxis, CommandKind, CommandState, Mission, Route, Uav, UavCommand
from missions.services.commands.flight_progress import ON_ITS_WAY
from missions.services.commands.outbox import SUPERSEDED, queue_command

NEXT = {CommandKind.HOLD: CommandKind.UPLOAD_MISSION, CommandKind.UPLOAD_MISSION: CommandKind.START}


def go_on_after(command: UavCommand) -> UavCommand | None:
    """Queue the next step after one that was just confirmed; returns None where there is none. The caller holds the mission's row."""
    kind = NEXT.get(CommandKind(command.kind))
    if kind is None or not command.parameters.get(HAND_OVER) or command.mission is None or command.approval is None:
        return None
    mission, uav = command.mission, command.uav
    if mission.state not in ON_ITS_WAY or command.approval.revoke_requested_at is not None or not _is_to_fly(mission, uav):
        return None
    last = UavCommand.objects.filter(uav=uav, axis=CommandAxis.FLIGHT).order_by("-sequence").first()
    if last is None or last.kind != CommandKind.HOLD or last.approval_id != command.approval_id or last.state != CommandState.APPLIED:
        return None
    return queue_command(
        uav=uav, kind=kind, actor=command.created_by, why=command.why, mission=mission, approval=command.approval,
        parameters={"flight": 1, HAND_OVER: True},
    )  # fmt: skip


def _is_to_fly(mission: Mission, uav: Uav) -> bool:
    return mission.routes.filter(mission_uav__uav=uav, begun_by__isnull=False, continued_by=None, has_failed=False).exists()


def stuck_hand_overs() -> list[UavCommand]:
    """Return the failed or expired steps of UAVs that have been hovering since without their other route.

    A UAV that was given another flight command since is left out.
    """
    routes = Route.objects.filter(mission__state__in=ON_ITS_WAY, mission__deleted_at=None, begun_by__isnull=False, continued_by=None)
    found = []
    for uav, mission in routes.filter(has_failed=False, mission_uav__uav__isnull=False).values_list("mission_uav__uav", "mission"):
        commands = UavCommand.objects.filter(uav=uav).select_related("uav", "mission").order_by("-sequence")
        last = commands.exclude(axis__in=[CommandAxis.SPEED, CommandAxis.PARAMETER]).first()
        if last is None or last.mission_id != mission or not last.parameters.get(HAND_OVER) or last.state in OPEN_COMMANDS:
            continue
        if last.state != CommandState.APPLIED and last.outcome_code != SUPERSEDED:
            found.append(last)
    return found
