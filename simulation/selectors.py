"""Reads of rehearsals and of simulated UAVs in real time, always within one organisation."""

from collections.abc import Mapping, Sequence
from typing import Any
from uuid import UUID

from django.db.models import QuerySet

from missions.hooks.events import EventKind, EventPlace, EventSource, MissionEvent
from missions.models import Mission, UavType
from simulation.models import Rehearsal, RehearsalRule, RehearsalTrack, SimulatedAirframe, SimulatedVehicle, Simulation, SimulationChange
from simulation.vehicle_models import reason_words
from workspace.models import JobState, Organisation


def rehearsals_of_mission(organisation: Organisation, mission_id: UUID) -> QuerySet[Rehearsal]:
    """Return the rehearsals without details of their assessments; see rehearsal_of_mission."""
    found = Rehearsal.objects.filter(organisation=organisation, mission=mission_id, mission__deleted_at=None)
    return found.select_related("job", "created_by").prefetch_related("runs")


def rehearsal_of_mission(organisation: Organisation, mission_id: UUID, rehearsal_id: UUID) -> Rehearsal:
    """Return a rehearsal. Raises Rehearsal.DoesNotExist, also for another organisation's."""
    return rehearsals_of_mission(organisation, mission_id).select_related("mission").get(pk=rehearsal_id)


def tracks_of_run(rehearsal: Rehearsal, sequence: int) -> QuerySet[RehearsalTrack]:
    return RehearsalTrack.objects.filter(run__rehearsal=rehearsal, run__sequence=sequence).order_by("uav")


def newest_finished(mission_id: UUID, content_sha256: str) -> Rehearsal | None:
    """Return the newest completed rehearsal of exactly this content."""
    found = Rehearsal.objects.filter(mission=mission_id, content_sha256=content_sha256, job__state=JobState.DONE)
    return found.order_by("-created_at").first()


def requires_green(organisation_id: int) -> bool:
    return RehearsalRule.objects.filter(organisation=organisation_id, requires_green=True).exists()


def chosen_airframe(uav_type: UavType) -> str | None:
    return SimulatedAirframe.objects.filter(uav_type=uav_type).values_list("airframe", flat=True).first()


def simulations_of_organisation(organisation: Organisation) -> QuerySet[Simulation]:
    found = Simulation.objects.filter(organisation=organisation).select_related("created_by", "mission")
    return found.prefetch_related("vehicles__uav")


def simulations_of_mission(organisation: Organisation, mission_id: UUID) -> QuerySet[Simulation]:
    """Return the simulations that fly a mission: its own or, of one that continues a simulated copy, those of the copy."""
    missions = [mission_id]
    while (continued := Mission.objects.filter(pk=missions[-1]).values_list("continues", flat=True).first()) is not None:
        missions.append(continued)
    return simulations_of_organisation(organisation).filter(mission__in=missions)


def vehicles_of_organisation(organisation: Organisation) -> QuerySet[SimulatedVehicle]:
    return SimulatedVehicle.objects.filter(simulation__organisation=organisation).select_related("simulation__organisation", "uav")


_CHANGES = """
SELECT change.id::text, CASE WHEN change.faults IS NULL THEN 'changed' ELSE 'faults' END, change.created_at, simulation.mission_id
FROM simulation_simulation simulation JOIN simulation_simulationchange change ON change.simulation_id = simulation.id
WHERE simulation.mission_id = ANY(%(missions)s)
"""
_SIMULATIONS = """
SELECT id::text, 'started', created_at, mission_id FROM simulation_simulation WHERE mission_id = ANY(%(missions)s)
UNION ALL
SELECT id::text, 'ended', ended_at, mission_id FROM simulation_simulation
WHERE mission_id = ANY(%(missions)s) AND ended_at IS NOT NULL
"""


def _read_changes(places: Sequence[EventPlace]) -> Mapping[EventPlace, MissionEvent]:
    rows = SimulationChange.objects.select_related("vehicle", "created_by").in_bulk([int(place.row) for place in places])
    return {place: _of_change(row) for place in places if (row := rows.get(int(place.row))) is not None}


def _of_change(change: SimulationChange) -> MissionEvent:
    who = change.created_by.display_name if change.created_by else None
    vehicle, by = change.vehicle, f" by {who}" if who else ""
    name, uav_id = ("All simulated UAVs", None) if vehicle is None else (vehicle.name, vehicle.uav_id)
    reported = {"speed": change.speed, "conditions": change.conditions, "faults": change.faults}
    values: dict[str, Any] = {field: value for field, value in reported.items() if value is not None}
    if change.faults is None:
        kind, words = EventKind.SIMULATION_CHANGED, f"{name}: {' and '.join(values)} changed{by}"
    else:
        faults = ", ".join(f"{fault} {value}" for fault, value in change.faults.items())
        kind, words = EventKind.FAULT_INJECTED, f"{name}: fault injected{by}: {faults}"
    return MissionEvent(kind, words, uav_id, "" if vehicle is None else vehicle.name, is_simulated=True, who=who, values=values)


def _read_simulations(places: Sequence[EventPlace]) -> Mapping[EventPlace, MissionEvent]:
    rows = Simulation.objects.select_related("created_by").in_bulk([UUID(place.row) for place in places])
    return {place: _of_simulation(row, place.step) for place in places if (row := rows.get(UUID(place.row))) is not None}


def _of_simulation(simulation: Simulation, step: str) -> MissionEvent:
    if step == "ended":
        words = "The simulation has ended" + (f": {simulation.reason}" if simulation.reason else "")
        values = {"reason": simulation.reason, "message": reason_words(simulation.reason)}
        return MissionEvent(EventKind.SIMULATION_ENDED, words, is_simulated=True, values=values)
    who = simulation.created_by.display_name if simulation.created_by else None
    words = "Simulated UAVs started" + (f" by {who}" if who else "")
    return MissionEvent(EventKind.SIMULATION_STARTED, words, is_simulated=True, who=who)


EVENT_SOURCES = (EventSource("simulated", _CHANGES, _read_changes), EventSource("simulation", _SIMULATIONS, _read_simulations))
