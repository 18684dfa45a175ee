"""Photos of an asset with the flight through them and what they show: of every part, of the whole from four sides, or of a tower's wires.

An overview looks from between the directions of the line or of the bridge, obliquely from above where heights allow it.
"""

import math
from dataclasses import dataclass

import numpy as np

from planning.views.camera import Camera, Lens
from planning.views.coverage import ComponentCoverage, Coverage, by_component
from planning.views.detail_views import detail_views
from planning.views.limits import DetailRules
from planning.views.proof import ProofSurface, flown_camera, proof_surface
from planning.views.site import InspectionSite
from planning.views.solids import FloatArray
from planning.views.span_views import span_photos, wires_solid
from planning.views.view_flight import NO_PHOTO, ViewFlight, view_flight
from planning.views.visibility import Poses, RayCaster, axes_of

ENTRY_ABOVE_M = 2.0  # the keep-out over the asset
# Overviews.
SIDES_DEG = (45.0, 135.0, 225.0, 315.0)  # where the UAV is, from the line's bearing
TURNS_DEG = (0.0, 10.0, -10.0, 20.0, -20.0, 30.0, -30.0)  # by which it is moved to a side where something stands
PITCHES_DEG = (-30.0, -20.0, -10.0, 0.0, 10.0)  # the first that heights allow
FILLED = 0.9  # of the picture's width or height at most, by the asset
STEP_M = 1.0  # farther away, until nothing stands there
UNKNOWN_M = 30.0  # less than a site's surroundings are known: so far wires and supports reach by clearance and swing
NEARLY = 1.25  # as far as the nearest of all: as good


@dataclass(frozen=True)
class ViewSpeeds:
    """How a UAV flies from photo to photo: m/s along and up or down, and what a stop for a photo or at a bend takes [s]."""

    along_mps: float = 4.0
    vertical_mps: float = 2.5
    photo_s: float = 6.5  # slowing down, standing still, the photo, speeding up
    bend_s: float = 4.5


@dataclass(frozen=True, eq=False)
class ViewPlan:
    """Photos in the order flown. distance_m: along each optical axis to the asset. seconds: of the whole flight.

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


def detail_plan(site: InspectionSite, camera: Camera, rules: DetailRules, speeds: ViewSpeeds) -> ViewPlan:
    """Plan photos of every part. Raises TooManyPhotos, or NoWay where the flight over the wires would be too high.

    No photo looks steeper down than MIN_PITCH_DEG: the camera is aimed at a place, and one right under the UAV has no bearing.
    """
    camera = flown_camera(camera)
    views = detail_views(site, camera, rules)
    surface = proof_surface(site, camera, rules.asked_gsd_m)
    return _plan(site, surface, views.poses, views.lens.focal_mm, views.bound, speeds)


def overview_plan(site: InspectionSite, camera: Camera, asked_gsd_m: float, speeds: ViewSpeeds) -> ViewPlan:
    """Plan photos of the whole asset at the shortest focal length. What is coarser than asked_gsd_m counts as not shown. Raises NoWay."""
    camera = flown_camera(camera)
    poses = overview_poses(site, camera)
    return _plan(site, proof_surface(site, camera, asked_gsd_m), poses, camera.focal_lengths_mm[0], len(poses), speeds)


def spans_plan(site: InspectionSite, camera: Camera, asked_gsd_m: float, speeds: ViewSpeeds) -> ViewPlan:
    """Plan photos of the wires up to the middle of each span, from both sides. Raises TooManyPhotos or NoWay."""
    camera = flown_camera(camera)
    photos = span_photos(site, camera, asked_gsd_m)
    surface = proof_surface(site, camera, asked_gsd_m, wires_solid(site))
    return _plan(site, surface, photos.poses, photos.focal_mm, len(photos.poses), speeds, photos.distance_m)


def overview_poses(site: InspectionSite, camera: Camera) -> Poses:
    """Return up to four poses, each of which has the whole asset in its picture at the shortest focal length.

    A side from which that is not possible within the known surroundings is left out.
    """
    found = [pose for side in SIDES_DEG if (pose := _pose(site, camera, site.bearing_deg + side)) is not None]
    values = np.array(found).reshape(-1, 5)
    return Poses(values[:, :3], values[:, 3], values[:, 4])


def _pose(site: InspectionSite, camera: Camera, azimuth_deg: float) -> tuple[float, ...] | None:
    """Position [m], yaw and pitch [deg] of the photo from a side; None where there is none."""
    low, high = site.solid.box
    middle = (low + high) / 2.0
    beside = np.unique(site.solid.triangles.reshape(-1, 3), axis=0) - middle
    best: tuple[float, tuple[float, ...]] | None = None
    for turn_deg in TURNS_DEG:
        for pitch_deg in PITCHES_DEG:
            if not camera.gimbal.pitch_min_deg <= pitch_deg <= camera.gimbal.pitch_max_deg:
                continue
            yaw_deg = (azimuth_deg + turn_deg + 180.0) % 360.0
            least_m, forward = _whole_m(beside, camera, yaw_deg, pitch_deg)
            away_m = _clear_m(middle, forward, least_m, site)
            if away_m is None:
                continue
            pose = (*(middle - forward * away_m).tolist(), yaw_deg, pitch_deg)
            if away_m <= NEARLY * least_m:
                return pose
            if best is None or away_m < best[0]:
                best = away_m, pose
    return None if best is None else best[1]


def _whole_m(beside: FloatArray, camera: Camera, yaw_deg: float, pitch_deg: float) -> tuple[float, FloatArray]:
    """Return the least distance [m] from which points (p, 3) beside the aim are in the picture and sharp, and the optical axis."""
    right, up, forward = (axes[0] for axes in axes_of(np.array([yaw_deg]), np.array([pitch_deg])))
    nearer_m = beside @ forward
    half_wide, half_high = (
        FILLED * side_mm / (2.0 * camera.focal_lengths_mm[0]) for side_mm in (camera.sensor_width_mm, camera.sensor_height_mm)
    )
    least_m = np.maximum(np.abs(beside @ right) / half_wide, np.abs(beside @ up) / half_high) - nearer_m
    return max(float(least_m.max()), float((camera.nearest_focus_m - nearer_m).max())), forward


def _clear_m(middle: FloatArray, forward: FloatArray, least_m: float, site: InspectionSite) -> float | None:
    """The least distance [m] from the middle, from which an axis looks, that is out of the keep-out; None within the surroundings."""
    level = math.hypot(float(forward[0]), float(forward[1]))
    away_m = np.arange(least_m, (site.around_m - UNKNOWN_M) / level, STEP_M)
    places = middle - away_m[:, None] * forward
    is_known = np.abs(places[:, :2]).max(axis=1, initial=0.0) <= site.around_m - UNKNOWN_M
    clear = np.flatnonzero(~site.keep_out.holds(places) & is_known) if len(away_m) else np.zeros(0)
    return float(away_m[int(clear[0])]) if len(clear) else None


def _plan(
    site: InspectionSite, surface: ProofSurface, unordered: Poses, focal_mm: float, bound: int, speeds: ViewSpeeds,
    distance_m: FloatArray | None = None,
) -> ViewPlan:  # fmt: skip
    origin = np.zeros(2)
    least_m, _ = site.keep_out.band.limits_between(origin, origin)
    entry = np.array([0.0, 0.0, max(site.keep_out.top_at(origin) + ENTRY_ABOVE_M, least_m)])
    flight = view_flight(unordered, site.keep_out, entry, entry)
    order = flight.photo[flight.photo != NO_PHOTO]
    poses = unordered.only(order)
    renumbered = np.full(len(flight), NO_PHOTO)
    renumbered[flight.photo != NO_PHOTO] = np.arange(len(order))
    lens = surface.lens(focal_mm)
    coverage = surface.coverage(poses, lens)
    return ViewPlan(
        poses, _distance_m(poses, surface.caster) if distance_m is None else distance_m[order], lens,
        ViewFlight(flight.position, renumbered), coverage, by_component(surface.solid, coverage), bound,
        _seconds(flight.position, len(poses), speeds),
    )  # fmt: skip


def _distance_m(poses: Poses, caster: RayCaster) -> FloatArray:
    """To what each photo shows in its middle; as far as the asset's middle where that is none of it."""
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
