"""The simulator process: leases simulations, flies each at its speed, applies changes, and stores states."""

import errno
import logging
import threading
import time
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from uuid import UUID

from django.conf import settings
from django.db import close_old_connections, connection

from inspection.geodesy import LonLat
from inspection.selectors.planning import heights_at, planning_read
from missions.models import CredentialKind, Uav
from missions.services.fleet.credentials import mavlink_signing_key
from operation import loop_heartbeats
from operation.snapshots import Described, SnapshotCollector, Values
from simulation.flight.faults import WrongFaults, faults_from
from simulation.models import SimulatedVehicle, Simulation, SimulationChange
from simulation.rehearsing.ground import BlockedGround
from simulation.rehearsing.scenario_weather import weather_of
from simulation.rehearsing.weather_scenario import scenario_from_json
from simulation.services.fleet import camera_of_type
from simulation.services.simulator_leases import (
    end_single_ones,
    end_those_over,
    fail_simulation,
    notify,
    release_simulations,
    renew_simulations,
    take_changes,
    take_simulation,
)
from simulation.simulator.flight import RunningSimulation, flight_of
from simulation.simulator.options import SimulatorOptions
from simulation.vehicle_endpoint.fleet import InvalidSpeed, VehicleChange
from simulation.vehicle_endpoint.launch import Launch
from simulation.vehicle_protocol.mode_numbers import SimulatedAutopilot
from workspace.api.errors import DATABASE_UNAVAILABLE
from workspace.leases import held_until_s

logger = logging.getLogger(__name__)
INTERVAL_S = 0.5
REPORT_INTERVAL_S = 1.0
UNAVAILABLE_INTERVAL_S = 60.0  # between log lines
LOOP, HANGS_AFTER_S = "the simulator", 300.0  # a database that does not respond may block it for minutes


class NoGateway(Exception):
    """There is no gateway for a mission's UAV."""


def launch_of(vehicle: SimulatedVehicle, simulation: Simulation, options: SimulatorOptions) -> Launch:
    """Return the launch of a vehicle over the stored terrain; a stated ground height is the fallback. Raises NoGateway."""
    if vehicle.uav is not None and options.gateway is None:
        raise NoGateway
    position, scenario = LonLat(*vehicle.position.coords), scenario_from_json(vehicle.conditions)
    return Launch(
        system=vehicle.system_id,
        home=position,
        airframe=vehicle.airframe,
        battery_wh=vehicle.battery_wh,
        autopilot_type=SimulatedAutopilot(vehicle.autopilot_type),
        key=None if vehicle.uav is None else _key_of(vehicle.uav),
        seed=simulation.seed + vehicle.sequence,
        heading_deg=vehicle.heading_deg,
        battery_percent=scenario.battery_percent,
        ground=BlockedGround(heights_at(planning_read().dataset_version), vehicle.ground_amsl_m or 0.0),
        weather=weather_of(scenario),
        camera=camera_of_type(None if vehicle.uav is None else vehicle.uav.uav_type_id),
        talks_to=[] if vehicle.uav is None or options.gateway is None else [options.gateway],
        listens_at=None if vehicle.port is None else (options.host, vehicle.port),
    )


def _key_of(uav: Uav) -> bytes | None:
    credential = uav.credentials.filter(kind=CredentialKind.MAVLINK_KEY, revoked_at=None).first()
    return None if credential is None else mavlink_signing_key(credential=credential)


@dataclass
class Simulator:
    """The simulator: `run` until `stop`. Only this thread uses the database; a simulation's thread handles its UAVs and sockets."""

    options: SimulatorOptions
    flights: dict[UUID, RunningSimulation] = field(default_factory=dict)
    _stop: threading.Event = field(default_factory=threading.Event)
    _reported_s: float = 0.0
    _quiet_until_s: float = -UNAVAILABLE_INTERVAL_S

    def run(self) -> None:
        logger.info("simulator %s has begun", self.options.holder)
        while not self._stop.is_set():
            loop_heartbeats.send_heartbeat(LOOP, within_s=HANGS_AFTER_S)
            try:
                close_old_connections()
                self.round()
            except DATABASE_UNAVAILABLE as error:
                self._go_on_without_database(error)
            self._stop.wait(INTERVAL_S)
        loop_heartbeats.stop(LOOP)
        self._release()

    def stop(self) -> None:
        self._stop.set()

    def round(self) -> None:
        """Run one round. Raises database errors; the next round starts again."""
        if self.flights:
            self._hold()
        self._take()
        for change in take_changes(ids=list(self.flights)) if self.flights else ():
            self._pass_on(change)
        if time.monotonic() - self._reported_s >= REPORT_INTERVAL_S:
            self._reported_s = time.monotonic()
            for key, flight in self.flights.items():
                notify(simulation_id=key, holder=self.options.holder, step_timing=flight.step_timing(), vehicles=flight.reported())

    @property
    def load(self) -> float:
        return sum(flight.load for flight in self.flights.values())

    def _hold(self) -> None:
        self._let_go()
        options = self.options
        ended = end_those_over(holder=options.holder, ids=list(self.flights))
        asked_s = time.monotonic()
        still = renew_simulations(holder=options.holder, ids=self.flights.keys() - ended, lease_s=options.lease_s)
        for key in self.flights.keys() - still:
            self.flights.pop(key).end()
        for flight in self.flights.values():
            flight.held_until_s = held_until_s(asked_s, options.lease_s)
            if flight.has_fallen:
                fail_simulation(simulation=flight.simulation, reason="simulator-fault")
        for vehicle in end_single_ones(holder=options.holder, ids=list(self.flights)):
            self.flights[vehicle.simulation_id].drop(vehicle)

    def _let_go(self) -> None:
        for key in [key for key, flight in self.flights.items() if flight.is_given_up]:
            self.flights.pop(key).end()

    def _take(self) -> None:
        options = self.options
        while True:
            room, asked_s = options.most_load - self.load, time.monotonic()
            held = take_simulation(holder=options.holder, lease_s=options.lease_s, most_load=room, flown=list(self.flights))
            if held is None:
                return
            try:
                launches = [launch_of(vehicle, held.simulation, options) for vehicle in held.vehicles]
                until_s = held_until_s(asked_s, options.lease_s)
                self.flights[held.simulation.pk] = flight_of(held.simulation, held.vehicles, launches, held_until_s=until_s)
            except DATABASE_UNAVAILABLE:
                raise
            except NoGateway:
                logger.warning(
                    "simulation %s has no gateway to connect to: SPANWISE_SIMULATOR_GATEWAY says where one listens", held.simulation.pk
                )
                fail_simulation(simulation=held.simulation, reason="no-gateway")
            except OSError as error:
                is_taken = error.errno == errno.EADDRINUSE
                if is_taken:
                    logger.warning("%s: another program has a port of simulation %s", settings.SIMULATOR_PORTS, held.simulation.pk)
                else:
                    logger.exception("no socket for simulation %s", held.simulation.pk)
                fail_simulation(simulation=held.simulation, reason="port-taken" if is_taken else "no-socket")
            except Exception:
                logger.exception("simulation %s cannot be flown", held.simulation.pk)
                fail_simulation(simulation=held.simulation, reason="simulator-fault")
            else:
                logger.info("flies simulation %s, %s UAVs", held.simulation.pk, len(held.vehicles))

    def _pass_on(self, change: SimulationChange) -> None:
        flight = self.flights.get(change.simulation_id)
        if flight is None:
            return
        try:
            flight.post(
                VehicleChange(
                    system=None if change.vehicle is None else change.vehicle.system_id,
                    weather=None if change.conditions is None else weather_of(scenario_from_json(change.conditions)),
                    faults=None if change.faults is None else faults_from(change.faults),
                    speed=change.speed,
                )
            )
        except (WrongFaults, InvalidSpeed, KeyError, ValueError):
            logger.exception("a change of simulation %s cannot be made", change.simulation_id)

    def _go_on_without_database(self, error: Exception) -> None:
        """Continue until the leases expire: then another simulator may fly them, and a UAV must not be flown twice."""
        connection.close()
        if time.monotonic() >= self._quiet_until_s:
            self._quiet_until_s = time.monotonic() + UNAVAILABLE_INTERVAL_S
            logger.warning("the database is away, no simulation is taken or changed: %s", type(error).__name__)
        self._let_go()

    def _release(self) -> None:
        self._end_all()
        try:
            release_simulations(holder=self.options.holder)
        except DATABASE_UNAVAILABLE:
            logger.warning("the database is away: leases run out by themselves")

    def _end_all(self) -> None:
        for flight in self.flights.values():
            flight.fleet.end()
        while self.flights:
            self.flights.popitem()[1].end()


UAVS, SPEED, KEPT = "spanwise_simulation_uavs", "spanwise_simulation_speed", "spanwise_simulation_pace_kept"
STEPS, SLIPPED = "spanwise_simulation_steps", "spanwise_simulation_slipped_seconds"
DESCRIBED = (
    Described(UAVS, "Simulated UAVs in this simulator"),
    Described(SPEED, "Simulated seconds a second that are wanted, over all UAVs"),
    Described(KEPT, "The least share of its wanted speed that a simulation has reached since it was last asked; 1 is all of it"),
    Described(STEPS, "Steps of simulations, by whether they began on time", ["when"], is_counter=True),
    Described(SLIPPED, "Seconds by which simulations have fallen behind for good", is_counter=True),
)


def figures_of(simulator: Simulator) -> SnapshotCollector:
    """Return the collector, which is registered while its context is entered."""
    return SnapshotCollector(DESCRIBED, _Reading(simulator).read)


class _Reading:
    """Reads the metrics; keeps the progress of each simulation, and the totals of ended ones."""

    def __init__(self, simulator: Simulator) -> None:
        self._simulator = simulator
        self._seen: dict[UUID, tuple[float, float]] = {}  # simulated seconds, and when
        self._done: dict[UUID, Counter[str]] = {}
        self._before: Counter[str] = Counter()

    def read(self) -> Mapping[str, Values]:
        flights, now_s = dict(self._simulator.flights), time.monotonic()
        for gone in self._done.keys() - flights.keys():
            self._before.update(self._done.pop(gone))
            self._seen.pop(gone, None)
        shares = [share for key, flight in flights.items() if (share := self._share(key, flight, now_s)) is not None]
        reported = sum(self._done.values(), self._before.copy())
        return {
            UAVS: {(): sum(len(flight.vehicles) for flight in flights.values())},
            SPEED: {(): sum(flight.load for flight in flights.values())},
            KEPT: {(): min(shares, default=1.0)},
            STEPS: {("on-time",): reported["steps"] - reported["late"], ("late",): reported["late"]},
            SLIPPED: {(): reported["slipped_ms"] / 1_000},
        }

    def _share(self, key: UUID, flight: RunningSimulation, now_s: float) -> float | None:
        report = flight.fleet.report()
        self._done[key] = Counter(steps=report.steps, late=report.late_steps, slipped_ms=round(report.slipped_s * 1_000))
        before_s, at_s = self._seen.get(key, (report.simulated_s, now_s))
        self._seen[key] = (report.simulated_s, now_s)
        wanted_s = (now_s - at_s) * flight.speed
        return None if wanted_s <= 0 else max(0.0, min((report.simulated_s - before_s) / wanted_s, 1.0))
