"""A fleet of simulated UAVs in one process at one speed, with changes in flight also as lines of JSON.

A step for all, then receiving until the next.
"""

import json
import logging
import math
import selectors
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from queue import Empty, SimpleQueue
from typing import Any

from planning.energy.conditions import Conditions, InvalidConditions, WindLayer
from simulation.flight.faults import Faults, ImpossibleWeather, Weather, WrongFaults, faults_from
from simulation.vehicle_endpoint.flying_uav import FlyingUav

RESYNC_AFTER_S = 1.0  # of real time: a larger lag is not caught up
logger = logging.getLogger(__name__)
UNACKNOWLEDGED_SPEED = 1.0  # while a station that sends heartbeats falls silent: reports that it is too busy to receive are lost
STEP_S = 0.04  # of simulated time, as in SimulatedUav
MIN_SPEED, MAX_SPEED = 0.1, 60.0


@dataclass
class StepTimer:
    """Paces `speed` simulated seconds per second. Times are monotonic seconds of real time.

    A step is late if it begins more than one step after it was due. A lag above RESYNC_AFTER_S is not caught up and is added to
    `slipped_s`. `limit` is a speed that applies while it is lower than the requested one.
    """

    step_s: float
    speed: float
    next_s: float
    steps: int = 0
    late_steps: int = 0
    latest_s: float = 0.0
    slipped_s: float = 0.0
    limit: float = math.inf

    @property
    def interval_s(self) -> float:
        """Return the interval of steps in real time."""
        return self.step_s / min(self.speed, self.limit)

    def begin(self, now_s: float) -> bool:
        """Return whether a step is due, and count it."""
        behind_s = now_s - self.next_s
        if behind_s < 0:
            return False
        self.steps += 1
        self.late_steps += behind_s > self.interval_s
        self.latest_s = max(self.latest_s, behind_s)
        self.next_s += self.interval_s
        if behind_s > RESYNC_AFTER_S:
            self.slipped_s += behind_s
            self.next_s = now_s + self.interval_s
        return True

    def change(self, speed: float, now_s: float) -> None:
        """Change the speed from now on."""
        self.speed = speed
        self.next_s = now_s + self.interval_s


class InvalidSpeed(ValueError):
    """The speed is out of range."""


@dataclass(frozen=True)
class VehicleChange:
    """Changes from now on; None: unchanged. `system` None: all UAVs. `faults` maps a UAV's present faults to new ones."""

    system: int | None = None
    weather: Weather | None = None
    faults: Callable[[Faults, float], Faults] | None = None  # of previous faults and simulated seconds
    speed: float | None = None
    ends: bool = False  # the UAV and its socket are removed


@dataclass(frozen=True)
class FleetReport:
    """How the speed was kept: `latest_s` is the largest delay of a step, `slipped_s` the lag not caught up, in real time.

    `failed` UAVs have left the fleet by a program error.
    """

    uavs: int
    simulated_s: float
    wall_s: float
    steps: int
    late_steps: int
    latest_s: float
    slipped_s: float
    sent: int
    received_count: int
    failed: int


@dataclass
class SimulatedFleet:
    """The fleet. `speed` is simulated seconds per second. `post` may be called from any thread, all else from the running one."""

    uavs: Sequence[FlyingUav]
    speed: float = 1.0
    _failed: set[int] = field(default_factory=set)
    _gone: set[int] = field(default_factory=set)
    _changes: SimpleQueue[VehicleChange] = field(default_factory=SimpleQueue)
    _is_ended: bool = False

    def __post_init__(self) -> None:
        _check_speed(self.speed)
        self._began_s = time.monotonic()
        self._step_timer = StepTimer(STEP_S, self.speed, self._began_s)

    def post(self, change: VehicleChange) -> None:
        """Apply a change at the next step. Raises InvalidSpeed."""
        if change.speed is not None:
            _check_speed(change.speed)
        self._changes.put(change)

    def end(self) -> None:
        """End soon; callable from any thread and from signal handlers."""
        self._is_ended = True

    def run(self, until: Callable[[], bool] = lambda: False) -> FleetReport:
        """Run until ended or until `until` returns True, which is checked before each step."""
        self._began_s = time.monotonic()
        self._step_timer = StepTimer(STEP_S, self._step_timer.speed, self._began_s)
        with selectors.DefaultSelector() as selector:
            for uav in self._flying():
                selector.register(uav.radio.socket, selectors.EVENT_READ, uav)
            while not self._is_ended:
                now_s = time.monotonic()
                self._step_timer.limit = (
                    UNACKNOWLEDGED_SPEED if any(uav.radio.is_station_silent(now_s) for uav in self._flying()) else math.inf
                )
                if self._step_timer.begin(now_s):
                    if until():
                        break
                    self._make_changes(selector)
                    for uav in self._flying():
                        self._guarded(uav, uav.step)
                for key, _ in selector.select(max(self._step_timer.next_s - time.monotonic(), 0.0)):
                    if not self._guarded(key.data, key.data.receive_frames):
                        selector.unregister(key.fileobj)
        return self.report()

    def close(self) -> None:
        for uav in self.uavs:
            uav.radio.close()

    def report(self) -> FleetReport:
        step_timer = self._step_timer
        return FleetReport(
            uavs=len(self.uavs),
            simulated_s=round(step_timer.steps * STEP_S, 3),
            wall_s=round(time.monotonic() - self._began_s, 3),
            steps=step_timer.steps,
            late_steps=step_timer.late_steps,
            latest_s=round(step_timer.latest_s, 4),
            slipped_s=round(step_timer.slipped_s, 3),
            sent=sum(uav.sent for uav in self.uavs),
            received_count=sum(uav.received_count for uav in self.uavs),
            failed=len(self._failed),
        )

    def _flying(self) -> list[FlyingUav]:
        return [uav for uav in self.uavs if self._flies(uav)]

    def _flies(self, uav: FlyingUav) -> bool:
        return uav.system not in self._failed and uav.system not in self._gone

    def _guarded(self, uav: FlyingUav, work: Callable[[], None]) -> bool:
        """Run the work of a UAV; a program error removes this UAV only."""
        if self._flies(uav):
            try:
                work()
            except Exception:
                logger.exception("simulated UAV %s has fallen out of its batch", uav.system)
                self._failed.add(uav.system)
        return self._flies(uav)

    def _make_changes(self, selector: selectors.BaseSelector) -> None:
        while True:
            try:
                change = self._changes.get_nowait()
            except Empty:
                return
            if change.speed is not None:
                self._step_timer.change(change.speed, time.monotonic())
            for uav in self._flying():
                if change.system in (None, uav.system):
                    faults = None if change.faults is None else change.faults(uav.uav.faults, uav.uav.now_s)
                    uav.change(weather=change.weather, faults=faults)
                    if change.ends:
                        self._gone.add(uav.system)
                        selector.unregister(uav.radio.socket)
                        uav.radio.close()


def _check_speed(speed: float) -> None:
    if not MIN_SPEED <= speed <= MAX_SPEED:
        raise InvalidSpeed(f"The speed must be from {MIN_SPEED:g} to {MAX_SPEED:g} times real time, not {speed:g}.")


WIND_MEASURED_AGL_M = 10.0  # a single layer applies at all heights
ORDER = frozenset({"system", "weather", "faults", "speed"})
WEATHER = frozenset({"wind", "gusts_mps", "turbulence_mps", "temperature_c"})


class WrongOrder(ValueError):
    """The line is invalid."""


def change_of(line: str) -> VehicleChange:
    """Parse `{"system": 3, "weather": {"wind": [8, 270], "gusts_mps": 2}, "faults": {"link_lost_for_s": 20}, "speed": 5}`, or parts of it.

    Without a system it applies to all UAVs. Omitted weather is calm; omitted faults stay unchanged. Faults with a duration count from now
    on in simulated seconds. Raises WrongOrder.
    """
    try:
        order = json.loads(line)
    except ValueError as error:
        raise WrongOrder(f"not JSON: {error}") from error
    _known(order, ORDER)
    system, speed = order.get("system"), order.get("speed")
    if system is not None and not isinstance(system, int):
        raise WrongOrder("system is a number from 1 to 255")
    return VehicleChange(
        system=system,
        weather=weather_of(order["weather"]) if "weather" in order else None,
        faults=faults_of(order["faults"]) if "faults" in order else None,
        speed=None if speed is None else _number(speed, "speed"),
    )


def weather_of(reported: Any) -> Weather:
    """Return the weather. Raises WrongOrder."""
    _known(reported, WEATHER)
    wind = reported.get("wind", [0.0, 0.0])
    if not (isinstance(wind, list) and len(wind) == 2):
        raise WrongOrder("wind is [speed in m/s, degrees that it blows from]")
    speed_mps, from_deg = (_number(value, "wind") for value in wind)
    try:
        layer = WindLayer(WIND_MEASURED_AGL_M, speed_mps, from_deg % 360.0)
        conditions = Conditions((layer,), _number(reported.get("temperature_c", 15.0), "temperature_c"))
        gusts_mps, turbulence_mps = (_number(reported.get(name, 0.0), name) for name in ("gusts_mps", "turbulence_mps"))
        return Weather(conditions, gusts_mps=gusts_mps, turbulence_mps_at_20ft=turbulence_mps)
    except (InvalidConditions, ImpossibleWeather) as error:
        raise WrongOrder(str(error)) from error


def faults_of(reported: Any) -> Callable[[Faults, float], Faults]:
    """Return a function from previous faults and simulated seconds to the new faults. Raises WrongOrder."""
    try:
        return faults_from(reported)
    except WrongFaults as error:
        raise WrongOrder(str(error)) from error


def _known(reported: Any, names: frozenset[str]) -> None:
    if not isinstance(reported, dict) or not reported.keys() <= names:
        raise WrongOrder(f"only {', '.join(sorted(names))} can be told")


def _number(value: Any, name: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise WrongOrder(f"{name} is a number")
    return float(value)
