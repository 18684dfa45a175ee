"""The compiled solvers run once, so that they are compiled, or loaded, before somebody waits for them."""

import numpy as np

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
