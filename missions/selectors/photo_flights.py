"""Flights through the photos that targets ask for, planned once for each asset, camera and map, and kept."""

import contextlib
import hashlib
import json
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, TypeVar

from django.conf import settings
from django.core.cache import cache

from inspection.models import Asset
from inspection.selectors.planning import DatasetVersion, terrain_at
from missions.models import Route, Waypoint
from missions.selectors.inspection_sites import SiteOnMap, UnfitBridge, site_on_map
from operation.reasons import Reason, reason_from_json
from operation.version import VERSION as PROGRAM_VERSION
from planning.context import ResolvedTarget
from planning.task import ViewPattern, ViewsRequest, task_from_json, views_to_json
from planning.views.camera import Camera
from planning.views.detail_views import TooManyPhotos
from planning.views.limits import DetailRules
from planning.views.photo_flight import GroundUnknown, PhotoFlight, photo_flight
from planning.views.view_flight import NoWay
from planning.views.view_plan import ViewPlan, ViewSpeeds, detail_plan, overview_plan, spans_plan
from workspace.cache_unavailable import CACHE_UNAVAILABLE
from workspace.jobs.planning_lock import hold_planning_lock

KEPT_S = 7 * 86_400
VERSION = 5  # counts the changes of what a flight is planned by, or is kept as

AnyTarget = TypeVar("AnyTarget", bound=ResolvedTarget)
OnPhotos = Callable[[int, int], None]  # of targets with photos: so many are planned, of so many


class NotATower(Exception):
    """The asset is no support of a line, and no bridge or asked for wires: it has no model."""


def planned_views(asset: Asset, views: ViewsRequest) -> tuple[SiteOnMap, ViewPlan]:
    """Return the site of an asset and its photos. Raises NotATower, UnfitBridge, TooManyPhotos or NoWay."""
    found = site_on_map(asset, views)
    if found is None:
        raise NotATower
    with hold_planning_lock():
        if views.pattern is ViewPattern.SPANS:
            return found, spans_plan(found.site, views.camera, views.gsd_m, ViewSpeeds())
        if views.pattern is ViewPattern.OVERVIEW:
            return found, overview_plan(found.site, views.camera, views.gsd_m, ViewSpeeds())
        return found, detail_plan(found.site, views.camera, DetailRules(views.gsd_m), ViewSpeeds())


def keep_photo_flight(asset: Asset, views: ViewsRequest, found: SiteOnMap, plan: ViewPlan, version: DatasetVersion) -> None:
    """Keep the flight of a plan of photos, so that a mission with them is planned at once."""
    _keep(_key(asset.pk, views, version), _flight(found, plan, views))


def with_photo_flights(targets: Sequence[AnyTarget], version: DatasetVersion, on_photos: OnPhotos) -> list[AnyTarget]:
    """Return the targets, those that ask for photos with the flight through them, or with the reason why there is none."""
    asked = {place: target.task.views for place, target in enumerate(targets) if target.task.views is not None}
    if not asked:
        return list(targets)
    assets = Asset.objects.in_bulk([key for place in asked if (key := targets[place].asset) is not None])
    found = list(targets)
    for count, (place, views) in enumerate(asked.items()):
        on_photos(count, len(asked))
        key = targets[place].asset
        flight = Reason("photos_not_a_tower") if key is None or key not in assets else _photo_flight(assets[key], views, version)
        if isinstance(flight, Reason):
            found[place] = replace(targets[place], no_photos=flight)
        else:
            found[place] = replace(targets[place], photos=flight)
    return found


def _photo_flight(asset: Asset, views: ViewsRequest, version: DatasetVersion) -> PhotoFlight | Reason:
    key = _key(asset.pk, views, version)
    kept = _kept(key)
    if kept is not None:
        return kept
    try:
        flight: PhotoFlight | Reason = _flight(*planned_views(asset, views), views)
    except NotATower:
        return Reason("photos_not_a_tower")
    except UnfitBridge as error:
        flight = Reason(f"photos_{error.code}")
    except TooManyPhotos:
        flight = Reason("photos_too_many")
    except NoWay:
        flight = Reason("photos_no_way")
    _keep(key, flight)
    return flight


def _flight(found: SiteOnMap, plan: ViewPlan, views: ViewsRequest) -> PhotoFlight | Reason:
    if found.base_amsl_m is None:
        return Reason("photos_need_terrain")
    if not len(plan.poses):
        return Reason("photos_none_possible")
    try:
        return photo_flight(plan, found.frame, found.base_amsl_m, found.ground_m, found.site.clearance_m, views.camera.gimbal)
    except GroundUnknown:
        return Reason("photos_need_terrain")


def kept_by(asset: int, views: ViewsRequest, version: DatasetVersion) -> dict[str, Any]:
    """Return what an asset's photos are planned and proven by; what is kept of them is kept by it."""
    return {
        "version": [VERSION, PROGRAM_VERSION], "asset": asset, "views": views_to_json(views), "map": str(version),
        "terrain": str(terrain_at(version)), "rules": [repr(settings.CLEARANCE_RULES), settings.FLIGHT_RULES.max_agl_m],
    }  # fmt: skip


def _key(asset: int, views: ViewsRequest, version: DatasetVersion) -> str:
    return "photos:" + hashlib.sha256(json.dumps(kept_by(asset, views, version), sort_keys=True).encode()).hexdigest()


def _kept(key: str) -> PhotoFlight | Reason | None:
    with contextlib.suppress(*CACHE_UNAVAILABLE):
        if (kept := cache.get(key)) is not None:
            return PhotoFlight.from_json(kept["flight"]) if "flight" in kept else reason_from_json(kept["reason"])
    return None


def _keep(key: str, flight: PhotoFlight | Reason) -> None:
    with contextlib.suppress(*CACHE_UNAVAILABLE):
        cache.set(key, {"reason": flight.to_json()} if isinstance(flight, Reason) else {"flight": flight.to_json()}, KEPT_S)


def planned_cameras(routes: Sequence[Route]) -> dict[int, list[Camera]]:
    """Return the cameras of the photos that each of the routes takes, by the route's key; none of a route without photos."""
    photos = Waypoint.objects.filter(route__in=routes, target__task__has_key="views").order_by("route_id", "target_id")
    rows = photos.values_list("route_id", "target__task").distinct()
    found: dict[int, list[Camera]] = {}
    for route, value in rows:
        task = task_from_json(value)
        if task is not None and task.views is not None and task.views.camera not in found.setdefault(route, []):
            found[route].append(task.views.camera)
    return found
