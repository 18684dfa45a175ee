"""Leases of simulations by simulators, and the states that these store.

Another simulator may take a simulation when its lease has expired. One with the same name may take it before: it is the same one,
restarted. UAVs that the failed one had in the air are lost, like real ones: no flight continues in mid-air.
"""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from datetime import timedelta
from typing import Any
from uuid import UUID

from django.db import transaction
from django.db.models import F
from django.db.models.functions import Now
from django.utils import timezone

from missions.models import LinkKind, Mission, MissionState
from simulation.models import SimulatedVehicle, Simulation, SimulationChange, SimulationState
from simulation.services.simulations import end_now, end_vehicles_now, note
from simulation.vehicle_models import PRESENT
from workspace.leases import is_free_for, release, renew, take

AFTER_MISSION = timedelta(minutes=10)  # simulated UAVs of a mission stay this long after its end
OVER = (MissionState.COMPLETED, MissionState.ABORTED, MissionState.FAILED)


@dataclass(frozen=True)
class LeasedSimulation:
    """A leased simulation with its vehicles to fly."""

    simulation: Simulation
    vehicles: tuple[SimulatedVehicle, ...]


def take_simulation(*, holder: str, lease_s: float, most_load: float, flown: Collection[UUID]) -> LeasedSimulation | None:
    """Take the longest waiting simulation whose UAVs times speed are at most most_load; any if none is `flown` yet.

    Expired ones are ended. A simulation with the holder's name that is not flown was abandoned, and starts again.
    """
    with transaction.atomic():
        now = timezone.now()
        waiting = Simulation.objects.filter(is_free_for(holder, lease_s=lease_s), state__in=PRESENT).exclude(pk__in=flown)
        for simulation in waiting.select_for_update(skip_locked=True, of=("self",)).order_by("created_at"):
            if (reason := _why_over(simulation)) is not None:
                _end(simulation, reason)
                continue
            if flown and simulation.vehicles.filter(state__in=PRESENT).count() * simulation.speed > most_load:
                continue
            vehicles = _to_fly(simulation)
            if not vehicles:
                continue
            take(Simulation.objects.filter(pk=simulation.pk), holder=holder, lease_s=lease_s, state=SimulationState.FLYING)
            # Weather is stored with each vehicle, speed with the simulation; faults of a lost flight are dropped.
            is_first = simulation.restarts == 0
            if not is_first:
                SimulationChange.objects.filter(simulation=simulation, done_at=None).update(done_at=now)
            return LeasedSimulation(simulation, tuple(vehicles))
    return None


def renew_simulations(*, holder: str, ids: Collection[UUID], lease_s: float) -> set[UUID]:
    """Return the simulations still held."""
    return set(renew(Simulation.objects.filter(pk__in=ids, holder=holder, state__in=PRESENT), lease_s=lease_s))


def release_simulations(*, holder: str) -> None:
    """Release all simulations. The next simulator treats them as after a failure: no flight continues in mid-air."""
    release(Simulation.objects.filter(holder=holder), holder="")


def end_those_over(*, holder: str, ids: Collection[UUID]) -> set[UUID]:
    """End held simulations whose end is requested, whose time or mission is over, or that may not be flown any more. Returns their ids."""
    ended = set()
    with transaction.atomic():
        for simulation in Simulation.objects.filter(pk__in=ids, holder=holder, state__in=PRESENT).select_for_update(of=("self",)):
            reason = _why_over(simulation)
            if reason is not None:
                _end(simulation, reason)
                ended.add(simulation.pk)
    return ended


def end_single_ones(*, holder: str, ids: Collection[UUID]) -> list[SimulatedVehicle]:
    """Return vehicles of held simulations whose own end is requested, and mark them as ended."""
    with transaction.atomic():
        held = Simulation.objects.filter(pk__in=ids, holder=holder, state__in=PRESENT).select_for_update(of=("self",))
        found = SimulatedVehicle.objects.filter(simulation__in=list(held), state__in=PRESENT, end_wanted_at__isnull=False)
        vehicles = list(found)
        end_vehicles_now([vehicle.pk for vehicle in vehicles])
    return vehicles


def fail_simulation(*, simulation: Simulation, reason: str) -> None:
    """Mark a simulation that cannot be flown as failed."""
    with transaction.atomic():
        end_now(simulation, reason, state=SimulationState.FAILED)
        note(simulation, None, "fail", {"reason": reason})


def take_changes(*, ids: Collection[UUID]) -> list[SimulationChange]:
    """Return pending changes in the order of request; each is returned once."""
    with transaction.atomic():
        found = SimulationChange.objects.filter(simulation__in=ids, done_at=None).select_for_update(of=("self",))
        changes = list(found.select_related("vehicle"))
        SimulationChange.objects.filter(pk__in=[change.pk for change in changes]).update(done_at=Now())
    return changes


def notify(*, simulation_id: UUID, holder: str, step_timing: Mapping[str, Any], vehicles: Mapping[UUID, Mapping[str, Any]]) -> None:
    """Store the step timing and the state of each vehicle; nothing if another simulator holds the simulation."""
    with transaction.atomic():
        if not Simulation.objects.filter(pk=simulation_id, holder=holder).update(step_timing=dict(step_timing)):
            return
        rows = [SimulatedVehicle(pk=pk, reported=dict(reported), reported_at=timezone.now()) for pk, reported in vehicles.items()]
        SimulatedVehicle.objects.bulk_update(rows, ["reported", "reported_at"])


def _why_over(simulation: Simulation) -> str | None:
    if simulation.end_wanted_at is not None:
        return "ended-by-hand"
    if simulation.lifetime_ends_at <= timezone.now():
        return "lifetime-over"
    vehicles = simulation.vehicles.filter(state__in=PRESENT, uav__isnull=False)
    if vehicles.exclude(uav__is_simulated=True, uav__link=LinkKind.MAVLINK, uav__mavlink_system_id=F("system_id")).exists():
        return "uav-changed"
    mission = simulation.mission
    if mission is not None and (mission.deleted_at is not None or _is_long_over(mission)):
        return "mission-over"
    return None


def _is_long_over(mission: Mission) -> bool:
    """Whether the mission ended some time ago, and so did all that continue it."""
    if mission.state not in OVER or (mission.ended_at is not None and mission.ended_at + AFTER_MISSION > timezone.now()):
        return False
    return all(map(_is_long_over, mission.continued_by.filter(deleted_at=None)))


def _end(simulation: Simulation, reason: str) -> None:
    end_now(simulation, reason)
    if reason != "ended-by-hand":  # already in the history
        note(simulation, None, "end", {"reason": reason})


def _to_fly(simulation: Simulation) -> list[SimulatedVehicle]:
    """Return the vehicles to fly: all at first.

    After the loss of a simulator: those on the ground, and in the pool also those in the air, all from their first place. A mission's UAV
    that was in the air is lost; if all are, the simulation has failed.
    """
    vehicles = list(simulation.vehicles.filter(state__in=PRESENT).select_related("uav"))
    if simulation.state == SimulationState.FLYING:
        lost = [vehicle for vehicle in vehicles if simulation.mission_id is not None and _is_gone(vehicle)]
        vehicles = [vehicle for vehicle in vehicles if vehicle not in lost]
        keys = [vehicle.pk for vehicle in lost]
        SimulatedVehicle.objects.filter(pk__in=keys).update(state=SimulationState.FAILED, reason="simulator-lost")
        simulation.restarts += 1
        Simulation.objects.filter(pk=simulation.pk).update(restarts=simulation.restarts)
        note(simulation, None, "restart", {"lost": [vehicle.name for vehicle in lost], "again": [vehicle.name for vehicle in vehicles]})
        if not vehicles:
            end_now(simulation, "simulator-lost", state=SimulationState.FAILED)
            return []
    again = F("restarts") + (1 if simulation.state == SimulationState.FLYING else 0)
    SimulatedVehicle.objects.filter(pk__in=[vehicle.pk for vehicle in vehicles]).update(
        state=SimulationState.FLYING, restarts=again, reported={}
    )
    return vehicles


def _is_gone(vehicle: SimulatedVehicle) -> bool:
    """Return whether it was in the air or had crashed, and so does not stand intact on the ground."""
    return bool(vehicle.reported.get("is_in_air") or vehicle.reported.get("is_crashed"))
