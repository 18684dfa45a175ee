"""Reads of simulated UAVs in real time, always within one organisation."""

from uuid import UUID

from django.db.models import QuerySet

from simulation.models import SimulatedVehicle, Simulation
from workspace.models import Organisation


def simulations_of_organisation(organisation: Organisation) -> QuerySet[Simulation]:
    found = Simulation.objects.filter(organisation=organisation).select_related("created_by", "mission")
    return found.prefetch_related("vehicles__uav")


def simulations_of_mission(organisation: Organisation, mission_id: UUID) -> QuerySet[Simulation]:
    return simulations_of_organisation(organisation).filter(mission=mission_id)


def vehicles_of_organisation(organisation: Organisation) -> QuerySet[SimulatedVehicle]:
    return SimulatedVehicle.objects.filter(simulation__organisation=organisation).select_related("simulation__organisation", "uav")
