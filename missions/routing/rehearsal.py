"""The compiled solvers run once, so that they are compiled, or loaded, before somebody waits for them."""

import io

import numpy as np

from missions.routing.file_plans import plan_json, read_graph
from missions.routing.problem import Objective, Problem, UavStart, Visit
from missions.routing.solver import solve


def rehearse() -> None:
    """Solve a problem of one UAV and two targets for either objective."""
    for objective in Objective:
        solve(
            Problem(
                uavs=(UavStart(1_000.0),),
                visits=(Visit(0), Visit(1)),
                target_count=2,
                from_start_m=np.array([[10.0, 20.0]]),
                between_m=np.array([[0.0, 10.0], [10.0, 0.0]]),
                to_start_m=np.array([[10.0], [20.0]]),
                objective=objective,
            )
        )


def rehearse_file_plans() -> None:
    """Plan a mission of one UAV and one target on a graph of two nodes."""
    file = io.BytesIO()
    np.savez(file, lat=np.array([47.0, 47.1]), lon=np.array([9.0, 9.0]), u=np.array([0]), v=np.array([1]), w=np.array([11_000.0]))
    file.seek(0)
    plan_json(read_graph(file), {"uavs": [[47.0, 9.0]], "targets": [1]}, Objective.TOTAL, float)
