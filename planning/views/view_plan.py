"""Photos of a tower with the flight through them and what they show: of every part, or of the whole from four sides."""

from dataclasses import dataclass

import numpy as np

from planning.views.camera import Camera, Lens
from planning.views.coverage import ComponentCoverage, Coverage, by_component
from planning.views.detail_views import detail_views
from planning.views.limits import DetailRules
from planning.views.overview import overview_poses
from planning.views.proof import flown_camera, proof_surface
from planning.views.site import TowerSite
from planning.views.solids import FloatArray
from planning.views.view_flight import NO_PHOTO, ViewFlight, view_flight
from planning.views.visibility import Poses, RayCaster, axes_of

ENTRY_ABOVE_M = 2.0  # the keep-out over the tower


@dataclass(frozen=True)
class ViewSpeeds:
    """How a UAV flies from photo to photo: m/s along and up or down, and what a stop for a photo or at a bend takes [s]."""

    along_mps: float = 4.0
    vertical_mps: float = 2.5
    photo_s: float = 6.5  # slowing down, standing still, the photo, speeding up
    bend_s: float = 4.5


@dataclass(frozen=True, eq=False)
class ViewPlan:
    """Photos in the order flown. distance_m: along each optical axis to the tower. seconds: of the whole flight.

    bound: no choice shows as much with fewer photos, as in DetailViews.
    """

    poses: Poses
    distance_m: FloatArray
    lens: Lens
    flight: ViewFlight
    coverage: Coverage
    components: tuple[ComponentCoverage, ...]
    bound: int
    seconds: float


def detail_plan(site: TowerSite, camera: Camera, rules: DetailRules, speeds: ViewSpeeds) -> ViewPlan:
    """Plan photos of every part. Raises TooManyPhotos, or NoWay where the flight over the wires would be too high.

    No photo looks steeper down than MIN_PITCH_DEG: the camera is aimed at a place, and one right under the UAV has no bearing.
    """
    views = detail_views(site.solid, site.keep_out, flown_camera(camera), rules)
    return _plan(site, camera, views.poses, views.lens.focal_mm, views.bound, rules.asked_gsd_m, speeds)


def overview_plan(site: TowerSite, camera: Camera, asked_gsd_m: float, speeds: ViewSpeeds) -> ViewPlan:
    """Plan photos of the whole tower at the shortest focal length. What is coarser than asked_gsd_m counts as not shown. Raises NoWay."""
    poses = overview_poses(site, flown_camera(camera))
    return _plan(site, camera, poses, camera.focal_lengths_mm[0], len(poses), asked_gsd_m, speeds)


def _plan(
    site: TowerSite, camera: Camera, unordered: Poses, focal_mm: float, bound: int, asked_gsd_m: float, speeds: ViewSpeeds
) -> ViewPlan:  # fmt: skip
    entry = np.array([0.0, 0.0, site.keep_out.top_at(np.zeros(2)) + ENTRY_ABOVE_M])
    flight = view_flight(unordered, site.keep_out, entry, entry)
    order = flight.photo[flight.photo != NO_PHOTO]
    poses = unordered.only(order)
    renumbered = np.full(len(flight), NO_PHOTO)
    renumbered[flight.photo != NO_PHOTO] = np.arange(len(order))
    surface = proof_surface(site, flown_camera(camera), asked_gsd_m)
    lens = surface.lens(focal_mm)
    coverage = surface.coverage(poses, lens)
    return ViewPlan(
        poses, _distance_m(poses, surface.caster), lens, ViewFlight(flight.position, renumbered), coverage,
        by_component(site.solid, coverage), bound, _seconds(flight.position, len(poses), speeds),
    )  # fmt: skip


def _distance_m(poses: Poses, caster: RayCaster) -> FloatArray:
    """To what each photo shows in its middle; as far as the tower's axis where that is none of it."""
    _, _, forward = axes_of(poses.yaw_deg, poses.pitch_deg)
    away_m = caster.distance_m(poses.position, forward)
    beside_m = np.maximum(np.hypot(poses.position[:, 0], poses.position[:, 1]), 1.0)
    found: FloatArray = np.where(np.isfinite(away_m), away_m, beside_m)
    return found


def _seconds(position: FloatArray, photos: int, speeds: ViewSpeeds) -> float:
    change = np.abs(np.diff(position, axis=0))
    along_s = np.hypot(change[:, 0], change[:, 1]) / speeds.along_mps
    stops_s = photos * speeds.photo_s + (len(position) - photos) * speeds.bend_s
    return float(np.maximum(along_s, change[:, 2] / speeds.vertical_mps).sum()) + stops_s
