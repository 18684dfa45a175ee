"""What photos of an asset prove, from the poses that they were planned or taken at.

The camera counts as level: gimbals keep the horizon. A photo that states more roll than MAX_ROLL_DEG, whose picture is turned by more than
its margin, is not counted. No camera reports its focal length reliably: photos count with the planned one.
"""

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from inspection.geodesy.local_frame import LocalFrame
from planning.views.camera import Camera, Lens, standoff_m
from planning.views.coverage import ComponentCoverage, Coverage, by_component, coverage_of
from planning.views.limits import ViewSampling, limits_of
from planning.views.site import InspectionSite
from planning.views.solids import IntArray, Patches, Solid, patches_of
from planning.views.visibility import Poses, RayCaster

MIN_PITCH_DEG = -80.0
REACH_M = 80.0  # from the asset's axis, of candidate positions
PROOF_PATCH_M, PROOF_PATCHES = 1.0, 20_000  # sides of the patches on which coverage is measured; larger ones of more surface
MAX_AWAY_M = 2.0 * REACH_M  # from the asset: beyond, a photo is of something else, or its position is wrong
WIRE_SAMPLING = ViewSampling((0.0, 30.0, 58.0), 8, (0.4, 0.7, 0.999))  # of which there is much that looks the same
MAX_ROLL_DEG = 3.0  # turns the edge of a picture by as much as the margin within which photos are planned
MAX_AMSL_M = 10_000.0


class NotCounted(StrEnum):
    """Why a photo is not counted, the first that holds."""

    FAILED = "failed"  # the camera reported a failure
    POSITION = "position"  # unknown
    HEIGHT = "height"  # its reference is unknown
    ATTITUDE = "attitude"  # where the camera looked is unknown
    TILTED = "tilted"  # more than MAX_ROLL_DEG
    FAR = "far"  # from the asset, more than MAX_AWAY_M or half of its longest span


@dataclass(frozen=True, slots=True)
class TakenPhoto:
    """Pose of a lens; None is unknown. Angles as in Poses, roll right side down."""

    lon: float | None
    lat: float | None
    amsl_m: float | None
    yaw_deg: float | None
    pitch_deg: float | None
    roll_deg: float | None = None
    is_taken: bool = True


@dataclass(frozen=True, eq=False)
class Proof:
    """What the counted photos show. not_counted: numbers of the others by reason."""

    coverage: Coverage
    components: tuple[ComponentCoverage, ...]
    counted: int
    not_counted: Mapping[NotCounted, int]


@dataclass(frozen=True, eq=False)
class ProofSurface:
    """The surface of a site's asset or wires, cut into patches, with why no photo can show some of them (places in LIMITS).

    away_m: from its middle, up to where photos count.
    """

    solid: Solid
    camera: Camera
    gsd_m: float
    patches: Patches
    caster: RayCaster
    limit: IntArray
    away_m: float = MAX_AWAY_M

    def coverage(self, poses: Poses, lens: Lens) -> Coverage:
        return coverage_of(poses, lens, self.camera, self.patches, self.caster, self.limit)

    def proof(self, photos: Sequence[TakenPhoto], focal_mm: float, frame: LocalFrame, base_amsl_m: float | None) -> Proof:
        """Return what photos at this focal length show. base_amsl_m: of the asset's foot; without one no height is known over it."""
        poses, not_counted = _counted(photos, frame, base_amsl_m, self.away_m)
        coverage = self.coverage(poses, self.lens(focal_mm))
        return Proof(coverage, by_component(self.solid, coverage), len(poses), not_counted)

    def lens(self, focal_mm: float) -> Lens:
        return Lens(focal_mm, self.camera.nearest_focus_m, standoff_m(self.camera, self.gsd_m, focal_mm))


def flown_camera(camera: Camera) -> Camera:
    """Return the camera with the pitches that photos are planned with: none looks steeper down than MIN_PITCH_DEG."""
    pitch_min_deg = min(max(camera.gimbal.pitch_min_deg, MIN_PITCH_DEG), camera.gimbal.pitch_max_deg)
    return replace(camera, gimbal=replace(camera.gimbal, pitch_min_deg=pitch_min_deg))


def reach_m(camera: Camera, asked_gsd_m: float) -> float:
    """The distance [m] up to which places are looked at: where the longest focal length reaches the GSD, at most REACH_M."""
    return min(standoff_m(camera, asked_gsd_m, camera.focal_lengths_mm[-1]), REACH_M)


def proof_surface(site: InspectionSite, camera: Camera, asked_gsd_m: float, wires: Solid | None = None) -> ProofSurface:
    """Return the surface on which photos with this camera are proven: of the asset, or a tower's wires. camera: as flown_camera has it."""
    solid = site.solid if wires is None else wires
    patch_m = max(PROOF_PATCH_M, math.sqrt(2.0 * solid.area_m2 / PROOF_PATCHES)) if wires is None else PROOF_PATCH_M
    patches, caster = patches_of(solid, patch_m), RayCaster([site.solid, *site.occluders])
    sampling = ViewSampling() if wires is None else WIRE_SAMPLING
    limits = limits_of(patches, site.keep_out, caster, camera, reach_m(camera, asked_gsd_m), sampling)
    away_m = site.reach_m + MAX_AWAY_M if wires is None else max(MAX_AWAY_M, site.around_m)
    return ProofSurface(solid, camera, asked_gsd_m, patches, caster, limits.limit, away_m)


def why_not_counted(photo: TakenPhoto) -> NotCounted | None:
    """Return why a photo counts for no asset; None where it may. Values that cannot be are unknown."""
    if not photo.is_taken:
        return NotCounted.FAILED
    if not (_is_within(photo.lon, 180.0) and _is_within(photo.lat, 90.0)):
        return NotCounted.POSITION
    if not _is_within(photo.amsl_m, MAX_AMSL_M):
        return NotCounted.HEIGHT
    if not (_is_within(photo.yaw_deg, 720.0) and _is_within(photo.pitch_deg, 90.0)):
        return NotCounted.ATTITUDE
    roll_deg = 0.0 if photo.roll_deg is None else photo.roll_deg
    return None if _is_within(roll_deg, MAX_ROLL_DEG) else NotCounted.TILTED


def _counted(
    photos: Sequence[TakenPhoto], frame: LocalFrame, base_amsl_m: float | None, away_m: float
) -> tuple[Poses, dict[NotCounted, int]]:  # fmt: skip
    """Return the poses of the photos that count, in the frame around the asset's foot, and the numbers of the others."""
    reasons: Counter[NotCounted] = Counter()
    rows = []
    for photo in photos:
        reason = why_not_counted(photo)
        if reason is None and base_amsl_m is None:
            reason = NotCounted.HEIGHT
        if reason is None:
            rows.append((photo.lon, photo.lat, photo.amsl_m, photo.yaw_deg, photo.pitch_deg))
        else:
            reasons[reason] += 1
    values = np.array(rows, dtype=np.float64).reshape(-1, 5)
    position = np.column_stack([frame.to_metres(values[:, :2]), values[:, 2] - (base_amsl_m or 0.0)])
    is_near = np.linalg.norm(position, axis=1) <= away_m
    if not is_near.all():
        reasons[NotCounted.FAR] += int((~is_near).sum())
    return Poses(position[is_near], values[is_near, 3], values[is_near, 4]), dict(reasons)


def _is_within(value: float | None, most: float) -> bool:
    """Whether the value is a number of at most this size."""
    return value is not None and -most <= value <= most
