"""The compiled solvers run once, so that they are compiled, or loaded, before somebody waits for them."""

import numpy as np

from inspection.graph.rehearsal import BESIDE, graph_to_rehearse_on
from inspection.graph.zone_index import ZoneIndex
from missions.routing import exact
from missions.routing.problem import Amounts, End, Objective, Problem, UavStart, Visit
from missions.routing.solver import solve
from missions.routing.terminals import AccessRules, Terminal, ways_between


def rehearse() -> None:
    """Find the ways of a UAV and a target; solve problems that are proven and searched, and one with wind, batteries and sorties."""
    ways_between(
        graph_to_rehearse_on(),
        ZoneIndex([], [], []),
        [Terminal(BESIDE)],
        [Terminal(BESIDE)],
        [Terminal(BESIDE)],
        AccessRules(1_000.0, 1_000.0, on_asset_m=1.0, off_network_factor=2.0, zone_clearance_m=0.0),
    )
    for targets in (2, exact.MAX_TARGETS + 1):
        places = np.arange(1.0, targets + 1.0)
        for objective in (Objective.TOTAL, Objective.MAKESPAN):
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
    way = np.ones((1, 2))
    solve(
        Problem(
            uavs=(UavStart(1_000.0, End.RETURN, usable_wh=3.0, sorties=2),),
            visits=(Visit(0), Visit(1)),
            target_count=2,
            from_start_m=way,
            between_m=np.ones((2, 2)),
            to_start_m=way.T,
            objective=Objective.TIME,
            seconds=Amounts(way, np.ones((1, 2, 2)), way.T),
            wh=Amounts(way, np.ones((1, 2, 2)), way.T),
        )
    )
