"""How a simulator keeps its pace, as it is told outside: read off its own state when somebody asks."""

import time
from collections import Counter
from collections.abc import Mapping
from uuid import UUID

from operation.snapshots import Described, Snapshot, Values
from simulation.simulator.flight import Flight
from simulation.simulator.process import Simulator

UAVS, SPEED, KEPT = "spanwise_simulation_uavs", "spanwise_simulation_speed", "spanwise_simulation_pace_kept"
STEPS, SLIPPED = "spanwise_simulation_steps", "spanwise_simulation_slipped_seconds"
DESCRIBED = (
    Described(UAVS, "Simulated UAVs in this simulator"),
    Described(SPEED, "Simulated seconds a second that are wanted, over all UAVs"),
    Described(KEPT, "The least share of its wanted speed that a simulation has reached since it was last asked; 1 is all of it"),
    Described(STEPS, "Steps of simulations, by whether they began on time", ["when"], is_counter=True),
    Described(SLIPPED, "Seconds by which simulations have fallen behind for good", is_counter=True),
)


def figures_of(simulator: Simulator) -> Snapshot:
    """To be told for as long as it is entered."""
    return Snapshot(DESCRIBED, _Reading(simulator).read)


class _Reading:
    """Remembers how far each simulation was; what those that have ended had done stays counted."""

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
        told = sum(self._done.values(), self._before.copy())
        return {
            UAVS: {(): sum(len(flight.vehicles) for flight in flights.values())},
            SPEED: {(): sum(flight.load for flight in flights.values())},
            KEPT: {(): min(shares, default=1.0)},
            STEPS: {("on-time",): told["steps"] - told["late"], ("late",): told["late"]},
            SLIPPED: {(): told["slipped_ms"] / 1_000},
        }

    def _share(self, key: UUID, flight: Flight, now_s: float) -> float | None:
        report = flight.fleet.report()
        self._done[key] = Counter(steps=report.steps, late=report.late_steps, slipped_ms=round(report.slipped_s * 1_000))
        before_s, at_s = self._seen.get(key, (report.simulated_s, now_s))
        self._seen[key] = (report.simulated_s, now_s)
        wanted_s = (now_s - at_s) * flight.speed
        return None if wanted_s <= 0 else max(0.0, min((report.simulated_s - before_s) / wanted_s, 1.0))
