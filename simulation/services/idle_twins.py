"""Simulated twins that fly nothing are retired: an installation has few MAVLink system ids."""

from collections.abc import Collection

from django.db.models import Exists, OuterRef, Q

from missions.models import MissionState, MissionUav, Uav, UavState
from missions.services.refused import Refused
from missions.services.uavs import change_uav
from simulation.models import SimulatedVehicle
from simulation.vehicle_models import PRESENT
from workspace.models import Organisation, User

MAY_FLY = (MissionState.APPROVED, MissionState.DISPATCHED, MissionState.ACTIVE)


def retire_idle_twins(*, organisation: Organisation, actor: User | None, but: Collection[int] = ()) -> None:
    """Twins of which no copy is to be flown any more give their MAVLink system ids back. They come back with the next copy."""
    flown = MissionUav.objects.filter(uav=OuterRef("pk"), mission__state__in=MAY_FLY, mission__deleted_at=None)
    present = SimulatedVehicle.objects.filter(uav=OuterRef("pk"), state__in=PRESENT)
    idle = Uav.objects.filter(~Exists(flown), ~Exists(present), organisation=organisation, twin_of__isnull=False)
    for twin in idle.exclude(Q(state=UavState.RETIRED) | Q(pk__in=but)):
        try:
            change_uav(uav=twin, actor=actor, position=None, values={"state": UavState.RETIRED})
        except Refused:  # something is on its way to it
            continue
