"""Reasons against approving a mission from its vehicles' data: their class, and items that their firmware refuses."""

from collections.abc import Iterator

from django.utils.translation import gettext as _
from django.utils.translation import gettext_noop

from mavlink.approved_route import NotARoute
from mavlink.autopilot_type import COMMANDED, AutopilotType
from mavlink.mission_items import CannotBeFlown, flight_loads
from mavlink.mission_sync.supported_items import command_words, firmware_words, unknown_items, version_of
from mavlink.rtl import fence_off_by
from mavlink.vehicle_class import VehicleClass, class_of
from missions.models import LinkKind, Mission, Route, Uav
from missions.services.approval.document import frozen_route
from missions.services.commands.refused import RefusalReason
from telemetry.models import UavLink

KINDS = {
    VehicleClass.PLANE: gettext_noop("plane"),
    VehicleClass.VTOL: gettext_noop("VTOL"),
    VehicleClass.ROVER: gettext_noop("rover"),
    VehicleClass.BOAT: gettext_noop("boat"),
    VehicleClass.SUBMARINE: gettext_noop("submarine"),
    VehicleClass.OTHER: gettext_noop("vehicle of another kind"),
}


def reasons_of_vehicles(mission: Mission) -> list[RefusalReason]:
    """Return the reasons for UAVs with a known MAVLink link; for others the upload decides."""
    routes = [route for route in mission.routes.all() if route.geometry is not None]
    routes = [route for route in routes if route.mission_uav.uav is not None and route.mission_uav.uav.link == LinkKind.MAVLINK]
    links = UavLink.objects.in_bulk([route.mission_uav.uav_id for route in routes])
    return [reason for route in routes if (link := links.get(route.mission_uav.uav_id)) for reason in _reasons(mission, route, link)]


def kind_refusal(name: str, link: UavLink) -> str:
    """Return why a UAV receives no missions; empty for a multicopter or an unknown class."""
    vehicle_class = class_of(link.vehicle_type)
    if link.vehicle_type is None or vehicle_class is VehicleClass.COPTER:
        return ""
    values = {"uav": name, "kind": _(KINDS[vehicle_class])}
    return _("%(uav)s is a %(kind)s: Spanwise plans for and commands multicopters only.") % values


def connection_warnings(uav: Uav, link: UavLink) -> list[str]:
    """Return the warnings to show with its link."""
    reported = uav.autopilot_return if uav.link == LinkKind.MAVLINK else {}
    off_by = fence_off_by(reported.get("autopilot", ""), reported.get("parameters", {}))
    fence = _("Its autopilot ignores every fence that is sent to it: %(parameter)s.") % {"parameter": off_by} if off_by else ""
    return [words for words in (kind_refusal(uav.name, link), fence) if words]


def _reasons(mission: Mission, route: Route, link: UavLink) -> Iterator[RefusalReason]:
    name, place = route.mission_uav.name, route.mission_uav.sequence
    if refused := kind_refusal(name, link):
        yield RefusalReason("vehicle_class", refused, place)
        return
    if link.autopilot not in COMMANDED:
        return
    autopilot_type, firmware = AutopilotType(link.autopilot), version_of(link.firmware)
    try:
        loads = flight_loads(frozen_route(route, mission))
    except (CannotBeFlown, NotARoute):
        return  # approval refuses these itself
    unknown = [one.item for load in loads for one in unknown_items(load.mission, autopilot_type, firmware)]
    first_of = {item.command: item.waypoint for item in reversed(unknown)}
    for command, waypoint in first_of.items():
        values = {
            "autopilot": firmware_words(autopilot_type, firmware), "uav": name, "command": command_words(command),
            "waypoint": 0 if waypoint is None else waypoint + 1,
        }  # fmt: skip
        words = _(
            "%(autopilot)s of %(uav)s does not know %(command)s, at waypoint %(waypoint)s. Choose another task, or update its firmware."
        )
        yield RefusalReason("unknown_items", words % values, place)
