"""Simulated UAVs in real time, for tests: started, and a simulator in this process."""

from datetime import timedelta
from typing import Any

from django.utils import timezone

from inspection.geodesy import LonLat
from missions.models import Mission
from missions.selectors.missions import mission_of_organisation
from planning.energy.conditions import Conditions
from simulation.models import Simulation
from simulation.rehearsing.weather_scenario import Named, WeatherScenario, named_scenario
from simulation.services.simulated_flights import start_simulated_flights
from simulation.services.simulations import PoolUav, start_pool
from simulation.services.simulator_leases import LeasedSimulation, take_simulation
from workspace.models import User

HERE = LonLat(10.0, 56.0)
CALM: WeatherScenario = named_scenario(Named.CALM, Conditions())
LONG_AGO = timezone.now() - timedelta(hours=1)


def pool(actor: User, count: int = 2, **more: Any) -> Simulation:
    values = {"lifetime_s": 600.0, "scenario": CALM, "airframe": "iris"} | more
    return start_pool(organisation=actor.organisation, actor=actor, uavs=[PoolUav(HERE) for _ in range(count)], **values)


def stand_ins(mission: Mission, actor: User, **more: Any) -> Simulation:
    return start_simulated_flights(mission=mission_of_organisation(mission.organisation, mission.pk), actor=actor, scenario=CALM, **more)


def taken(holder: str = "one/a", *flown: Simulation, most_load: float = 60.0) -> LeasedSimulation | None:
    return take_simulation(holder=holder, lease_s=5.0, most_load=most_load, flown=[simulation.pk for simulation in flown])


def lose(simulation: Simulation, **reported: bool) -> None:
    """Its simulator is dead: the lease runs out."""
    Simulation.objects.filter(pk=simulation.pk).update(lease_expires_at=LONG_AGO)
    simulation.vehicles.update(reported=reported)


def fresh(simulation: Simulation) -> Simulation:
    return Simulation.objects.get(pk=simulation.pk)
