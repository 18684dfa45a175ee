"""A return that begins after something else: a hold of some seconds, or another return height.

Each step is given when the one before was seen to be done, in the same transaction. Whoever gives the UAV another command about its
flight meanwhile ends it: that command counts.
"""

from django.utils import timezone

from missions.command_rules import THEN_RETURN, WAIT_S
from missions.models import CommandAxis, CommandKind, Uav, UavCommand
from missions.services.outbox import queue_command
from workspace.models import User


def hold_then_return(*, uav: Uav, wait_s: float, actor: User | None, why: str = "", **about: object) -> UavCommand:
    """Give a hold, after which the UAV is told to return once so many seconds have passed since now. about: mission and approval."""
    parameters = {THEN_RETURN: True, WAIT_S: wait_s}
    return queue_command(uav=uav, kind=CommandKind.HOLD, actor=actor, why=why, parameters=parameters, **about)  # type: ignore[arg-type]


def return_after(command: UavCommand) -> UavCommand | None:
    """The return after a step that was just seen to be done; None where its UAV was given another command about its flight since."""
    later = UavCommand.objects.filter(uav=command.uav_id, axis=CommandAxis.FLIGHT, sequence__gt=command.sequence)
    if later.exists():
        return None
    passed_s = (timezone.now() - command.created_at).total_seconds()
    wait_s = max(float(command.parameters.get(WAIT_S, 0.0)) - passed_s, 0.0)
    return queue_command(
        uav=command.uav, kind=CommandKind.RETURN, actor=command.created_by, why=command.why, mission=command.mission,
        approval=command.approval, parameters={WAIT_S: round(wait_s, 1)} if wait_s > 0.0 else {}, wait_s=wait_s,
    )  # fmt: skip
