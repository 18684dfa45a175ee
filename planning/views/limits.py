"""Which patches of a surface a camera can photograph at all, from where, and why it cannot photograph the others."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from planning.views.camera import Camera
from planning.views.keep_out import KeepOut
from planning.views.solids import FloatArray, IntArray, Patches
from planning.views.visibility import MAX_ANGLE_DEG, OFF_SURFACE_M, RayCaster

BESIDE_M = 1.0  # what stands nearer hides a patch


class Limit(StrEnum):
    """Why no photo can show a patch, from what is missing the least to what is missing the most."""

    NONE = ""
    DISTANCE = "distance"  # too coarse, or not sharp, from outside the keep-out
    GIMBAL = "gimbal"  # only with a pitch that the gimbal does not reach
    HEIGHT = "height"  # only from below the least height above ground, or from above the greatest
    HIDDEN = "hidden"  # by the asset itself


NONE, DISTANCE, GIMBAL, HEIGHT, HIDDEN = range(len(Limit))
LIMITS = tuple(Limit)


@dataclass(frozen=True)
class ViewSampling:
    """The viewpoints that are tried for a patch, to learn whether it can be seen.

    rings_deg: from its normal; around: directions in each ring; shares: of the farthest distance.
    """

    rings_deg: tuple[float, ...] = (0.0, 15.0, 30.0, 45.0, 58.0)
    around: int = 12
    shares: tuple[float, ...] = (0.1, 0.25, 0.45, 0.65, 0.85, 0.999)


@dataclass(frozen=True)
class DetailRules:
    """asked_gsd_m: what a pixel may show at most. share: of the area that can be photographed, of each kind of component."""

    asked_gsd_m: float
    share: float = 0.97


@dataclass(frozen=True, eq=False)
class Limits:
    """limit (p,): of each patch its place in LIMITS, 0 where it can be photographed. place (k, 3) from where [m], of patch (k,)."""

    limit: IntArray
    place: FloatArray
    patch: IntArray


def limits_of(
    patches: Patches, keep_out: KeepOut, caster: RayCaster, camera: Camera, farthest_m: float, sampling: ViewSampling = ViewSampling()
) -> Limits:
    """Return why each patch cannot be photographed, and places from where it can.

    Looks back from the patch in directions within the greatest angle, at distances up to the farthest.
    """
    directions = _directions(patches.normal, sampling)
    start = patches.centre + OFF_SURFACE_M * patches.normal
    pitch_min, pitch_max = camera.gimbal.pitch_min_deg, camera.gimbal.pitch_max_deg
    spare_deg = np.degrees(np.arctan(camera.sensor_height_mm / (2.0 * camera.focal_lengths_mm[-1])))
    limit = np.full(len(patches), HIDDEN, dtype=np.int64)
    places, of_patch = [np.zeros((0, 3))], [np.zeros(0, dtype=np.int64)]
    for direction in np.moveaxis(directions, 1, 0):
        open_ = limit > NONE
        free = np.zeros(len(patches), dtype=bool)
        free[open_] = caster.is_free(start[open_], start[open_] + direction[open_] * BESIDE_M)
        pitch = -np.degrees(np.arcsin(np.clip(direction[:, 2], -1.0, 1.0)))
        aimed = (pitch >= pitch_min - spare_deg) & (pitch <= pitch_max + spare_deg)
        for share in sampling.shares:
            if share * farthest_m < camera.nearest_focus_m:
                continue
            place = patches.centre + direction * share * farthest_m
            tall = ~keep_out.band.leaves_out(place)
            here = np.where(~tall, HEIGHT, np.where(~aimed, GIMBAL, DISTANCE))
            could = np.flatnonzero(free & tall & aimed & (limit > NONE))
            outside = could[~keep_out.in_column(place[could])]
            limit = np.where(free, np.minimum(limit, here), limit)
            seeing = outside[caster.is_free(start[outside], place[outside])]
            limit[seeing] = NONE
            places.append(place[seeing])
            of_patch.append(seeing)
    return Limits(limit, np.concatenate(places), np.concatenate(of_patch))


def _directions(normal: FloatArray, sampling: ViewSampling) -> FloatArray:
    """Unit vectors around each normal, (p, directions, 3)."""
    aside = np.where(np.abs(normal[:, 2:]) < 0.9, np.array([[0.0, 0.0, 1.0]]), np.array([[1.0, 0.0, 0.0]]))
    first = np.cross(normal, aside)
    first /= np.linalg.norm(first, axis=1)[:, None]
    second = np.cross(normal, first)
    rings = [normal]
    for ring_deg in sampling.rings_deg[1:]:
        assert ring_deg < MAX_ANGLE_DEG  # noqa: S101 - figures of this module
        for turn in 2.0 * np.pi * np.arange(sampling.around) / sampling.around:
            tilt = np.radians(ring_deg)
            rings.append(np.cos(tilt) * normal + np.sin(tilt) * (np.cos(turn) * first + np.sin(turn) * second))
    return np.stack(rings, axis=1)
