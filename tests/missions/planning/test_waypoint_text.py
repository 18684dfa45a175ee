"""Waypoints written from columns, against one dictionary a waypoint."""

import numpy as np
import orjson
from hypothesis import given
from hypothesis import strategies as st

from inspection.geodesy import LonLat
from planning.plan_json import line_text, waypoints_text, waypoints_to_json
from planning.task import Task, TaskKind
from planning.trajectory.waypoints import RoutePoint, RoutePoints, WaypointKind, Waypoints

HEIGHTS = (st.floats(-500, 9_000) | st.sampled_from([60.0, 2.675, 1e-7, 119.995])).map(lambda height_m: height_m + 0.0)  # no -0.0
POINTS = st.builds(
    RoutePoint,
    position=st.builds(LonLat, st.floats(-180, 180), st.floats(-90, 90)),
    kind=st.sampled_from(WaypointKind),
    agl_m=HEIGHTS,
    asset=st.none() | st.integers(1, 2**62),
    target=st.none() | st.integers(0, 2_000),
    task=st.none() | st.builds(Task, st.sampled_from(TaskKind), st.floats(0, 3_600)),
)


def plain(waypoints: Waypoints) -> list[dict[str, object]]:
    """One waypoint after the other, without columns."""
    return [
        {
            "position": list(point.position),
            "kind": point.kind.value,
            "asset": point.asset,
            "target": point.target,
            "task": None if point.task is None else {"kind": point.task.kind.value, "hold_s": point.task.hold_s},
            "altitude_agl_m": round(point.agl_m, 2),
            "altitude_amsl_m": None if amsl_m is None else round(amsl_m, 2),
            "altitude_relative_m": round(relative_m, 2),
        }
        for point, amsl_m, relative_m in waypoints
    ]


@given(st.lists(POINTS, max_size=8))
def test_over_flat_ground_the_text_is_that_of_the_plain_values(drawn: list[RoutePoint]) -> None:
    points = RoutePoints.of(drawn)
    flat = Waypoints(points, None, points.agl_m)
    assert waypoints_to_json(flat) == plain(flat)
    assert orjson.dumps(waypoints_text(flat)) == orjson.dumps(plain(flat))


@given(st.lists(st.tuples(POINTS, HEIGHTS, HEIGHTS), min_size=1, max_size=8))
def test_over_terrain_the_text_is_that_of_the_plain_values(drawn: list[tuple[RoutePoint, float, float]]) -> None:
    points = RoutePoints.of([point for point, _, _ in drawn])
    waypoints = Waypoints(points, np.array([amsl for _, amsl, _ in drawn]), np.array([over for _, _, over in drawn]))
    assert waypoints_to_json(waypoints) == plain(waypoints)
    assert orjson.dumps(waypoints_text(waypoints)) == orjson.dumps(plain(waypoints))


@given(st.lists(st.tuples(st.floats(-180, 180), st.floats(-90, 90)), min_size=2, max_size=8))
def test_a_line_is_written_as_its_positions(positions: list[tuple[float, float]]) -> None:
    line = np.array(positions)
    assert orjson.dumps(line_text(line)) == orjson.dumps(line.tolist())
