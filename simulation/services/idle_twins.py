"""Cleans up after a copy's simulation: ends the copy, and retires unused twins, as system ids are few."""

from collections.abc import Collection

from django.db import transaction
from django.db.models import Exists, OuterRef, Q

from missions.models import Mission, MissionState, MissionUav, Uav, UavCommand, UavState
from missions.services.approval.approval import change_state
from missions.services.commands.flight_progress import ON_ITS_WAY, UNDECIDED
from missions.services.commands.outbox import end_commands
from missions.services.commands.refused import Refused
from missions.services.fleet.rows import FleetChanged
from missions.services.fleet.uavs import change_uav
from operation.reasons import Reason
from simulation.models import SimulatedVehicle
from simulation.vehicle_models import PRESENT
from workspace.models import Organisation, User

SIMULATION_ENDED = "simulation-ended"  # outcome of commands to twins that are gone


def end_copy(mission: Mission) -> None:
    """End a simulated copy that was sent to twins that are gone, and what continues it; other missions stay unchanged."""
    with transaction.atomic():
        held = Mission.objects.select_for_update(no_key=True).get(pk=mission.pk)
        if held.simulates_id is None:
            return
        if held.state in ON_ITS_WAY:
            end_commands(UavCommand.objects.filter(mission=held), code=SIMULATION_ENDED, why=(Reason("simulation_ended"),))
            ended = MissionState.ABORTED if held.targets.filter(state__in=UNDECIDED).exists() else MissionState.COMPLETED
            change_state(held, ended, None, "close", {"why": "The simulation has ended."})
        for continuation in held.continued_by.all():
            end_copy(continuation)


def retire_idle_twins(*, organisation: Organisation, actor: User | None, but: Collection[int] = ()) -> None:
    """Retire twins that fly no copy any more, and release their MAVLink system ids. The next copy reactivates them."""
    flown = MissionUav.objects.filter(uav=OuterRef("pk"), mission__state__in=ON_ITS_WAY, mission__deleted_at=None)
    present = SimulatedVehicle.objects.filter(uav=OuterRef("pk"), state__in=PRESENT)
    idle = Uav.objects.filter(~Exists(flown), ~Exists(present), organisation=organisation, twin_of__isnull=False)
    for twin in idle.exclude(Q(state=UavState.RETIRED) | Q(pk__in=but)):
        try:
            change_uav(uav=twin, actor=actor, position=None, values={"state": UavState.RETIRED})
        except (Refused, FleetChanged):  # a command for it is under way, or it was deleted
            continue
