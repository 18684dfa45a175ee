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

KEPT = 200  # completed simulations per organisation
_STARTS = 7_309_118  # advisory lock for counting quotas and ports


class QuotaReached(Exception):
    """The organisation has reached its number of simulated UAVs; `free` are left."""

    def __init__(self, free: int) -> None:
        super().__init__(free)
        self.free = free


class NoPortFree(Exception):
    """All ports of the pool are in use."""


class IsOver(Exception):
    """The simulation has ended."""


@dataclass(frozen=True)
class PoolUav:
    """A requested UAV of the pool."""

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
    """Start UAVs that listen on their own ports. Raises QuotaReached, NoPortFree."""
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
    """Change one vehicle, or all; the speed always applies to all. Raises IsOver."""
    with transaction.atomic():
        held = Simulation.objects.select_for_update().get(pk=simulation.pk)
        if not held.is_present or held.end_wanted_at is not None:
            raise IsOver
        reported = None if scenario is None else scenario_to_json(scenario)
        if speed is not None:
            Simulation.objects.filter(pk=held.pk).update(speed=speed)
        if reported is not None:  # a restarted vehicle gets the same weather
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
    """End the simulation: its simulator does so within a second; without one it ends at once. A completed one stays unchanged."""
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
    """End one vehicle; with the last one its simulation ends. A completed one stays unchanged."""
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
    """End single vehicles on request. The caller holds their simulations, or they are not held."""
    SimulatedVehicle.objects.filter(pk__in=keys, state__in=PRESENT).update(state=SimulationState.ENDED, reason="ended-by-hand")


def end_now(simulation: Simulation, reason: str, *, state: SimulationState = SimulationState.ENDED) -> None:
    """End the simulation. The caller holds it, or it is not held."""
    simulation.vehicles.filter(state__in=PRESENT).update(state=state, reason=reason)
    Simulation.objects.filter(pk=simulation.pk, state__in=PRESENT).update(
        state=state, reason=reason, ended_at=timezone.now(), holder="", lease_expires_at=None
    )
    if simulation.mission is not None:
        end_copy(simulation.mission)
    retire_idle_twins(organisation=simulation.organisation, actor=None)


def hold_starts() -> None:
    """Lock starts until the end of the transaction, so that concurrent starts count each other. Ends expired free simulations."""
    lock_until_end(_STARTS)
    now = timezone.now()
    unheld = Simulation.objects.filter(is_free(), state__in=PRESENT)
    for simulation in unheld.filter(Q(lifetime_ends_at__lte=now) | Q(end_wanted_at__isnull=False)):
        end_now(simulation, "ended-by-hand" if simulation.end_wanted_at else "lifetime-over")


def check_quota(organisation: Organisation, wanted: int) -> None:
    """Check the quota. Expired simulations do not count, even if no simulator has ended them. Raises QuotaReached."""
    present = SimulatedVehicle.objects.filter(
        simulation__organisation=organisation,
        simulation__lifetime_ends_at__gt=timezone.now(),
        simulation__end_wanted_at=None,
        state__in=PRESENT,
    ).count()
    if present + wanted > settings.MAX_SIMULATED_UAVS:
        raise QuotaReached(max(settings.MAX_SIMULATED_UAVS - present, 0))


def note_start(simulation: Simulation, actor: User, *, speed: float, uavs: int, faults: Mapping[str, Any] | None) -> None:
    """Record the start with its initial faults, and delete old completed simulations."""
    if faults:
        SimulationChange.objects.create(simulation=simulation, faults=dict(faults), created_by=actor)
    note(simulation, actor, "start", {"uavs": uavs, "speed": speed, "faults": dict(faults or {})})
    over = Simulation.objects.filter(organisation=simulation.organisation).exclude(state__in=PRESENT).order_by("-created_at")
    Simulation.objects.filter(pk__in=list(over.values_list("pk", flat=True)[KEPT:])).delete()


def note(simulation: Simulation, actor: User | None, action: str, facts: dict[str, Any]) -> None:
    """Record the change in the organisation's history."""
    mission = None if simulation.mission_id is None else str(simulation.mission_id)
    record_change(
        organisation=simulation.organisation, actor=actor, action=action, subject_type="simulation", subject_id=simulation.pk,
        after={"mission": mission, **facts},
    )  # fmt: skip


def lifetime_end(lifetime_s: float) -> datetime:
    """Return the end of a lifetime from now, limited by the settings."""
    return timezone.now() + timedelta(seconds=min(lifetime_s, settings.MAX_SIMULATION_H * 3_600.0))


def _free_ports(count: int) -> list[int]:
    first, last = port_range()
    taken = set(SimulatedVehicle.objects.filter(state__in=PRESENT, port__isnull=False).values_list("port", flat=True))
    free = [port for port in range(first, last + 1) if port not in taken][:count]
    if len(free) < count:
        raise NoPortFree
    return free


def port_range() -> tuple[int, int]:
    """Return the first and last port of the pool. Raises ValueError for an invalid setting."""
    found = re.fullmatch(r"(\d+)-(\d+)", settings.SIMULATOR_PORTS.strip())
    if found is None:
        raise ValueError("SPANWISE_SIMULATOR_PORTS is FIRST-LAST.")
    return int(found[1]), int(found[2])
