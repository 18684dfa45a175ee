"""Photos of every part of an asset at an asked ground sample distance, from outside the clearance."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.spatial.distance import cdist

from planning.views.camera import Camera, Lens, standoff_m
from planning.views.cover import fewest_photos
from planning.views.keep_out import KeepOut
from planning.views.limits import DetailRules, Limits, limits_of
from planning.views.proof import REACH_M, reach_m
from planning.views.site import InspectionSite
from planning.views.solids import Component, FloatArray, IntArray, Patches, patches_of
from planning.views.visibility import FRAME_MARGIN, Poses, RayCaster, aim_at, in_frame, line_of_sight, photos_show

BoolArray = NDArray[np.bool_]

AZIMUTH_STEP_DEG = 15.0
OUT_ABOVE_M = (0.0, 6.0, 12.0, 20.0)  # of candidate positions above the keep-out: how far from the axis
# Of assets with several anchors, whose candidate positions come close to one another.
ROW_AZIMUTH_STEP_DEG, ROW_OUT_ABOVE_M = 30.0, (0.0, 6.0, 15.0)
ROW_CUBE_M, CUBE_GROWTH, MAX_POSITIONS = 2.0, 1.3, 3_000  # one position in each cube, and at most so many in all
MIN_PATCH_M, MAX_PATCH_M, PATCHES_HIGH = 1.0, 2.5, 16  # sides of patches, by the height of the asset
MAX_PATCHES = 3_000  # about: of larger surfaces patches are larger
SIDE2_PER_AREA = 4.0  # of a patch: the square of its side, divided by its area
BEYOND_M = 0.5  # of the keep-out, for candidate positions
ABOVE_M = (0.5, 6.0)  # the top of the keep-out
DISTANCE_SHARES = (0.0, 0.35, 0.75)  # of the way from the keep-out to the farthest place
MIN_COSINE = 0.2  # of a pitch, by which steps of yaw are widened
CUBES_M = (1.5, 0.5)  # sides of cubes with one place each, of those from where patches can be seen that no candidate sees
MAX_PHOTOS, MAX_CANDIDATES = 200, 15_000
SEED = 33  # of the order in which positions are looked at, where there are too many for all
MIN_REACHABLE_SHARE = 0.1  # of a surface that can be shown: below, it is looked at on smaller patches
MIN_SHOWN_SHARE = 0.2  # of what the photo shows that shows the most: below, a photo is weighed only where it alone shows a patch
LEVELS, MIN_LEVELS_M, MAX_ABOVE_M = 12, 3.0, 20.0  # of candidate positions: how many, how far apart at least, how far above the asset
MIN_LENS_SHARE = 0.99  # of what the longest focal length reaches, for a shorter one to do


class TooManyPhotos(ValueError):
    """More than MAX_PHOTOS would be needed."""


@dataclass(frozen=True, eq=False)
class DetailViews:
    """Poses of photos, the lens they are taken with, what they show (photos, patches), and why other patches cannot be shown.

    bound: no choice shows enough with fewer photos, among the candidates that were weighed (see _weighed).
    """

    poses: Poses
    lens: Lens
    patches: Patches
    shows: BoolArray
    limits: Limits
    bound: int
    candidates: int = field(default=0)


def detail_views(site: InspectionSite, camera: Camera, rules: DetailRules) -> DetailViews:
    """Return the fewest photos found that show the site's asset.

    Raises TooManyPhotos where the surface is too large for the picture at this ground sample distance, or too much of it hides.
    """
    solid, keep_out = site.solid, site.keep_out
    caster = RayCaster([solid, *site.occluders])
    farthest_m = reach_m(camera, rules.asked_gsd_m)
    least_m = max(MIN_PATCH_M, math.sqrt(SIDE2_PER_AREA * solid.area_m2 / MAX_PATCHES))
    for patch_m in (float(np.clip(float(solid.box[1][2]) / PATCHES_HIGH, least_m, max(MAX_PATCH_M, least_m))), least_m):
        patches = patches_of(solid, patch_m)
        limits = limits_of(patches, keep_out, caster, camera, farthest_m)
        reachable_m2 = float(patches.area_m2[limits.limit == 0].sum())
        if reachable_m2 >= MIN_REACHABLE_SHARE * float(patches.area_m2.sum()):
            break
    if reachable_m2 > MAX_PHOTOS * camera.pixels_wide * camera.pixels_high * rules.asked_gsd_m**2:
        raise TooManyPhotos
    positions = candidate_positions(site, farthest_m)
    sight = line_of_sight(positions, patches, caster, farthest_m)
    for cube_m in CUBES_M:
        more = _further_positions(limits, np.asarray(~sight.any(axis=0)), cube_m)
        positions = np.concatenate([positions, more])
        sight = np.concatenate([sight, line_of_sight(more, patches, caster, farthest_m)])
    sight &= _pitch_reached(positions, patches, camera)
    lens = _lens(camera, rules, positions, patches, sight)
    photos, shows = _photos(positions, patches, sight, camera, lens)
    if not len(photos):
        return DetailViews(photos, lens, patches, shows, limits, 0)
    kind = np.array([list(Component).index(kind) for kind, _ in solid.components])[patches.component]
    cover = fewest_photos(shows, patches.area_m2, kind, rules.share)
    chosen = cover.chosen
    if len(site.anchors) > 1:
        chosen = np.union1d(chosen, _between_patches(photos, chosen, patches_of(solid, MIN_PATCH_M), caster, camera, lens, rules.share))
    if len(chosen) > MAX_PHOTOS:
        raise TooManyPhotos
    return DetailViews(photos.only(chosen), lens, patches, shows[chosen], limits, cover.bound, len(photos))


def candidate_positions(site: InspectionSite, farthest_m: float) -> FloatArray:
    """Places around the asset and above it, outside the keep-out and within the heights; (n, 3) [m]."""
    if len(site.anchors) == 1:
        return _around(site, site.anchors[0], farthest_m, AZIMUTH_STEP_DEG, OUT_ABOVE_M)
    found = [_around(site, anchor, farthest_m, ROW_AZIMUTH_STEP_DEG, ROW_OUT_ABOVE_M) for anchor in site.anchors]
    positions = np.concatenate(found)
    cube_m = ROW_CUBE_M
    while True:
        _, first = np.unique(np.floor(positions / cube_m), axis=0, return_index=True)
        if len(first) <= MAX_POSITIONS:
            return positions[np.sort(first)]
        cube_m *= CUBE_GROWTH


def _around(
    site: InspectionSite, anchor: FloatArray, farthest_m: float, step_deg: float, out_above_m: Sequence[float]
) -> FloatArray:  # fmt: skip
    """Candidate positions around a place (2,) of the asset."""
    keep_out, (_, high) = site.keep_out, site.solid.box
    lowest_m, limit_m = keep_out.band.limits_between(anchor, anchor)
    lowest_m = min(lowest_m, float(keep_out.band.low_m.min()))
    top_m = max(keep_out.top_at(anchor), float(high[2]))
    highest_m = min(float(high[2]) + min(0.7 * farthest_m, MAX_ABOVE_M), limit_m)
    count = max(math.ceil((highest_m - lowest_m) / max(MIN_LEVELS_M, highest_m / LEVELS)), 1)
    levels_m = np.linspace(lowest_m, max(highest_m, lowest_m), count + 1)
    beside_m = farthest_m + (float(np.abs(high[:2]).max()) if len(site.anchors) == 1 else 0.0)
    found = []
    for azimuth in np.arange(0.0, 360.0, step_deg):
        direction = np.array([math.sin(math.radians(azimuth)), math.cos(math.radians(azimuth))])
        for level_m in levels_m.tolist():
            near_m = _first_outside_m(anchor, direction, level_m, keep_out)
            if near_m is None or near_m > beside_m:
                continue
            shares = DISTANCE_SHARES if farthest_m > near_m else DISTANCE_SHARES[:1]
            found += [(*(anchor + direction * (near_m + share * (farthest_m - near_m))), level_m) for share in shares]
    for above_m in ABOVE_M:
        level_m = top_m + above_m
        for out_m in out_above_m:
            count = 1 if out_m == 0.0 else 12
            for turn in np.radians(np.arange(count) * 360.0 / count).tolist():
                found.append((anchor[0] + out_m * math.sin(turn), anchor[1] + out_m * math.cos(turn), level_m))
    positions = np.array(found).reshape(-1, 3)
    return positions[~keep_out.holds(positions)] if len(positions) else positions


def _between_patches(
    photos: Poses, chosen: IntArray, fine: Patches, caster: RayCaster, camera: Camera, lens: Lens, share: float
) -> IntArray:  # fmt: skip
    """Return further photos for what the chosen ones leave out of finer patches, of which photos show less than of large ones."""
    left = np.flatnonzero(~photos_show(photos.only(chosen), fine, caster, camera, lens, FRAME_MARGIN).any(axis=0))
    rest = fine.only(left)
    shows = photos_show(photos, rest, caster, camera, lens, FRAME_MARGIN)
    can_m2 = float(rest.area_m2[shows.any(axis=0)].sum())
    shown_m2 = float(fine.area_m2.sum() - rest.area_m2.sum())
    needed_m2 = share * (shown_m2 + can_m2) - shown_m2
    if needed_m2 <= 0.0 or can_m2 == 0.0:
        return np.zeros(0, dtype=np.int64)
    return fewest_photos(shows, rest.area_m2, np.zeros(len(rest), dtype=np.int64), needed_m2 / can_m2).chosen


def _further_positions(limits: Limits, missing: BoolArray, cube_m: float) -> FloatArray:
    """Places from where patches can be photographed that no candidate sees, one in each cube."""
    places = limits.place[missing[limits.patch]]
    _, first = np.unique(np.floor(places / cube_m), axis=0, return_index=True)
    return places[first]


def _first_outside_m(anchor: FloatArray, direction: FloatArray, level_m: float, keep_out: KeepOut) -> float | None:
    """How far out from a place, in a direction, the last column of the keep-out ends at a level; None where none ends near enough."""
    out_m = np.arange(0.0, REACH_M, 0.5)
    points = np.column_stack([anchor + out_m[:, None] * direction, np.full(len(out_m), level_m)])
    inside = np.flatnonzero(keep_out.in_column(points))
    if not len(inside):
        return BEYOND_M
    last = int(inside[-1])
    return None if last == len(out_m) - 1 else float(out_m[last]) + 0.5 + BEYOND_M


def _pitch_reached(positions: FloatArray, patches: Patches, camera: Camera) -> BoolArray:
    """Whether the gimbal looks at each patch from each position, (positions, patches), give or take a third of the picture's height."""
    reached = np.zeros((len(positions), len(patches)), dtype=bool)
    spare_deg = math.degrees(math.atan(camera.sensor_height_mm / (6.0 * camera.focal_lengths_mm[0])))
    for number, position in enumerate(positions):
        _, pitch = aim_at(position, patches.centre)
        gimbal = camera.gimbal
        reached[number] = (pitch >= gimbal.pitch_min_deg - spare_deg) & (pitch <= gimbal.pitch_max_deg + spare_deg)
    return reached


def _lens(camera: Camera, rules: DetailRules, positions: FloatArray, patches: Patches, sight: BoolArray) -> Lens:
    """The shortest focal length that reaches nearly all that the longest does: its pictures are the widest."""
    distance_m = cdist(positions, patches.centre)
    nearest_m = camera.nearest_focus_m

    def seen_m2(focal_mm: float) -> float:
        within = (distance_m <= standoff_m(camera, rules.asked_gsd_m, focal_mm)) & (distance_m >= nearest_m)
        return float(patches.area_m2[(sight & within).any(axis=0)].sum())

    longest_mm = camera.focal_lengths_mm[-1]
    most_m2 = seen_m2(longest_mm)
    enough = (own for own in camera.focal_lengths_mm if most_m2 > 0.0 and seen_m2(own) >= MIN_LENS_SHARE * most_m2)
    focal_mm = next(enough, longest_mm)
    return Lens(focal_mm, nearest_m, standoff_m(camera, rules.asked_gsd_m, focal_mm))


def _photos(positions: FloatArray, patches: Patches, sight: BoolArray, camera: Camera, lens: Lens) -> tuple[Poses, BoolArray]:
    """Aims from positions at what is seen from there, half a picture apart, and what each photo shows; about MAX_CANDIDATES at most."""
    step_yaw = math.degrees(math.atan(camera.sensor_width_mm / (2.0 * lens.focal_mm)))
    step_pitch = math.degrees(math.atan(camera.sensor_height_mm / (2.0 * lens.focal_mm)))
    places: list[int] = []
    yaws: list[FloatArray] = []
    pitches: list[FloatArray] = []
    rows: list[BoolArray] = []
    for number in np.random.default_rng(SEED).permutation(len(positions)).tolist():
        position, seen = positions[number], np.flatnonzero(sight[number])
        if not len(seen):
            continue
        if len(places) > MAX_CANDIDATES:
            break
        yaw, pitch = aim_at(position, patches.centre[seen])
        middle = float(np.degrees(np.arctan2(np.sin(np.radians(yaw)).mean(), np.cos(np.radians(yaw)).mean())))
        turned = (yaw - middle + 180.0) % 360.0 - 180.0
        cells = np.unique(np.round(np.column_stack([turned * np.cos(np.radians(pitch)) / step_yaw, pitch / step_pitch])), axis=0)
        own_pitch = np.clip(cells[:, 1] * step_pitch, camera.gimbal.pitch_min_deg, camera.gimbal.pitch_max_deg)
        own_yaw = (middle + cells[:, 0] * step_yaw / np.maximum(np.cos(np.radians(own_pitch)), MIN_COSINE)) % 360.0
        shown = in_frame(position, own_yaw, own_pitch, patches.centre[seen], camera, lens)
        some = shown.any(axis=1)
        whole = np.zeros((int(some.sum()), len(patches)), dtype=bool)
        whole[:, seen] = shown[some]
        places += [number] * len(whole)
        yaws.append(own_yaw[some])
        pitches.append(own_pitch[some])
        rows.append(whole)
    if not places:
        return Poses(positions[:0], np.zeros(0), np.zeros(0)), np.zeros((0, len(patches)), dtype=bool)
    shows = np.concatenate(rows)
    kept = _weighed(shows, patches.area_m2)
    poses = Poses(positions[places], np.concatenate(yaws), np.concatenate(pitches))
    return poses.only(kept), shows[kept]


def _weighed(shows: BoolArray, area_m2: FloatArray) -> BoolArray:
    """Photos that show much, and for patches that none of them shows the one that shows the most."""
    shown_m2 = np.asarray(csr_array(shows) @ area_m2)
    kept: BoolArray = shown_m2 >= MIN_SHOWN_SHARE * shown_m2.max()
    order = np.argsort(-shown_m2, kind="stable")
    for patch in np.flatnonzero(~shows[kept].any(axis=0) & shows.any(axis=0)).tolist():
        kept[order[shows[order, patch].argmax()]] = True
    return kept
