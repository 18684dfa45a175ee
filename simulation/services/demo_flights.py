"""Flies a demo mission with simulated UAVs, one step per call. No call waits, so no worker is blocked during the flight."""

from datetime import datetime, timedelta

from django.db import transaction
from django.db.models import QuerySet
from django.utils import timezone

from missions.models import CommandKind, CommandState, Mission, MissionState, UavCommand
from missions.selectors.missions import mission_of_organisation
from missions.services.approval.approval import approve_mission
from missions.services.commands.dispatch import dispatch_mission
from missions.services.commands.flight_progress import ON_ITS_WAY
from missions.services.commands.refused import refuse
from missions.services.commands.steering import command_uav
from operation.reasons import Reason
from planning.energy.conditions import Conditions
from simulation.models import Simulation, SimulationState
from simulation.rehearsing.weather_scenario import Named, named_scenario
from simulation.services.simulated_flights import start_simulated_flights
from simulation.vehicle_models import PRESENT
from workspace.models import User

STEP_TIMEOUT = timedelta(minutes=5)  # for a UAV to be ready, loaded and started
FLIGHT_TIMEOUT = timedelta(minutes=30)  # of a flight faster than real time


def fly_demo_mission(*, mission: Mission, actor: User, speed: float, since: datetime) -> Reason | None:
    """Take the next step: approve the mission with simulated UAVs, upload, start, and await the end of a fast flight.

    Returns what it waits for; None if nothing is left to do, or if users have approved it or ended its simulation themselves. since: older
    simulations are not this job's. Raises Refused; TimeoutError with what it waited for.
    """
    simulation = Simulation.objects.filter(mission=mission, created_at__gte=since).order_by("created_at").first()
    if simulation is None:
        return _begin(mission, actor, speed) if mission.state == MissionState.PLANNED else None
    if simulation.state == SimulationState.FAILED:
        raise refuse("simulation_failed", Reason("demo_simulation_failed"))
    if simulation.state not in PRESENT or mission.state not in (MissionState.APPROVED, *ON_ITS_WAY):
        return None
    if simulation.vehicles.exclude(state=SimulationState.FLYING).exists():
        return _within(STEP_TIMEOUT, simulation.created_at, Reason("demo_starting_uavs", {"mission": mission.name}))
    if mission.state == MissionState.APPROVED:
        dispatch_mission(mission=mission, actor=actor)
    return _carried_out(mission, actor, simulation.created_at) or _flown(mission, speed)


def _begin(mission: Mission, actor: User, speed: float) -> Reason:
    with transaction.atomic():
        approve_mission(mission=mission, actor=actor)
        loaded = mission_of_organisation(mission.organisation, mission.pk)
        start_simulated_flights(mission=loaded, actor=actor, scenario=named_scenario(Named.CALM, Conditions()), speed=speed)
    return Reason("demo_starting_uavs", {"mission": mission.name})


def _carried_out(mission: Mission, actor: User, since: datetime) -> Reason | None:
    """Return what it waits for until each UAV is loaded and started; None afterwards."""
    commands = UavCommand.objects.filter(mission=mission, created_at__gte=since).select_related("uav")
    loads = commands.filter(kind=CommandKind.UPLOAD_MISSION)
    if not _are_applied(loads):
        return _within(STEP_TIMEOUT, loads.latest("created_at").created_at, Reason("demo_loading", {"mission": mission.name}))
    starts = commands.filter(kind=CommandKind.START)
    for load in loads.exclude(uav__in=starts.values("uav")):
        command_uav(uav=load.uav, kind=CommandKind.START, actor=actor)
    if not _are_applied(starts.all()):
        return _within(STEP_TIMEOUT, starts.latest("created_at").created_at, Reason("demo_starting", {"mission": mission.name}))
    return None


def _flown(mission: Mission, speed: float) -> Reason | None:
    """Return what it waits for until a fast flight ends; None for one in real time, which continues by itself."""
    if speed <= 1.0:
        return None
    started_at = UavCommand.objects.filter(mission=mission, kind=CommandKind.START).latest("created_at").created_at
    return _within(FLIGHT_TIMEOUT, started_at, Reason("demo_flying", {"mission": mission.name}))


def _are_applied(commands: QuerySet[UavCommand]) -> bool:
    """Return whether all commands are applied. Raises Refused if one has failed or expired."""
    for command in commands:
        if command.state in (CommandState.FAILED, CommandState.EXPIRED):
            raise refuse("command_failed", Reason("command_not_taken", {"uav": command.uav.name}))
    return all(command.state == CommandState.APPLIED for command in commands)


def _within(limit: timedelta, begun_at: datetime, message: Reason) -> Reason:
    """Return the message. Raises TimeoutError with it after the limit."""
    if timezone.now() - begun_at > limit:
        raise TimeoutError(str(message))
    return message
