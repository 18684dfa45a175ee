"""A return after a hold of some seconds, a new return height, or both, in this order.

Each step is given in the transaction that records the previous one as done. Another flight command given to the UAV meanwhile ends the
sequence and takes effect. If a step fails, no return is sent.
"""

from collections.abc import Mapping
from datetime import timedelta
from typing import Any

from django.db.models import Q
from django.utils import timezone

from missions.command_rules import ALONG_ROUTE, HEIGHT_M, THEN_RETURN, WAIT_S
from missions.models import OPEN_COMMANDS, CommandAxis, CommandKind, CommandState, Uav, UavCommand
from missions.services.commands.outbox import SUPERSEDED, WITHDRAWN, queue_command
from workspace.models import User

HEIGHT_WANTED_S = 60.0  # lifetime of a return height that a return waits for
STUCK_FOR_S = 4 * 3_600.0


def return_in_steps(*, uav: Uav, parameters: Mapping[str, Any], actor: User | None, why: str = "", **about: object) -> UavCommand:
    """Queue the first step of a return with a wait, a height, or both. about: mission and approval."""
    steps: dict[str, Any] = {name: parameters[name] for name in (WAIT_S, HEIGHT_M) if name in parameters} | {THEN_RETURN: True}
    if WAIT_S in steps:
        return queue_command(uav=uav, kind=CommandKind.HOLD, actor=actor, why=why, parameters=steps, **about)  # type: ignore[arg-type]
    return queue_command(
        uav=uav, kind=CommandKind.SET_RETURN_HEIGHT, actor=actor, why=why, parameters=steps, expires_in_s=HEIGHT_WANTED_S,
        **about,  # type: ignore[arg-type]
    )  # fmt: skip


def return_after(command: UavCommand) -> UavCommand | None:
    """Queue the next step after one that was just confirmed; returns None where its UAV got another flight command since."""
    later = UavCommand.objects.filter(uav=command.uav_id, axis=CommandAxis.FLIGHT, sequence__gt=command.sequence)
    if later.exists():
        return None
    passed_s = (timezone.now() - command.created_at).total_seconds()
    wait_s = round(max(float(command.parameters.get(WAIT_S, 0.0)) - passed_s, 0.0), 1)
    waits = {WAIT_S: wait_s} if wait_s > 0.0 else {}
    about: dict[str, Any] = {
        "uav": command.uav, "actor": command.created_by, "why": command.why, "mission": command.mission, "approval": command.approval,
    }  # fmt: skip
    if command.kind == CommandKind.HOLD and HEIGHT_M in command.parameters:
        steps = waits | {HEIGHT_M: command.parameters[HEIGHT_M], THEN_RETURN: True}
        return queue_command(kind=CommandKind.SET_RETURN_HEIGHT, parameters=steps, expires_in_s=HEIGHT_WANTED_S, **about)
    return queue_command(kind=CommandKind.RETURN, parameters=waits, wait_s=wait_s, **about)


def stuck_returns() -> list[UavCommand]:
    """Return steps of returns that failed or expired, so that no return followed, and returns that failed.

    UAVs that were given another flight command since are left out.
    """
    since = timezone.now() - timedelta(seconds=STUCK_FOR_S)
    steps = Q(**{f"parameters__{THEN_RETURN}": True}) | Q(**{f"parameters__{ALONG_ROUTE}": True})
    asked = steps | Q(kind=CommandKind.RETURN, state=CommandState.FAILED)
    ended = UavCommand.objects.filter(asked, created_at__gte=since).exclude(state=CommandState.APPLIED).exclude(state__in=OPEN_COMMANDS)
    found: dict[int, UavCommand] = {}
    for command in ended.exclude(outcome_code__in=[SUPERSEDED, WITHDRAWN]).select_related("uav", "mission").order_by("sequence"):
        later = UavCommand.objects.filter(uav=command.uav_id, sequence__gt=command.sequence)
        if not later.filter(Q(axis=CommandAxis.FLIGHT) | steps).exists():
            found[command.uav_id] = command
    return list(found.values())
