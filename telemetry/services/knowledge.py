"""Input of the estimator for a flight: the approved route and its approval's data."""

from uuid import UUID

from missions.models import Approval
from missions.services.commands.dispatch import DamagedApproval, approved_load
from planning.clearance.lost_link import LostLink
from planning.energy.conditions import conditions_from_json
from planning.energy.performance import performance_from_json
from planning.request import lost_link_from_json
from telemetry.estimation.knowledge import Knowledge
from telemetry.services.of_flight import OfFlight


@OfFlight
def knowledge_of(approval_id: UUID, uav_id: int, flight: int) -> Knowledge:
    """Return the knowledge of a flight; empty after the last flight and for a damaged document. An approval never changes."""
    approval = Approval.objects.filter(pk=approval_id).first()
    if approval is None:
        return Knowledge()
    try:
        approved = approved_load(approval, uav_id=uav_id, flight=flight)
    except (DamagedApproval, LookupError, StopIteration):
        return Knowledge()
    document = approval.document
    figures = next(route["figures"] for route in document["routes"] if route["uav"] == uav_id)
    performance = performance_from_json(figures["performance"])
    return Knowledge(
        flight=approved.route.flights[flight - 1],
        cruise_speed_mps=approved.route.cruise_speed_mps,
        max_airspeed_mps=performance.max_airspeed_mps,
        climb_speed_mps=performance.climb_speed_mps or Knowledge.climb_speed_mps,
        conditions=conditions_from_json(document["conditions"]),
        home=approved.take_off.position,
        is_to_go_on=lost_link_from_json(document["lost_link"] or {}).behaviour is LostLink.GO_ON,
    )
