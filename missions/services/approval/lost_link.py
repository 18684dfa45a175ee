"""From where on their stored routes UAVs that lose their link could not do what is asked for."""

from typing import Any

from inspection.selectors.planning import planning_read
from missions.models import Mission
from missions.selectors.planning_context import planning_context
from missions.services.stored_routes import stored_routes
from planning.checks.lost_link import lost_link_check
from planning.request import PlanRequest


def lost_link_of_stored(mission: Mission, request: PlanRequest) -> dict[str, Any] | None:
    """The check for the stored routes of a mission, with the zones of now; None where there are none, or their times are not known.

    request: what the mission holds. Raises NoGraph.
    """
    routes = stored_routes(mission)
    if routes is None:
        return None
    return lost_link_check(request, routes, planning_context(request, planning_read().ground()))
