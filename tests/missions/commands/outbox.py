"""UAVs, commands to them, and somebody who carries these."""

from datetime import timedelta
from typing import Any

from django.contrib.gis.geos import Point
from django.utils import timezone

from missions.models import CommandKind, Uav, UavCommand, UavType
from missions.services.commands.commands import claim_commands, queue_command
from tests.missions.worlds import UAV_AT
from workspace.models import Organisation, User

LEASE_S = 15.0
LONG_AGO = timedelta(hours=1)


def a_uav(name: str = "Kite", organisation: Organisation | None = None, **facts: Any) -> Uav:
    """A UAV that can be planned: without a range of its own, its type's is unlimited."""
    owner = {} if organisation is None else {"organisation": organisation}
    own = {"end_action": "hover", "uav_type": unlimited_type(organisation), **facts}
    return Uav.objects.create(name=name, location=Point(*UAV_AT, srid=4326), **owner, **own)


def unlimited_type(organisation: Organisation | None = None) -> UavType:
    owner = {} if organisation is None else {"organisation": organisation}
    return UavType.objects.get_or_create(name="Unlimited", **owner, defaults={"range_unlimited": True})[0]


def give(uav: Uav, kind: CommandKind, actor: User | None = None, **more: Any) -> UavCommand:
    return queue_command(uav=uav, kind=kind, actor=actor, **more)


def claim(*uavs: Uav, holder: str = "gateway-1", limit: int = 10) -> list[UavCommand]:
    return claim_commands(uav_ids=[uav.pk for uav in uavs], holder=holder, lease_s=LEASE_S, limit=limit)


def fence(command: UavCommand) -> dict[str, Any]:
    """What a holder says with each note."""
    return {"attempt": command.attempts, "holder": command.holder}


def lose(command: UavCommand) -> None:
    """Whoever carries it is dead: the lease runs out."""
    UavCommand.objects.filter(pk=command.pk).update(lease_expires_at=timezone.now() - LONG_AGO)


def grow_old(command: UavCommand) -> None:
    UavCommand.objects.filter(pk=command.pk).update(expires_at=timezone.now() - LONG_AGO)


def now(command: UavCommand) -> UavCommand:
    command.refresh_from_db()
    return command


def steps(command: UavCommand) -> list[tuple[str, int]]:
    return list(command.events.values_list("state", "attempt"))
