"""Warm-up of a process before its first plan."""

import logging

from django.db import Error, connections

from inspection.network.route_index import asset_places, node_tree, route_index
from inspection.network.spans import spans_of
from inspection.network.warm_up import rehearse as rehearse_ways
from inspection.selectors import NoGraph
from missions.selectors.planning_context import current_airspace
from planning.solver.warm_up import rehearse as rehearse_solvers
from planning.trajectory.warm_up import rehearse as rehearse_drawing

logger = logging.getLogger(__name__)


def warm_up() -> None:
    """Load the compiled core, the graph and its index. Without a graph or a database the first plan loads them."""
    rehearse_ways()
    rehearse_solvers()
    rehearse_drawing()
    try:
        airspace = current_airspace()
    except NoGraph:
        return
    except Error as error:
        logger.warning("the graph is not loaded yet: %s", error)
        return
    finally:
        connections.close_all()
    for part in (route_index, node_tree, asset_places):
        part(airspace.graph)
    asset_places(airspace.whole_graph)
    spans_of(airspace.network)
