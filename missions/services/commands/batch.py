"""Commands to several UAVs of missions at once: one request with one answer per UAV."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any
from uuid import UUID

from django.db import transaction
from django.utils.translation import gettext as _

from missions.command_rules import SETS_IN_MOTION
from missions.hooks.in_air import uavs_never_connected, uavs_on_the_ground
from missions.models import CommandKind, Mission, MissionState, Uav, UavCommand
from missions.selectors.commands import places_in_flight
from missions.services.commands.flight_progress import ON_ITS_WAY
from missions.services.commands.refused import RefusalReason, Refused, refuse
from missions.services.commands.steering import command_uav
from workspace.models import User

BATCH_KINDS = frozenset({CommandKind.PAUSE, CommandKind.RESUME, CommandKind.HOLD, CommandKind.RETURN, CommandKind.LAND})
REACHABLE = (*ON_ITS_WAY, MissionState.ABORTED, MissionState.FAILED)  # UAVs of an aborted mission may be returning


@dataclass(frozen=True)
class Scope:
    """The UAVs that a batch is for: UAVs of a mission by their ids; None for all with a route of it sent or in flight."""

    mission: Mission
    uavs: Collection[int] | None = None


@dataclass(frozen=True)
class UavAnswer:
    """Outcome of a batch for one UAV: a command, or the reasons why it got none.

    `name` is empty for a UAV that the organisation does not have, `place` None for one without a route of the mission.
    """

    mission: UUID
    uav: int
    name: str = ""
    place: int | None = None
    command: UavCommand | None = None
    reasons: tuple[RefusalReason, ...] = ()

    @property
    def is_accepted(self) -> bool:
        return self.command is not None


def command_missions(
    *, scopes: Sequence[Scope], kind: CommandKind, actor: User, why: str = "", ways: Mapping[int, dict[str, Any]] | None = None
) -> list[UavAnswer]:
    """Give UAVs of these missions a command in one transaction: a refusal for one UAV does not affect the others.

    Only UAVs with a route of the named mission sent or in flight get it. ways: for UAV ids, the parameters of a return. Raises Refused for
    a kind that is not in BATCH_KINDS, for `ways` of another kind than a return, and where no UAV is named and no mission has a UAV to
    reach.
    """
    if kind not in BATCH_KINDS:
        raise refuse("no_batch", _("This command is given to one UAV at a time."))
    if ways and kind != CommandKind.RETURN:
        raise refuse("no_parameters", _("This command has no parameters."))
    with transaction.atomic():
        _hold(scopes, kind)
        answers = [answer for scope in scopes for answer in _command_mission(scope, kind, actor, why, ways or {})]
    if not answers:
        raise refuse("nobody_in_mission", _("No UAV has a route of this mission sent or in flight."))
    return answers


def _hold(scopes: Sequence[Scope], kind: CommandKind) -> None:
    """Lock rows in the order mission, UAV; a command that stops a UAV does not wait for a holder of its mission."""
    missions = sorted({scope.mission.pk for scope in scopes})
    if kind in SETS_IN_MOTION:
        list(Mission.objects.select_for_update(no_key=True).filter(pk__in=missions).order_by("pk").values_list("pk"))
    flown_by = Uav.objects.filter(mission_uavs__mission__in=missions).values("pk")
    list(Uav.objects.select_for_update(no_key=True).filter(pk__in=flown_by).order_by("pk").values_list("pk"))


def _command_mission(scope: Scope, kind: CommandKind, actor: User, why: str, ways: Mapping[int, dict[str, Any]]) -> list[UavAnswer]:
    mission = scope.mission
    places = places_in_flight(mission) if mission.state in REACHABLE else {}
    on_the_ground, never_connected = uavs_on_the_ground(places), uavs_never_connected(places)
    wanted = sorted(places, key=places.__getitem__) if scope.uavs is None else list(dict.fromkeys(scope.uavs))
    uavs = {uav.pk: uav for uav in Uav.objects.filter(organisation=mission.organisation_id, pk__in=wanted)}
    answers = []
    for uav_id in wanted:
        uav, place = uavs.get(uav_id), places.get(uav_id)
        if uav is None:
            reason = RefusalReason("not_in_mission", _("This UAV has no route of this mission sent or in flight."))
            answers.append(UavAnswer(mission.pk, uav_id, reasons=(reason,)))
        elif place is None:
            reason = RefusalReason("not_in_mission", _("%(uav)s has no route of this mission sent or in flight.") % {"uav": uav.name})
            answers.append(UavAnswer(mission.pk, uav_id, uav.name, reasons=(reason,)))
        elif uav_id in never_connected:
            reason = RefusalReason("never_connected", _("%(uav)s never connected.") % {"uav": uav.name}, place)
            answers.append(UavAnswer(mission.pk, uav_id, uav.name, place, reasons=(reason,)))
        elif uav_id in on_the_ground:
            reason = RefusalReason("on_the_ground", _("%(uav)s is on the ground.") % {"uav": uav.name}, place)
            answers.append(UavAnswer(mission.pk, uav_id, uav.name, place, reasons=(reason,)))
        else:
            answers.append(_command(mission, uav, place, kind, actor, why, dict(ways.get(uav_id, {}))))
    return answers


def _command(
    mission: Mission, uav: Uav, place: int | None, kind: CommandKind, actor: User, why: str, parameters: dict[str, Any]
) -> UavAnswer:
    try:
        with transaction.atomic():
            command = command_uav(uav=uav, kind=kind, actor=actor, why=why, parameters=parameters)
    except Refused as error:
        return UavAnswer(mission.pk, uav.pk, uav.name, place, reasons=error.reasons)
    return UavAnswer(mission.pk, uav.pk, uav.name, place, command)
