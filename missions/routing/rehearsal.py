"""The compiled solvers run once, so that they are compiled, or loaded, before somebody waits for them."""

import numpy as np

from missions.routing import exact
from missions.routing.problem import Objective, Problem, UavStart, Visit
from missions.routing.solver import solve


def rehearse() -> None:
    """Solve a problem that is proven and one that is searched, for either objective."""
    for targets in (2, exact.MAX_TARGETS + 1):
        places = np.arange(1.0, targets + 1.0)
        for objective in Objective:
            solve(
                Problem(
                    uavs=(UavStart(1_000.0), UavStart(1_000.0, speed_mps=2.0)),
                    visits=tuple(Visit(target) for target in range(targets)),
                    target_count=targets,
                    from_start_m=np.stack([places, places]),
                    between_m=np.abs(places[:, None] - places[None]),
                    to_start_m=np.stack([places, places], axis=1),
                    objective=objective,
                )
            )
