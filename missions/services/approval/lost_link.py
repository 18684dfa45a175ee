"""Where on stored routes the lost-link action could not be done."""

from typing import Any

from inspection.selectors.planning import planning_read
from missions.models import Mission
from missions.selectors.planning_context import planning_context
from missions.services.stored_routes import stored_routes
from planning.checks.lost_link import lost_link_check
from planning.request import PlanRequest


def lost_link_of_stored(mission: Mission, request: PlanRequest) -> dict[str, Any] | None:
    """Return the check of a mission's stored routes with the current zones; None where it has no routes or their times are unknown.

    request: the mission's stored request. Raises NoGraph.
    """
    routes = stored_routes(mission)
    if routes is None:
        return None
    return lost_link_check(request, routes, planning_context(request, planning_read().ground()))
