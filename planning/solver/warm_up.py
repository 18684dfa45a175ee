"""The compiled solvers run once, so that they are compiled, or loaded, before somebody waits for them."""

import numpy as np

from inspection.network.build.network import GRAPH_FIELDS, Network
from inspection.network.warm_up import BESIDE, graph_to_rehearse_on
from inspection.network.zones.zone_index import ZoneIndex
from planning.connection_points import AccessRules, Terminal, paths_between
from planning.energy.path_cost import FlightClass
from planning.energy.performance import Performance
from planning.problem import End, Objective, Problem, Resources, UavStart, Visit
from planning.reachability.reachability import FlownNetwork, PossibleFlight, reach
from planning.solver import exact
from planning.solver.solver import solve


def rehearse() -> None:
    """Run every compiled function of the planner's assignment."""
    rehearse_ways()
    rehearse_proof()
    rehearse_search()


def rehearse_ways() -> None:
    """Find the ways of a UAV and a target, and what else it reaches."""
    graph, zones = graph_to_rehearse_on(), ZoneIndex([], [], [])
    access = AccessRules(1_000.0, 1_000.0, on_asset_m=1.0, off_network_factor=2.0, zone_clearance_m=0.0)
    paths_between(graph, zones, [Terminal(BESIDE)], [Terminal(BESIDE)], [Terminal(BESIDE)], access)
    network = Network(**{name: getattr(graph, name) for name in GRAPH_FIELDS})
    flights = [PossibleFlight(BESIDE, End.RETURN, 1_000.0, lands=True, flying=FlightClass(Performance(battery_wh=50.0), 10.0))]
    reach(FlownNetwork(network, graph, graph, zones, zones), flights, [], access)


def rehearse_proof() -> None:
    """Solve problems that are proven, one of them with wind, batteries and sorties."""
    _solve_both_objectives(2)
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
            seconds=Resources(way, np.ones((1, 2, 2)), way.T),
            wh=Resources(way, np.ones((1, 2, 2)), way.T),
        )
    )


def rehearse_search() -> None:
    """Solve problems that are searched, no longer than until everything has run: a whole search takes seconds of the processor."""
    _solve_both_objectives(exact.MAX_TARGETS + 1)


def _solve_both_objectives(targets: int) -> None:
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
            ),
            stop=lambda: True,
        )
