"""An approved mission brought into the air without a vehicle: dispatched and started as people do, and carried as a gateway carries it."""

from uuid import UUID

from deploy.load.day.site import InAir
from mavlink.approved_route import FrozenRoute, route_from_json
from missions.models import CommandKind, Mission, Uav, UavCommand
from missions.selectors.missions import approval_in_force
from missions.services.commands.commands import claim_commands, note_applied, note_sent
from missions.services.commands.dispatch import dispatch_mission
from missions.services.commands.steering import command_uav
from telemetry.services.links.links import release_leases, take_leases
from telemetry.services.links.onboard_lists import Carried, LoadedLists, begin_loading, end_loading
from workspace.models import User

HOLDER = "prepare-day/1"
LEASE_S = 30.0


def put_in_air(mission: Mission, user: User) -> list[InAir]:
    """Its UAVs with the ways that they fly."""
    approval = approval_in_force(mission)
    if approval is None:
        raise ValueError("it is not approved")
    routes = {entry["uav"]: entry for entry in approval.document["routes"]}
    take_leases(uav_ids=routes, holder=HOLDER, lease_s=LEASE_S)
    dispatch_mission(mission=mission, actor=user)
    for command in _carried(routes):
        sha256 = routes[command.uav_id]["flights"][0]["content_sha256"]
        _load(Carried.of(command), approval.pk, sha256)
    uavs = {uav.pk: uav for uav in Uav.objects.filter(pk__in=routes)}
    for uav in uavs.values():
        command_uav(uav=uav, kind=CommandKind.START, actor=user)
    for command in _carried(routes):
        note_sent(command.pk, attempt=command.attempts, holder=HOLDER)
        note_applied(command.pk, attempt=command.attempts, holder=HOLDER)
    release_leases(holder=HOLDER)
    return [_in_air(uavs[key], mission, route_from_json(entry["route"])) for key, entry in routes.items()]


def _carried(routes: dict[int, object]) -> list[UavCommand]:
    found = claim_commands(uav_ids=list(routes), holder=HOLDER, lease_s=LEASE_S, limit=len(routes))
    if len(found) != len(routes):
        raise ValueError(f"{len(found)} commands for {len(routes)} UAVs")
    return found


def _load(carried: Carried, approval: UUID, sha256: str) -> None:
    if not (begin_loading(carried) and end_loading(carried, LoadedLists(sha256, approval, 1))):
        raise ValueError("somebody else carries it")


def _in_air(uav: Uav, mission: Mission, route: FrozenRoute) -> InAir:
    way = tuple((point.position.lon, point.position.lat, point.altitude_relative_m) for point in route.waypoints)
    ground_m = route.take_off.altitude_amsl_m or 0.0
    return InAir(uav.pk, uav.mavlink_system_id or 0, str(mission.pk), uav.speed_mps, ground_m, way)
