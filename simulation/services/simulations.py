"""Simulated UAVs in real time: started for the pool, changed in flight, ended."""

import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta
from typing import Any
from uuid import UUID

from django.conf import settings
from django.contrib.gis.geos import Point
from django.db import transaction
from django.db.models import Q
from django.utils import timezone

from inspection.geodesy import LonLat
from simulation.models import SimulatedAutopilotType, SimulatedVehicle, Simulation, SimulationChange, SimulationState
from simulation.rehearsing.weather_scenario import WeatherScenario, scenario_to_json
from simulation.services.idle_twins import end_copy, retire_idle_twins
from simulation.vehicle_models import PRESENT
from workspace.audit import record_change
from workspace.leases import has_run_out, is_free, lock_until_end
from workspace.models import Organisation, User

KEPT = 200  # simulations of an organisation that are over
_STARTS = 7_309_118  # the advisory lock under which quotas and ports are counted


class QuotaReached(Exception):
    """The organisation has as many simulated UAVs as it may; `free` are left."""

    def __init__(self, free: int) -> None:
        super().__init__(free)
        self.free = free


class NoPortFree(Exception):
    """Every port of the pool is taken."""


class IsOver(Exception):
    """The simulation has ended."""


@dataclass(frozen=True)
class PoolUav:
    """One UAV of the pool as it is wanted."""

    position: LonLat
    name: str = ""
    heading_deg: float = 0.0
    ground_amsl_m: float | None = None


def start_pool(
    *,
    organisation: Organisation,
    actor: User,
    uavs: Sequence[PoolUav],
    lifetime_s: float,
    scenario: WeatherScenario,
    airframe: str,
    autopilot_type: SimulatedAutopilotType = SimulatedAutopilotType.PX4,
    speed: float = 1.0,
    first_system_id: int = 1,
    seed: int = 7,
    faults: Mapping[str, Any] | None = None,
) -> Simulation:
    """UAVs that listen at ports of their own. Raises QuotaReached, NoPortFree."""
    with transaction.atomic():
        hold_starts()
        check_quota(organisation, len(uavs))
        ports = _free_ports(len(uavs))
        simulation = Simulation.objects.create(
            organisation=organisation, speed=speed, seed=seed, lifetime_ends_at=lifetime_end(lifetime_s), created_by=actor
        )
        SimulatedVehicle.objects.bulk_create(
            SimulatedVehicle(
                simulation=simulation,
                sequence=number,
                name=uav.name or f"Sim {first_system_id + number}",
                system_id=first_system_id + number,
                autopilot_type=autopilot_type,
                airframe=airframe,
                position=Point(*uav.position, srid=4326),
                ground_amsl_m=uav.ground_amsl_m,
                heading_deg=uav.heading_deg,
                conditions=scenario_to_json(scenario),
                port=ports[number],
            )
            for number, uav in enumerate(uavs)
        )
        note_start(simulation, actor, speed=speed, uavs=len(uavs), faults=faults)
    return simulation


def change_simulation(
    *,
    simulation: Simulation,
    actor: User,
    vehicle: SimulatedVehicle | None = None,
    speed: float | None = None,
    scenario: WeatherScenario | None = None,
    faults: Mapping[str, Any] | None = None,
) -> SimulationChange:
    """Of one vehicle, or of all; the speed is everybody's. Raises IsOver."""
    with transaction.atomic():
        held = Simulation.objects.select_for_update().get(pk=simulation.pk)
        if not held.is_present or held.end_wanted_at is not None:
            raise IsOver
        reported = None if scenario is None else scenario_to_json(scenario)
        if speed is not None:
            Simulation.objects.filter(pk=held.pk).update(speed=speed)
        if reported is not None:  # a vehicle that is put on the ground anew finds the same air
            vehicles = SimulatedVehicle.objects.filter(simulation=held)
            (vehicles if vehicle is None else vehicles.filter(pk=vehicle.pk)).update(conditions=reported)
        change = SimulationChange.objects.create(
            simulation=held,
            vehicle=vehicle,
            speed=speed,
            conditions=reported,
            faults=None if faults is None else dict(faults),
            created_by=actor,
        )
        facts = {
            "vehicle": None if vehicle is None else vehicle.name, "speed": speed, "conditions": reported, "faults": change.faults,
        }  # fmt: skip
        note(held, actor, "change", {name: value for name, value in facts.items() if value is not None})
    return change


def end_simulation(*, simulation: Simulation, actor: User) -> None:
    """Its simulator ends it within a second; without one it ends at once. One that is over stays as it is."""
    with transaction.atomic():
        held = Simulation.objects.select_for_update().get(pk=simulation.pk)
        if not held.is_present or held.end_wanted_at is not None:
            return
        now = timezone.now()
        held.end_wanted_at = now
        held.save(update_fields=["end_wanted_at"])
        if has_run_out(held.lease_expires_at):
            end_now(held, "ended-by-hand")
        note(held, actor, "end", {})


def end_vehicle(*, vehicle: SimulatedVehicle, actor: User) -> None:
    """Of several; with the last one its simulation ends. One that is over stays as it is."""
    with transaction.atomic():
        held = Simulation.objects.select_for_update().get(pk=vehicle.simulation_id)
        wanted = held.vehicles.filter(state__in=PRESENT, end_wanted_at=None)
        if not held.is_present or held.end_wanted_at is not None or not wanted.filter(pk=vehicle.pk).exists():
            return
        if wanted.count() == 1:
            end_simulation(simulation=held, actor=actor)
            return
        now = timezone.now()
        wanted.filter(pk=vehicle.pk).update(end_wanted_at=now)
        if has_run_out(held.lease_expires_at):
            end_vehicles_now([vehicle.pk])
        note(held, actor, "end", {"vehicle": vehicle.name})


def end_vehicles_now(keys: Collection[UUID]) -> None:
    """Single ones, by hand. Whoever calls holds their simulations, or nobody does."""
    SimulatedVehicle.objects.filter(pk__in=keys, state__in=PRESENT).update(state=SimulationState.ENDED, reason="ended-by-hand")


def end_now(simulation: Simulation, reason: str, *, state: SimulationState = SimulationState.ENDED) -> None:
    """Whoever calls holds it, or nobody does."""
    simulation.vehicles.filter(state__in=PRESENT).update(state=state, reason=reason)
    Simulation.objects.filter(pk=simulation.pk, state__in=PRESENT).update(
        state=state, reason=reason, ended_at=timezone.now(), holder="", lease_expires_at=None
    )
    if simulation.mission is not None:
        end_copy(simulation.mission)
    retire_idle_twins(organisation=simulation.organisation, actor=None)


def hold_starts() -> None:
    """Until the transaction ends: of two that start at once the second counts the first one's. What is over and nobody holds is ended."""
    lock_until_end(_STARTS)
    now = timezone.now()
    unheld = Simulation.objects.filter(is_free(), state__in=PRESENT)
    for simulation in unheld.filter(Q(lifetime_ends_at__lte=now) | Q(end_wanted_at__isnull=False)):
        end_now(simulation, "ended-by-hand" if simulation.end_wanted_at else "lifetime-over")


def check_quota(organisation: Organisation, wanted: int) -> None:
    """Raises QuotaReached. What has outlived its time counts no more, whether or not a simulator was there to end it."""
    present = SimulatedVehicle.objects.filter(
        simulation__organisation=organisation,
        simulation__lifetime_ends_at__gt=timezone.now(),
        simulation__end_wanted_at=None,
        state__in=PRESENT,
    ).count()
    if present + wanted > settings.MAX_SIMULATED_UAVS:
        raise QuotaReached(max(settings.MAX_SIMULATED_UAVS - present, 0))


def note_start(simulation: Simulation, actor: User, *, speed: float, uavs: int, faults: Mapping[str, Any] | None) -> None:
    """With the faults that it begins with; and what is long over is forgotten."""
    if faults:
        SimulationChange.objects.create(simulation=simulation, faults=dict(faults), created_by=actor)
    note(simulation, actor, "start", {"uavs": uavs, "speed": speed, "faults": dict(faults or {})})
    over = Simulation.objects.filter(organisation=simulation.organisation).exclude(state__in=PRESENT).order_by("-created_at")
    Simulation.objects.filter(pk__in=list(over.values_list("pk", flat=True)[KEPT:])).delete()


def note(simulation: Simulation, actor: User | None, action: str, facts: dict[str, Any]) -> None:
    """In the organisation's history."""
    mission = None if simulation.mission_id is None else str(simulation.mission_id)
    record_change(
        organisation=simulation.organisation, actor=actor, action=action, subject_type="simulation", subject_id=simulation.pk,
        after={"mission": mission, **facts},
    )  # fmt: skip


def lifetime_end(lifetime_s: float) -> datetime:
    """From now; no simulation lasts longer than the setting says."""
    return timezone.now() + timedelta(seconds=min(lifetime_s, settings.MAX_SIMULATION_H * 3_600.0))


def _free_ports(count: int) -> list[int]:
    first, last = port_range()
    taken = set(SimulatedVehicle.objects.filter(state__in=PRESENT, port__isnull=False).values_list("port", flat=True))
    free = [port for port in range(first, last + 1) if port not in taken][:count]
    if len(free) < count:
        raise NoPortFree
    return free


def port_range() -> tuple[int, int]:
    """The first and the last port of the pool. Raises ValueError for a setting that is none."""
    found = re.fullmatch(r"(\d+)-(\d+)", settings.SIMULATOR_PORTS.strip())
    if found is None:
        raise ValueError("SPANWISE_SIMULATOR_PORTS is FIRST-LAST.")
    return int(found[1]), int(found[2])
