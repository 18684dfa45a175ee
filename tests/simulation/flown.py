"""Flights by hand for tests of the assessment: straight lines through given places at given moments.

Route: north along 10° E from 56.000° N, 60 m up, three waypoints 1 km apart.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import shapely

from inspection.geodesy import LonLat
from inspection.geodesy.local_frame import LocalFrame
from inspection.zones.reach import HeightLimits as ZoneLimits
from inspection.zones.reach import ZoneTable, agl_band
from inspection.zones.schedule import Schedule, ZoneRules
from mavlink.approved_route import LAND, FrozenRoute, FrozenWaypoint, TakeOff
from planning.task import Task, TaskKind
from planning.trajectory.waypoints import WaypointKind
from simulation.assessment.flown import AssessedRoute, FlownFlight, FlownTrack, TrackEnding
from simulation.assessment.judging import AssessmentSurroundings
from simulation.assessment.limits import AssessmentLimits
from simulation.assessment.obstacles import Standing

HERE = LonLat(10.0, 56.0)
FRAME = LocalFrame.around(*HERE)
UP_M, GROUND_M = 60.0, 100.0
LIMITS = AssessmentLimits()
LEG_M, SPEED_MPS = 1_000.0, 10.0

Row = tuple[float, float, float, float, float]  # seconds, east, north, height above take-off [m], battery [%]


def place(east_m: float, north_m: float) -> LonLat:
    return LonLat(*FRAME.to_degrees(np.array([[east_m, north_m]]))[0].tolist())


def a_route(*, hold_s: float = 0.0, east_m: float = 0.0) -> FrozenRoute:
    """The second waypoint is target 4, at which it stays."""
    waypoints = tuple(
        FrozenWaypoint(
            sequence=number,
            position=place(east_m, LEG_M * number),
            kind=WaypointKind.TARGET if number == 1 else WaypointKind.PASS,
            altitude_agl_m=UP_M,
            altitude_relative_m=UP_M,
            altitude_amsl_m=GROUND_M + UP_M,
            task=Task(TaskKind.HOLD, hold_s) if number == 1 else None,
            target=4 if number == 1 else None,
            arrival_s=30.0 + LEG_M * number / SPEED_MPS,
        )
        for number in range(3)
    )
    return FrozenRoute("Tern", TakeOff(place(east_m, 0.0), GROUND_M), SPEED_MPS, LAND, waypoints)


def rows(*, off_m: float = 0.0, high_m: float = 0.0, left_percent: float = 50.0, late_s: float = 0.0, east_m: float = 0.0) -> list[Row]:
    """Up, along the line half way off it to the east and too high, and down: with nothing said as it was planned."""
    corners = [
        (0.0, 0.0, 0.0, 0.0),
        (30.0, 0.0, 0.0, UP_M),
        (80.0 + late_s, off_m, 500.0, UP_M + high_m),
        (130.0 + late_s, 0.0, 1_000.0, UP_M),
        (230.0 + late_s, 0.0, 2_000.0, UP_M),
        (270.0 + late_s, 0.0, 2_000.0, 0.0),
    ]
    end_s = corners[-1][0]
    moments = np.arange(0.0, end_s + 0.1, 0.2)
    columns = [np.interp(moments, [corner[0] for corner in corners], [corner[axis] for corner in corners]) for axis in (1, 2, 3)]
    battery = 100.0 - (100.0 - left_percent) * moments / end_s
    return list(
        zip(moments.tolist(), (columns[0] + east_m).tolist(), columns[1].tolist(), columns[2].tolist(), battery.tolist(), strict=True)
    )


def a_track(flown: Sequence[Row], *, ending: TrackEnding = TrackEnding.LANDED, late_s: float = 0.0) -> FlownTrack:
    table = np.array(flown)
    t_s = table[:, 0]
    return FlownTrack(
        t_s=t_s,
        position=FRAME.to_degrees(table[:, 1:3]),
        amsl_m=GROUND_M + table[:, 3],
        relative_m=table[:, 3],
        battery_percent=table[:, 4],
        used_wh=(100.0 - table[:, 4]) * 0.5,
        waypoint=np.where(t_s <= 30.0, 0, np.where(t_s <= 130.0 + late_s, 1, 2)),
        is_in_air=table[:, 3] > 0.1,
        is_coming_down=t_s > 230.0 + late_s,
        attitude_deg=np.column_stack([np.zeros(len(t_s)), np.full(len(t_s), -4.0), np.full(len(t_s), 0.04)]),
        ending=ending,
    )


def flown(track: FlownTrack | None = None, *, uav: int = 0, name: str = "Tern", hold_s: float = 0.0, east_m: float = 0.0) -> AssessedRoute:
    route = a_route(hold_s=hold_s, east_m=east_m)
    track = a_track(rows(east_m=east_m)) if track is None else track
    return AssessedRoute(uav, name, route, (FlownFlight(route.flights[0], track),), 20.0, 40.0, 270.0)


def zones(
    *boxes: tuple[float, float, float, float], lower_m: float | None = None, upper_m: float | None = None, schedule: Schedule | None = None
) -> ZoneTable:
    """Boxes west, south, east, north [m] from HERE; limits above ground."""
    limits = ZoneLimits(lower_m, "AGL" if lower_m is not None else "", upper_m, "AGL" if upper_m is not None else "")
    drawn = [shapely.MultiPolygon([shapely.Polygon([place(w, s), place(e, s), place(e, n), place(w, n)])]) for w, s, e, n in boxes]
    bands = [agl_band(limits) for _ in boxes]
    return ZoneTable(
        ids=np.arange(1, len(boxes) + 1, dtype=np.int64),
        names=tuple(f"Zone {number}" for number in range(1, len(boxes) + 1)),
        wkb=tuple(shapely.to_wkb(polygon) for polygon in drawn),
        box=np.array([polygon.bounds for polygon in drawn]).reshape(-1, 4),
        floor_agl_m=np.array([band[0] for band in bands]),
        ceiling_agl_m=np.array([band[1] for band in bands]),
        limits=(limits,) * len(boxes),
        schedules=(schedule,) * len(boxes),
        rules=ZoneRules(),
    )


def standing(*spans: tuple[tuple[float, float], tuple[float, float], float]) -> Standing:
    """(from, to, top above ground) in metres from HERE."""
    start, end = (FRAME.to_degrees(np.array([span[side] for span in spans]).reshape(-1, 2)) for side in (0, 1))
    tops = GROUND_M + np.array([span[2] for span in spans])
    return Standing(start, end, tops, tops)


def around(**more: Any) -> AssessmentSurroundings:
    nothing = AssessmentSurroundings(zones(), standing(), lambda positions: np.full(len(positions), GROUND_M), None)
    return replace(nothing, **more)
