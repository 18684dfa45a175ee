"""Photos of a tower or a bridge, planned at a user's request, with the flight through them and the zones that it meets."""

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from inspection.models import Asset
from inspection.scene.supports import DrawnSupport
from inspection.selectors.planning import current_dataset_version
from inspection.selectors.zone_table import zone_table
from missions.selectors.inspection_sites import SiteOnMap
from missions.selectors.photo_flights import keep_photo_flight, planned_views
from missions.selectors.zones import zone_margins
from planning.checks.zones import zones_met
from planning.clearance.zone_clearance import FlownRoute
from planning.task import MM_PER_M, ViewsRequest, views_to_json
from planning.views.bridge_solid import BridgeShape
from planning.views.coverage import ComponentCoverage, Coverage
from planning.views.solids import FloatArray
from planning.views.view_flight import NO_PHOTO
from planning.views.view_plan import ViewPlan

ZONE_STEP_M = 5.0  # between places of the flight whose heights above ground are looked at


def plan_views(*, asset: Asset, views: ViewsRequest) -> dict[str, Any]:
    """Return the plan in the shape of the API, and keep its flight for missions.

    Raises NotATower, UnfitBridge, TooManyPhotos, or NoWay where no flight keeps out of what stands there below the greatest height.
    """
    version = current_dataset_version()
    found, plan = planned_views(asset, views)
    keep_photo_flight(asset, views, found, plan, version)
    return _plan_json(asset, views, found, plan)


def _plan_json(asset: Asset, views: ViewsRequest, found: SiteOnMap, plan: ViewPlan) -> dict[str, Any]:
    flight, model = plan.flight, found.model
    positions = found.frame.to_degrees(flight.position[:, :2])
    agl_m = flight.position[:, 2] - found.ground_m(flight.position[:, :2])
    photo_at = np.flatnonzero(flight.photo != NO_PHOTO)
    return {
        "asset": asset.pk,
        **views_to_json(views),
        "focal_length_mm": plan.lens.focal_mm,
        "farthest_m": plan.lens.farthest_m,
        "clearance_m": found.site.clearance_m,
        "has_terrain": found.base_amsl_m is not None,
        "model": _tower_json(model) if isinstance(model, DrawnSupport) else None,
        "bridge": _bridge_json(model, found) if isinstance(model, BridgeShape) else None,
        "photos": [
            {
                "position": positions[place].tolist(),
                "height_agl_m": None if np.isnan(agl_m[place]) else float(agl_m[place]),
                "height_m": float(flight.position[place, 2]),
                "yaw_deg": float(plan.poses.yaw_deg[number]),
                "pitch_deg": float(plan.poses.pitch_deg[number]),
            }
            for number, place in enumerate(photo_at.tolist())
        ],
        "photos_bound": plan.bound,
        "route": [[*position, height_m] for position, height_m in zip(positions.tolist(), flight.position[:, 2].tolist(), strict=True)],
        "length_m": flight.length_m,
        "duration_s": plan.seconds,
        "coverage": coverage_json(plan.coverage, plan.components),
        "zones": _zones(found, flight.position),
    }  # fmt: skip


def _tower_json(tower: DrawnSupport) -> dict[str, Any]:
    return {
        "form": tower.form, "height_m": tower.likely_m, "height_source": tower.height_source, "voltage_v": tower.voltage_v,
        "is_anchor": tower.is_anchor, "bearing_deg": tower.bearing_deg,
    }  # fmt: skip


def _bridge_json(bridge: BridgeShape, found: SiteOnMap) -> dict[str, Any]:
    return {
        "deck_height_m": bridge.deck_m, "deck_source": found.deck_source, "top_m": bridge.top_m, "length_m": bridge.length_m,
        "width_m": bridge.width_m, "piers": bridge.piers, "bearing_deg": bridge.bearing_deg,
    }  # fmt: skip


def coverage_json(coverage: Coverage, components: Sequence[ComponentCoverage]) -> dict[str, Any]:
    whole_m2 = float(coverage.patches.area_m2.sum())
    return {
        "shown": float(coverage.patches.area_m2[coverage.shown].sum()) / whole_m2,
        "reachable": float(coverage.patches.area_m2[coverage.reachable].sum()) / whole_m2,
        "shown_of_reachable": coverage.share,
        "components": [_component_json(row) for row in components],
    }


def _component_json(row: ComponentCoverage) -> dict[str, Any]:
    return {
        "component": row.component, "number": row.number, "area_m2": row.area_m2, "shown": row.shown, "reachable": row.reachable,
        "gsd_mm": None if row.gsd_m is None else row.gsd_m * MM_PER_M, "angle_deg": row.angle_deg, "limit": row.limit or None,
    }  # fmt: skip


def _zones(found: SiteOnMap, position: FloatArray) -> list[dict[str, Any]]:
    """The zones that the flight meets at any time, each once; unknown heights may be any."""
    places = _every(ZONE_STEP_M, position)
    agl_m = places[:, 2] - found.ground_m(places[:, :2])
    amsl_m = None if found.base_amsl_m is None else places[:, 2] + found.base_amsl_m
    flown = FlownRoute(found.frame.to_degrees(places[:, :2]), agl_m, amsl_m)
    met = zones_met([flown], zone_table(), zone_margins())
    return [{"id": key, "name": name} for key, name in dict.fromkeys((zone.zone, zone.name) for zone in met[0])]


def _every(step_m: float, position: FloatArray) -> FloatArray:
    """The flight with places no farther apart than this, (n, 3) [m]."""
    parts = [position[:1]]
    for start, end in pairwise(position):
        count = max(math.ceil(float(np.linalg.norm(end - start)) / step_m), 1)
        parts.append(start + (end - start) * np.linspace(0.0, 1.0, count + 1)[1:, None])
    return np.concatenate(parts)
