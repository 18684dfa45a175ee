"""Where the waypoints of a mission are, in words: a target, an asset, the take-off; those without a name by the nearest that has one."""

from collections.abc import Mapping, Sequence

from django.utils.translation import gettext as _

from inspection.models import Asset
from inspection.selectors.asset_names import asset_label
from missions.models import Mission, Waypoint
from planning.trajectory.waypoints import WaypointKind

WaypointPlaces = Mapping[tuple[int, int], str]  # by the UAV's place in the mission and the waypoint's in its route


def waypoint_places(mission: Mission) -> WaypointPlaces:
    """Return the name of the place of each waypoint of the present plan. mission: as loaded by mission_of_organisation."""
    routes = {route.mission_uav.sequence: list(route.waypoints.all()) for route in mission.routes.all()}
    targets = {target.pk: target.label for target in mission.targets.all()}
    keys = {waypoint.asset_id for waypoints in routes.values() for waypoint in waypoints if waypoint.asset_id is not None}
    assets = {asset.pk: asset_label(asset) for asset in Asset.objects.filter(pk__in=keys)}
    return {
        (uav, waypoint.sequence): place
        for uav, waypoints in routes.items()
        for waypoint, place in zip(waypoints, _places(waypoints, targets, assets), strict=True)
    }


def _places(waypoints: Sequence[Waypoint], targets: Mapping[int, str], assets: Mapping[int, str]) -> list[str]:
    own = [_own(waypoint, targets, assets) for waypoint in waypoints]
    named = [number for number, name in enumerate(own) if name]
    if not named:
        return [_("its take-off")] * len(own)
    return [own[min(named, key=lambda other: abs(other - number))] for number in range(len(own))]


def _own(waypoint: Waypoint, targets: Mapping[int, str], assets: Mapping[int, str]) -> str:
    if waypoint.target_id is not None and targets.get(waypoint.target_id):
        return targets[waypoint.target_id]
    if waypoint.asset_id is not None and waypoint.asset_id in assets:
        return assets[waypoint.asset_id]
    if waypoint.kind == WaypointKind.START:
        return _("its take-off")
    return _("its base") if waypoint.kind == WaypointKind.BASE else ""
