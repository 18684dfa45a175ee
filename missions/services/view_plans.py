"""Photos of a tower, planned at a user's request, with the flight through them and the zones that it meets."""

from typing import Any

import numpy as np
from django.conf import settings

from inspection.models import Asset
from inspection.selectors.zone_table import zone_table
from missions.selectors.planning_rules import planning_rules
from missions.selectors.tower_sites import TowerOnMap, tower_on_map
from planning.checks.zones import zones_met
from planning.clearance.zone_clearance import FlownRoute
from planning.views.camera import Camera, camera_to_json
from planning.views.coverage import ComponentCoverage
from planning.views.detail_plan import DetailPlan, DetailSpeeds, detail_plan
from planning.views.limits import DetailRules
from planning.views.view_flight import NO_PHOTO
from workspace.jobs.planning_lock import hold_planning_lock

MM_PER_M = 1_000.0


class NotATower(Exception):
    """The asset is no support of a line: only these have models yet."""


def plan_views(*, asset: Asset, camera: Camera, asked_gsd_m: float, min_height_m: float) -> dict[str, Any]:
    """Return the plan in the shape of the API. Raises NotATower, or NoWay where the flight would be above the greatest height."""
    found = tower_on_map(asset, min_height_m)
    if found is None:
        raise NotATower
    rules = DetailRules(asked_gsd_m, min_height_m, settings.FLIGHT_RULES.max_agl_m)
    with hold_planning_lock():
        plan = detail_plan(found.site, camera, rules, DetailSpeeds())
    return _plan_json(asset, camera, asked_gsd_m, found, plan)


def _plan_json(asset: Asset, camera: Camera, asked_gsd_m: float, found: TowerOnMap, plan: DetailPlan) -> dict[str, Any]:
    flight, tower = plan.flight, found.site.tower
    positions = found.frame.to_degrees(flight.position[:, :2])
    agl_m = flight.position[:, 2] - found.ground_m(flight.position[:, :2])
    photo_at = np.flatnonzero(flight.photo != NO_PHOTO)
    coverage = plan.coverage
    whole_m2 = float(coverage.patches.area_m2.sum())
    return {
        "asset": asset.pk,
        "camera": camera_to_json(camera),
        "gsd_mm": asked_gsd_m * MM_PER_M,
        "focal_length_mm": plan.lens.focal_mm,
        "farthest_m": plan.lens.farthest_m,
        "clearance_m": found.site.clearance_m,
        "model": {
            "form": tower.form, "height_m": tower.likely_m, "height_source": tower.height_source, "voltage_v": tower.voltage_v,
            "is_anchor": tower.is_anchor, "bearing_deg": tower.bearing_deg,
        },
        "photos": [
            {
                "position": positions[place].tolist(), "height_agl_m": float(agl_m[place]), "height_m": float(flight.position[place, 2]),
                "yaw_deg": float(plan.poses.yaw_deg[number]), "pitch_deg": float(plan.poses.pitch_deg[number]),
            }
            for number, place in enumerate(photo_at.tolist())
        ],
        "photos_bound": plan.bound,
        "route": [[*position, height_m] for position, height_m in zip(positions.tolist(), flight.position[:, 2].tolist(), strict=True)],
        "length_m": flight.length_m,
        "duration_s": plan.seconds,
        "coverage": {
            "shown": float(coverage.patches.area_m2[coverage.shown].sum()) / whole_m2,
            "reachable": float(coverage.patches.area_m2[coverage.reachable].sum()) / whole_m2,
            "shown_of_reachable": coverage.share,
            "components": [_component_json(row) for row in plan.components],
        },
        "zones": _zones(found, positions, agl_m, flight.position[:, 2]),
    }  # fmt: skip


def _component_json(row: ComponentCoverage) -> dict[str, Any]:
    return {
        "component": row.component, "number": row.number, "area_m2": row.area_m2, "shown": row.shown, "reachable": row.reachable,
        "gsd_mm": None if row.gsd_m is None else row.gsd_m * MM_PER_M, "angle_deg": row.angle_deg, "limit": row.limit or None,
    }  # fmt: skip


def _zones(found: TowerOnMap, positions: Any, agl_m: Any, height_m: Any) -> list[dict[str, Any]]:
    """The zones that the flight meets at any time, each once."""
    amsl_m = None if found.base_amsl_m is None else height_m + found.base_amsl_m
    met = zones_met([FlownRoute(positions, agl_m, amsl_m)], zone_table(), planning_rules().margins)
    return [{"id": key, "name": name} for key, name in dict.fromkeys((zone.zone, zone.name) for zone in met[0])]
