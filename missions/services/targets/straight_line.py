"""What a route costs against the straight line: the summary of its explanation that every plan carries."""

import numpy as np

from inspection.geodesy import path_length_m
from planning.trajectory.waypoints import NONE, PASS, FloatArray, IntArray


def straight_json(position: FloatArray, kind: IntArray, target: IntArray, length_m: float) -> dict[str, float]:
    """As the crow flies from start over its targets to the end, stretches along their lines; and what is flown beyond that.

    position (n, 2), columns lon, lat [deg]; kind and target (n,) as in RoutePoints.
    """
    stops = position[(kind != PASS) | (target != NONE)]
    straight_m = path_length_m(np.ascontiguousarray(stops))
    return {"straight_m": round(straight_m, 1), "more_m": round(max(0.0, length_m - straight_m), 1)}
