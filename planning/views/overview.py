"""Photos of a whole tower from four sides: obliquely from above where heights allow it, between the directions of its line."""

import math

import numpy as np

from planning.views.camera import Camera
from planning.views.keep_out import KeepOut
from planning.views.site import TowerSite
from planning.views.solids import FloatArray
from planning.views.visibility import Poses, axes_of

SIDES_DEG = (45.0, 135.0, 225.0, 315.0)  # where the UAV is, from the line's bearing
TURNS_DEG = (0.0, 10.0, -10.0, 20.0, -20.0, 30.0, -30.0)  # by which it is moved to a side where something stands
PITCHES_DEG = (-30.0, -20.0, -10.0, 0.0, 10.0)  # the first that heights allow
FILLED = 0.9  # of the picture's width or height at most, by the tower
STEP_M = 1.0  # farther away, until nothing stands there
MAX_AWAY_M = 120.0  # from the tower: wires and supports are known up to SITE_M, and reach so much less far by clearance and swing
NEARLY = 1.25  # as far as the nearest of all: as good


def overview_poses(site: TowerSite, camera: Camera) -> Poses:
    """Return up to four poses, each of which has the whole tower in its picture at the shortest focal length.

    A side from which that is not possible within MAX_AWAY_M is left out.
    """
    found = [pose for side in SIDES_DEG if (pose := _pose(site, camera, site.tower.bearing_deg + side)) is not None]
    values = np.array(found).reshape(-1, 5)
    return Poses(values[:, :3], values[:, 3], values[:, 4])


def _pose(site: TowerSite, camera: Camera, azimuth_deg: float) -> tuple[float, ...] | None:
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
            away_m = _clear_m(middle, forward, least_m, site.keep_out)
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


def _clear_m(middle: FloatArray, forward: FloatArray, least_m: float, keep_out: KeepOut) -> float | None:
    """The least distance [m] from the middle, from which an axis looks, that is out of the keep-out; None within MAX_AWAY_M."""
    level = math.hypot(float(forward[0]), float(forward[1]))
    away_m = np.arange(least_m, MAX_AWAY_M / level, STEP_M)
    clear = np.flatnonzero(~keep_out.holds(middle - away_m[:, None] * forward)) if len(away_m) else np.zeros(0)
    return float(away_m[int(clear[0])]) if len(clear) else None
