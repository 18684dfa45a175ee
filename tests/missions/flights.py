"""A mission with UAVs of the fleet, planned on a sane world, and how it is approved and sent."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from inspection.models import Asset
from inspection.services import import_terrain
from missions.models import Approval, Mission, Uav, UavCommand
from missions.services import PlanRequest, UavRequest, create_mission, plan_mission
from missions.services.approval.approval import approve_mission
from missions.services.commands.commands import note_applied, note_sent
from missions.services.commands.dispatch import dispatch_mission
from planning.request import EndAction
from tests.accounts.users import a_user
from tests.inspection.importers.terrain.tiffs import write_geotiff
from tests.missions import worlds
from tests.missions.commands.outbox import a_uav, claim, fence
from workspace.models import User


def ground(path: Path, height_m: float = 100.0) -> Any:
    """Terrain under the world of tests."""
    return import_terrain(path=write_geotiff(path, np.full((300, 300), height_m, dtype="f4"), srid=9707, origin=(9.9, 56.15)))


def fleet(*names: str, **facts: Any) -> list[Uav]:
    return [a_uav(name, **{"is_simulated": True, **facts}) for name in names or ("Tern",)]


def planned(author: User, uavs: list[Uav], targets: list[Asset], *, name: str = "Bexley spring", **wishes: Any) -> Mission:
    draft = create_mission(organisation=author.organisation, author=author, name=name, request=asked(uavs, targets, **wishes))
    return plan_mission(mission=draft, actor=author)


def asked(uavs: list[Uav], targets: list[Asset], **wishes: Any) -> PlanRequest:
    """Each UAV does one target at most where there are several, so that all of them fly; they start 200 m apart."""
    flying: tuple[UavRequest, ...] = tuple(
        replace(
            worlds.uav((worlds.UAV_AT.lon + 0.004 * place, worlds.UAV_AT.lat), name=uav.name, end_action=EndAction.RETURN), uav=uav.pk,
            most_targets=1 if len(uavs) > 1 else None,
        )
        for place, uav in enumerate(uavs)
    )  # fmt: skip
    return worlds.request(*targets, uavs=flying, **wishes)


def approved(author: User, uavs: list[Uav], targets: list[Asset], **wishes: Any) -> tuple[Mission, Approval]:
    mission = planned(author, uavs, targets, **wishes)
    approval = approve_mission(mission=mission, actor=author)
    mission.refresh_from_db()
    return mission, approval


def dispatched(author: User, uavs: list[Uav], targets: list[Asset], **wishes: Any) -> Mission:
    mission, _approval = approved(author, uavs, targets, **wishes)
    dispatch_mission(mission=mission, actor=author)
    mission.refresh_from_db()
    return mission


def carry(*uavs: Uav) -> list[UavCommand]:
    """A gateway carries out all that waits for these."""
    commands = claim(*uavs)
    for command in commands:
        assert note_sent(command.pk, **fence(command))
        assert note_applied(command.pk, **fence(command))
    return commands


def an_operator() -> User:
    return a_user()
