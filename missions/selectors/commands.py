"""Reads of the outbox, always within one organisation."""

from django.db.models import OuterRef, Q, QuerySet

from missions.command_rules import HAND_OVER
from missions.models import OPEN_COMMANDS, Approval, CommandAxis, CommandKind, CommandState, Mission, Route, Uav, UavCommand
from workspace.models import Organisation

_REACHED = Q(state__in=OPEN_COMMANDS) | Q(state=CommandState.APPLIED) | Q(sent_at__isnull=False)
_SENDS_A_ROUTE = _REACHED & (Q(kind__in=[CommandKind.UPLOAD_MISSION, CommandKind.START]) | Q(parameters__has_key=HAND_OVER))
_TAKES_IT_OFF = Q(kind=CommandKind.CLEAR_MISSION, state=CommandState.APPLIED)

# For statements in which `place` is a row of missions_missionuav: the mission whose route was last sent to its UAV. As `route_commands`,
# but it ignores a route that was removed since.
SENT_LAST = """LEFT JOIN LATERAL (
        SELECT command.mission_id FROM missions_uavcommand command
        WHERE command.uav_id = place.uav_id AND command.mission_id IS NOT NULL
            AND (command.kind IN ('upload-mission', 'start') OR command.parameters ? 'hand_over')
            AND (command.state IN ('queued', 'sent', 'acknowledged', 'applied') OR command.sent_at IS NOT NULL)
        ORDER BY command.sequence DESC LIMIT 1
    ) sent ON true"""


def commands_of_organisation(organisation: Organisation) -> QuerySet[UavCommand]:
    return UavCommand.objects.filter(organisation=organisation).select_related("uav", "created_by")


def commands_of_mission(mission: Mission) -> QuerySet[UavCommand]:
    return mission.commands.select_related("uav", "created_by")


def commands_of_uav(uav: Uav) -> QuerySet[UavCommand]:
    return uav.commands.select_related("uav", "created_by")


def route_commands(uav: Uav | OuterRef) -> QuerySet[UavCommand]:
    """Return the commands that decide of which mission a UAV has a route, newest first: uploads sent or about to be sent, and removals."""
    return UavCommand.objects.filter(_SENDS_A_ROUTE | _TAKES_IT_OFF, uav=uav, mission__isnull=False).order_by("-sequence")


def upload_of(approval: Approval, uav_id: int | None) -> UavCommand | None:
    """Return the upload of this approval to a UAV, in any state; None where the UAV's last mission command is a different one."""
    last = UavCommand.objects.filter(uav=uav_id, axis=CommandAxis.MISSION).order_by("-sequence").first()
    return last if last is not None and last.kind == CommandKind.UPLOAD_MISSION and last.approval_id == approval.pk else None


def places_in_flight(mission: Mission) -> dict[int, int]:
    """Return the place in the mission, by UAV id, of each UAV with a route of it sent or in flight and none of another mission since."""
    flown = Route.objects.filter(mission=mission, mission_uav__uav__isnull=False, geometry__isnull=False, continued_by=None)
    places = dict(flown.values_list("mission_uav__uav", "mission_uav__sequence"))
    found = UavCommand.objects.filter(_SENDS_A_ROUTE | _TAKES_IT_OFF, uav__in=places, mission__isnull=False)
    newest = found.order_by("uav", "-sequence").distinct("uav").values_list("uav", "mission", "kind")
    return {uav: places[uav] for uav, of_mission, kind in newest if of_mission == mission.pk and kind != CommandKind.CLEAR_MISSION}
