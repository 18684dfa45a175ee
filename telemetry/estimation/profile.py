"""Profile of a planned flight: the UAV's position at each second of the profile's clock.

The clock includes accelerations, turns, climbs, wind and tasks. `along_track_filter.py` tracks how the real flight deviates.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from inspection.geodesy import LonLat
from inspection.geodesy.local_frame import LocalFrame
from mavlink.approved_route import HOVER, Flight
from planning.energy.power import TOO_STRONG, ground_and_air_speed
from telemetry.estimation.knowledge import Knowledge

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

ACCELERATION_MPS2, BRAKING_MPS2 = 2.0, 1.5  # PX4's MPC_ACC_HOR is 3, ArduCopter's WPNAV_ACCEL 2.5; both are reached gradually
DESCENT_SHARE = 0.75  # of the climb speed: PX4 1.5 of 3 m/s, ArduCopter 1.5 of 2.5
LANDING_MPS = 0.7  # PX4's MPC_LAND_SPEED; ArduCopter's LAND_SPEED is 0.5
SLOW_BELOW_M = 8.0  # both land slowly below it
SETTLE_S = 1.5  # until it hovers at a task, and until it leaves
MIN_SPEED_MPS = 0.5
SLOWS_SHARE, MIN_CORNER_SHARE = 0.5, 0.1  # reduction of speed in a corner per radian, and its minimum
STEPS = 12  # of a leg
# Standard deviations of durations, beside the speed.
STRAIGHT_S, TURN_S = 0.15, 1.6  # at a passed waypoint; added in proportion to the sine of half the bend
STOP_S = 1.6
CLIMB_SHARE = 0.26  # of the time that a leg takes for its change of height


@dataclass(frozen=True, eq=False)
class FlightProfile:
    """Columns by knot, each with k entries; linear between two knots.

        moving_s      time in motion so far
        standing_s    time at tasks so far: the clock shows the sum of both
        variance_s2   variance of the clock so far, from turns, stops and climbs
        east_m, north_m, height_m (above take-off), along_m (of the route, horizontal)
        leg           node that it flies to or stands at: 0 is the first waypoint

    By node: sequence (-1 for the landing), target (-1 for none), and reached, the knot of its arrival.
    """

    frame: LocalFrame
    moving_s: FloatArray
    standing_s: FloatArray
    variance_s2: FloatArray
    east_m: FloatArray
    north_m: FloatArray
    height_m: FloatArray
    along_m: FloatArray
    leg: IntArray
    sequence: IntArray
    target: IntArray
    reached: IntArray
    ends_in_air: bool

    @cached_property
    def nominal_s(self) -> FloatArray:
        return self.moving_s + self.standing_s

    @property
    def length_m(self) -> float:
        return float(self.along_m[-1])


@dataclass(frozen=True, slots=True)
class _Node:
    east_m: float
    north_m: float
    height_m: float
    speed_mps: float  # over ground, on the leg that ends here
    hold_s: float | None  # None: it does not stop here
    sequence: int = -1
    target: int = -1
    lands: bool = False


def profile_of(knowledge: Knowledge) -> FlightProfile | None:
    """Return the profile from the take-off to the end of the flight; None without a flight."""
    flight = knowledge.flight
    if flight is None or not flight.waypoints:
        return None
    frame = LocalFrame.around(*flight.take_off.position)
    return _profile(_route_nodes(flight, frame, knowledge), frame, knowledge, ends_in_air=flight.end_action == HOVER)


def way_home(frame: LocalFrame, start_m: tuple[float, float, float], start_mps: float, home: LonLat, knowledge: Knowledge) -> FlightProfile:
    """Return the profile from a place (east, north, height) in a frame, at a speed towards `home`, straight at that height, then down."""
    east_m, north_m = frame.to_metres(np.array([home]))[0]
    height_m = max(start_m[2], SLOW_BELOW_M)
    nodes = [
        _Node(*start_m, 0.0, None),
        _Node(float(east_m), float(north_m), height_m, knowledge.cruise_speed_mps, 0.0),
    ]
    nodes += _landing(nodes[-1], 0.0)
    return _profile(nodes, frame, knowledge, ends_in_air=False, start_mps=start_mps)


def _route_nodes(flight: Flight, frame: LocalFrame, knowledge: Knowledge) -> list[_Node]:
    places = frame.to_metres(np.array([flight.take_off.position, *(waypoint.position for waypoint in flight.waypoints)]))
    nodes = [_Node(float(places[0, 0]), float(places[0, 1]), 0.0, 0.0, 0.0)]
    for waypoint, (east_m, north_m) in zip(flight.waypoints, places[1:], strict=True):
        before = nodes[-1]
        wished_mps = knowledge.cruise_speed_mps if waypoint.speed_mps is None else waypoint.speed_mps
        east, north = float(east_m) - before.east_m, float(north_m) - before.north_m
        speed_mps = _speed_in_wind(east, north, wished_mps, waypoint.altitude_agl_m, knowledge)
        hold_s = None if waypoint.task is None or waypoint.task.hold_s <= 0 else float(math.ceil(waypoint.task.hold_s))
        target = -1 if waypoint.target is None else waypoint.target
        nodes.append(_Node(float(east_m), float(north_m), waypoint.altitude_relative_m, speed_mps, hold_s, waypoint.sequence, target))
    last, end = nodes[-1], flight.waypoints[-1]
    if flight.end_action != HOVER:
        nodes += _landing(last, end.ground_relative_m)
    return nodes


def _landing(above: _Node, ground_m: float) -> list[_Node]:
    slow_m = min(ground_m + SLOW_BELOW_M, above.height_m)
    slowly = _Node(above.east_m, above.north_m, slow_m, MIN_SPEED_MPS, None)
    return [slowly, _Node(above.east_m, above.north_m, ground_m, MIN_SPEED_MPS, 0.0, lands=True)]


def _speed_in_wind(east_m: float, north_m: float, wished_mps: float, agl_m: float, knowledge: Knowledge) -> float:
    length_m = math.hypot(east_m, north_m)
    if length_m == 0.0:
        return wished_mps
    wind_east, wind_north = knowledge.conditions.wind_at(max(agl_m, 0.0))
    along = (wind_east * east_m + wind_north * north_m) / length_m
    across = (wind_north * east_m - wind_east * north_m) / length_m
    limit_mps = math.inf if knowledge.max_airspeed_mps is None else knowledge.max_airspeed_mps
    speed_mps = ground_and_air_speed(float(wished_mps), float(limit_mps), float(along), float(across))[0]
    return MIN_SPEED_MPS if speed_mps == TOO_STRONG else float(speed_mps)


def _profile(nodes: list[_Node], frame: LocalFrame, knowledge: Knowledge, *, ends_in_air: bool, start_mps: float = 0.0) -> FlightProfile:
    place = np.array([(node.east_m, node.north_m, node.height_m) for node in nodes])
    step = np.diff(place, axis=0)
    level_m, length_m = np.hypot(step[:, 0], step[:, 1]), np.linalg.norm(step, axis=1)
    up_mps, down_mps = knowledge.climb_speed_mps, DESCENT_SHARE * knowledge.climb_speed_mps
    level_s = level_m / np.array([max(node.speed_mps, MIN_SPEED_MPS) for node in nodes[1:]])
    vertical_s = np.where(step[:, 2] > 0, step[:, 2] / up_mps, -step[:, 2] / down_mps)
    vertical_s = np.where([node.lands for node in nodes[1:]], np.abs(step[:, 2]) / LANDING_MPS, vertical_s)
    wanted_s = np.maximum(np.maximum(level_s, vertical_s), 1e-6)
    wanted_mps = np.maximum(length_m / wanted_s, 1e-3)
    bend = _bends(step, length_m)
    corner_mps = _corner_speeds(nodes, bend, length_m, wanted_mps, start_mps)
    moving, standing, uncertainty, along, leg, points = [0.0], [0.0], [0.0], [0.0], [0], [place[0]]
    reached = []
    share = 0.5 * (1.0 - np.cos(np.linspace(0.0, math.pi, STEPS + 1)))
    for number, node in enumerate(nodes[1:]):
        if length_m[number] > 0.01:
            way_m = share * length_m[number]
            speed = np.minimum(
                wanted_mps[number],
                np.sqrt(np.minimum(corner_mps[number] ** 2 + 2 * ACCELERATION_MPS2 * way_m,
                                   corner_mps[number + 1] ** 2 + 2 * BRAKING_MPS2 * (length_m[number] - way_m))),
            )  # fmt: skip
            taken_s = np.diff(way_m) / np.maximum(0.5 * (speed[1:] + speed[:-1]), 1e-3)
            climbing_s2 = (CLIMB_SHARE * vertical_s[number]) ** 2 if vertical_s[number] > level_s[number] else 0.0
            total_s = float(taken_s.sum())
            for part in range(STEPS):
                moving.append(moving[-1] + float(taken_s[part]))
                standing.append(standing[-1])
                uncertainty.append(uncertainty[-1] + climbing_s2 * float(taken_s[part]) / total_s)
                along.append(along[-1] + float(share[part + 1] - share[part]) * float(level_m[number]))
                points.append(place[number] + share[part + 1] * step[number])
                leg.append(number)
        reached.append(len(moving) - 1)
        is_last = number == len(nodes) - 2
        stops = node.hold_s is not None
        uncertainty[-1] += 0.0 if stops or is_last else (STRAIGHT_S + TURN_S * math.sin(0.5 * bend[number + 1])) ** 2
        if stops and not is_last:
            moving.append(moving[-1])
            standing.append(standing[-1] + SETTLE_S + (node.hold_s or 0.0))
            uncertainty.append(uncertainty[-1] + STOP_S**2)
            along.append(along[-1])
            points.append(place[number + 1])
            leg.append(number)
    columns = np.array(points)
    return FlightProfile(
        frame=frame,
        moving_s=np.array(moving),
        standing_s=np.array(standing),
        variance_s2=np.array(uncertainty),
        east_m=columns[:, 0].copy(),
        north_m=columns[:, 1].copy(),
        height_m=columns[:, 2].copy(),
        along_m=np.array(along),
        leg=np.array(leg, dtype=np.int64),
        sequence=np.array([node.sequence for node in nodes[1:]], dtype=np.int64),
        target=np.array([node.target for node in nodes[1:]], dtype=np.int64),
        reached=np.array(reached, dtype=np.int64),
        ends_in_air=ends_in_air,
    )


def _bends(step: FloatArray, length_m: FloatArray) -> FloatArray:
    """Return the change of direction at each node [rad], 0 at both ends and at legs without length."""
    bend = np.zeros(len(step) + 1)
    for number in range(1, len(step)):
        lengths_m2 = float(length_m[number - 1] * length_m[number])
        if lengths_m2 > 1e-4:
            bend[number] = math.acos(min(max(float(step[number - 1] @ step[number]) / lengths_m2, -1.0), 1.0))
    return bend


def _corner_speeds(nodes: list[_Node], bend: FloatArray, length_m: FloatArray, wanted_mps: FloatArray, start_mps: float) -> FloatArray:
    """Return the speed at each node: 0 at stops, lower the sharper the turn, and within what both legs' accelerations allow."""
    speed = np.zeros(len(nodes))
    speed[0] = start_mps
    for number in range(1, len(nodes) - 1):
        if nodes[number].hold_s is None and min(length_m[number - 1], length_m[number]) > 0.01:
            share = max(1.0 - SLOWS_SHARE * bend[number], MIN_CORNER_SHARE)
            speed[number] = min(wanted_mps[number - 1], wanted_mps[number]) * share
    for number in range(1, len(nodes)):
        speed[number] = min(speed[number], math.sqrt(speed[number - 1] ** 2 + 2 * ACCELERATION_MPS2 * length_m[number - 1]))
    for number in range(len(nodes) - 2, 0, -1):
        speed[number] = min(speed[number], math.sqrt(speed[number + 1] ** 2 + 2 * BRAKING_MPS2 * length_m[number]))
    return speed
