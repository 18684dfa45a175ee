"""The plan of a detail inspection: photos, the flight through them, what they will show, and what it takes."""

from dataclasses import dataclass

import numpy as np

from planning.views.camera import Camera, Lens, standoff_m
from planning.views.coverage import ComponentCoverage, Coverage, by_component, coverage_of
from planning.views.detail_views import REACH_M, detail_views
from planning.views.limits import DetailRules, limits_of
from planning.views.site import TowerSite
from planning.views.solids import FloatArray, patches_of
from planning.views.view_flight import NO_PHOTO, ViewFlight, view_flight
from planning.views.visibility import Poses, RayCaster

PROOF_PATCH_M = 1.0
ENTRY_ABOVE_M = 2.0  # the keep-out over the tower


@dataclass(frozen=True)
class DetailSpeeds:
    """How a UAV flies from photo to photo: m/s along and up or down, and seconds at each photo to stop, turn, settle and take it."""

    along_mps: float = 4.0
    vertical_mps: float = 2.0
    photo_s: float = 4.0


@dataclass(frozen=True, eq=False)
class DetailPlan:
    """Photos in the order flown. bound: see DetailViews. seconds: from the entry over the tower back to it."""

    poses: Poses
    lens: Lens
    flight: ViewFlight
    coverage: Coverage
    components: tuple[ComponentCoverage, ...]
    bound: int
    seconds: float


def detail_plan(site: TowerSite, camera: Camera, rules: DetailRules, speeds: DetailSpeeds) -> DetailPlan:
    """Plan photos of the site's tower. Raises TooManyPhotos, or NoWay where the flight over the wires would be too high."""
    views = detail_views(site.solid, site.keep_out, camera, rules)
    entry = np.array([0.0, 0.0, site.keep_out.top_at(np.zeros(2)) + ENTRY_ABOVE_M])
    flight = view_flight(views.poses, site.keep_out, entry, entry)
    order = flight.photo[flight.photo != NO_PHOTO]
    poses = views.poses.only(order)
    renumbered = np.full(len(flight), NO_PHOTO)
    renumbered[flight.photo != NO_PHOTO] = np.arange(len(order))
    patches, caster = patches_of(site.solid, PROOF_PATCH_M), RayCaster([site.solid])
    farthest_m = min(standoff_m(camera, rules.asked_gsd_m, camera.focal_lengths_mm[-1]), REACH_M)
    limits = limits_of(patches, site.keep_out, caster, camera, farthest_m)
    coverage = coverage_of(poses, views.lens, camera, patches, caster, limits.limit)
    return DetailPlan(
        poses, views.lens, ViewFlight(flight.position, renumbered), coverage, by_component(site.solid, coverage), views.bound,
        _seconds(flight.position, len(poses), speeds),
    )  # fmt: skip


def _seconds(position: FloatArray, photos: int, speeds: DetailSpeeds) -> float:
    change = np.abs(np.diff(position, axis=0))
    along_s = np.hypot(change[:, 0], change[:, 1]) / speeds.along_mps
    return float(np.maximum(along_s, change[:, 2] / speeds.vertical_mps).sum()) + photos * speeds.photo_s
