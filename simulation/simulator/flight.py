"""One running simulation: its fleet in a separate thread, at its own speed."""

import logging
import threading
import time
from dataclasses import dataclass, field
from typing import Any
from uuid import UUID

from simulation.models import SimulatedVehicle, Simulation
from simulation.vehicle_endpoint.fleet import SimulatedFleet, VehicleChange
from simulation.vehicle_endpoint.flying_uav import FlyingUav
from simulation.vehicle_endpoint.launch import Launch, fleet_of

logger = logging.getLogger(__name__)

ENDS_WITHIN_S = 5.0


@dataclass
class RunningSimulation:
    """A running simulation. `vehicles` and the fleet's UAVs have the same order.

    It makes no step after `held_until_s` (monotonic), whatever delays the thread that renews the lease: another simulator may fly the same
    UAVs by then.
    """

    simulation: Simulation
    vehicles: tuple[SimulatedVehicle, ...]
    fleet: SimulatedFleet
    speed: float
    held_until_s: float
    _thread: threading.Thread = field(init=False, repr=False)
    _dropped: set[UUID] = field(default_factory=set)
    has_fallen: bool = False
    is_given_up: bool = False

    def __post_init__(self) -> None:
        self._thread = threading.Thread(target=self._run, name=f"simulation {self.simulation.pk}", daemon=True)
        self._thread.start()

    def post(self, change: VehicleChange) -> None:
        """Apply a change at the next step."""
        self.speed = change.speed or self.speed
        self.fleet.post(change)

    def drop(self, vehicle: SimulatedVehicle) -> None:
        """Remove a vehicle at the next step; the others fly on."""
        self._dropped.add(vehicle.pk)
        self.fleet.post(VehicleChange(system=vehicle.system_id, ends=True))

    def end(self) -> None:
        self.fleet.end()
        self._thread.join(ENDS_WITHIN_S)
        self.fleet.close()

    @property
    def load(self) -> float:
        """Return the simulated seconds per second, over all UAVs."""
        return (len(self.vehicles) - len(self._dropped)) * self.speed

    def step_timing(self) -> dict[str, Any]:
        report = self.fleet.report()
        return {
            "simulated_s": report.simulated_s, "steps": report.steps, "late_steps": report.late_steps, "latest_s": report.latest_s,
            "slipped_s": report.slipped_s,
        }  # fmt: skip

    def reported(self) -> dict[UUID, dict[str, Any]]:
        """Return the state of each flying vehicle. Safe during a step: each state is an immutable value."""
        both = zip(self.vehicles, self.fleet.uavs, strict=True)
        return {vehicle.pk: _reported(flying) for vehicle, flying in both if vehicle.pk not in self._dropped}

    def _is_no_longer_held(self) -> bool:
        if time.monotonic() > self.held_until_s:
            self.is_given_up = True
            logger.warning("the lease of simulation %s is out: it is given up", self.simulation.pk)
        return self.is_given_up

    def _run(self) -> None:
        try:
            self.fleet.run(until=self._is_no_longer_held)
        except Exception:
            self.has_fallen = True
            logger.exception("simulation %s fell", self.simulation.pk)


def flight_of(
    simulation: Simulation, vehicles: tuple[SimulatedVehicle, ...], launches: list[Launch], *, held_until_s: float
) -> RunningSimulation:
    """Start the simulation. Raises OSError if a socket cannot be opened."""
    return RunningSimulation(simulation, vehicles, fleet_of(launches, speed=simulation.speed), simulation.speed, held_until_s)


def _reported(flying: FlyingUav) -> dict[str, Any]:
    state = flying.uav.state
    return {
        "at_s": round(state.at_s, 2),
        "position": [round(state.true_position.lon, 7), round(state.true_position.lat, 7)],
        "altitude_relative_m": round(state.altitude_relative_m, 2),
        "battery_percent": round(state.battery_percent, 1),
        "mode": str(state.mode),
        "is_armed": state.is_armed,
        "is_in_air": state.is_in_air,
        "is_crashed": state.is_crashed,
        "is_link_lost": flying.uav.faults.is_link_lost(flying.uav.now_s),
        "heard": flying.received_count,
        "refused": flying.refused,
    }
