"""What photos show: rays to the patches of a surface, their angle, distance and place in the picture."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene
from numpy.typing import NDArray

from planning.views.camera import Camera, Lens
from planning.views.solids import FloatArray, IntArray, Patches, Solid

BoolArray = NDArray[np.bool_]

MAX_ANGLE_DEG = 60.0  # between the line of sight and a surface's normal: beyond, a surface is not counted as seen
FRAME_MARGIN = 0.05  # of half of the picture at each edge, for the errors of aim and position
NO_HIT_M = 1e30  # Embree's answer for a ray that meets nothing is larger
OFF_SURFACE_M = 0.005  # by which rays begin above it


@dataclass(frozen=True, eq=False)
class Poses:
    """Where a camera is and where it looks.

    position float64 (n, 3), x east, y north, z up [m]; yaw_deg (n,) from north, clockwise; pitch_deg (n,), 0 horizontal, -90 down.
    """

    position: FloatArray
    yaw_deg: FloatArray
    pitch_deg: FloatArray

    def __len__(self) -> int:
        return len(self.position)

    def only(self, places: IntArray | BoolArray) -> "Poses":
        return Poses(self.position[places], self.yaw_deg[places], self.pitch_deg[places])


class RayCaster:
    """Tells whether something stands between places and the patches of a surface."""

    def __init__(self, solids: Sequence[Solid]) -> None:
        self._scene = EmbreeScene()
        triangles = np.concatenate([solid.triangles for solid in solids])
        self._mesh = TriangleMesh(self._scene, triangles.astype(np.float32))

    def is_free(self, start: FloatArray, end: FloatArray) -> BoolArray:
        """Whether each straight line, (n, 3) each, meets nothing."""
        if not len(start):
            return np.zeros(0, dtype=bool)
        way = end - start
        length_m = np.linalg.norm(way, axis=1)
        met = self._scene.run(
            start.astype(np.float32), (way / length_m[:, None]).astype(np.float32), length_m.astype(np.float32), query="OCCLUDED"
        )
        free: BoolArray = np.asarray(met) != 0
        return free

    def distance_m(self, start: FloatArray, direction: FloatArray) -> FloatArray:
        """How far each ray, (n, 3) each, goes until it meets something [m]; inf where it meets nothing."""
        if not len(start):
            return np.zeros(0)
        away_m = np.asarray(self._scene.run(start.astype(np.float32), direction.astype(np.float32), query="DISTANCE"), dtype=np.float64)
        return np.where(away_m < NO_HIT_M, away_m, np.inf)


def line_of_sight(positions: FloatArray, patches: Patches, caster: RayCaster, farthest_m: float) -> BoolArray:
    """Whether each patch is seen from each position within the angle, (positions, patches)."""
    seen = np.zeros((len(positions), len(patches)), dtype=bool)
    least_cosine = np.cos(np.radians(MAX_ANGLE_DEG))
    start = patches.centre + OFF_SURFACE_M * patches.normal
    for number, place in enumerate(positions):
        away = place - patches.centre
        distance_m = np.sqrt(np.einsum("pi,pi->p", away, away))
        near = np.flatnonzero((np.einsum("pi,pi->p", away, patches.normal) >= least_cosine * distance_m) & (distance_m <= farthest_m))
        seen[number, near] = caster.is_free(start[near], np.broadcast_to(place, (len(near), 3)))
    return seen


def axes_of(yaw_deg: FloatArray, pitch_deg: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Unit vectors (n, 3) to the right of pictures, up in them, and along the optical axis."""
    yaw, pitch = np.radians(yaw_deg), np.radians(pitch_deg)
    zero = np.zeros_like(yaw)
    right = np.column_stack([np.cos(yaw), -np.sin(yaw), zero])
    forward = np.column_stack([np.sin(yaw) * np.cos(pitch), np.cos(yaw) * np.cos(pitch), np.sin(pitch)])
    return right, np.cross(right, forward), forward


def in_frame(
    position: FloatArray, yaw_deg: FloatArray, pitch_deg: FloatArray, points: FloatArray, camera: Camera, lens: Lens,
    margin: float = FRAME_MARGIN,
) -> BoolArray:  # fmt: skip
    """Which points (p, 3) photos from one position in several directions (n,) show within their margins, (n, p).

    That is sharp, and as fine as the lens is used for.
    """
    right, up, forward = axes_of(yaw_deg, pitch_deg)
    away = points - position
    depth_m = forward @ away.T
    half_wide = camera.sensor_width_mm / (2.0 * lens.focal_mm) * (1.0 - margin)
    half_high = camera.sensor_height_mm / (2.0 * lens.focal_mm) * (1.0 - margin)
    shown: BoolArray = (
        (depth_m >= max(lens.nearest_m, 1e-6)) & (depth_m <= lens.farthest_m)
        & (np.abs(right @ away.T) <= half_wide * depth_m) & (np.abs(up @ away.T) <= half_high * depth_m)
    )  # fmt: skip
    return shown


def photos_show(poses: Poses, patches: Patches, caster: RayCaster, camera: Camera, lens: Lens, margin: float = 0.0) -> BoolArray:
    """Whether each photo shows each patch, (poses, patches): in its frame, fine enough, within the angle, nothing between."""
    shown = np.zeros((len(poses), len(patches)), dtype=bool)
    farthest_m = lens.farthest_m / np.cos(np.arctan(np.hypot(camera.sensor_width_mm, camera.sensor_height_mm) / (2.0 * lens.focal_mm)))
    sight = line_of_sight(poses.position, patches, caster, float(farthest_m))
    for number in range(len(poses)):
        seen = np.flatnonzero(sight[number])
        own = slice(number, number + 1)
        shown[number, seen] = in_frame(
            poses.position[number], poses.yaw_deg[own], poses.pitch_deg[own], patches.centre[seen], camera, lens, margin
        )[0]
    return shown


def aim_at(position: FloatArray, points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Yaw and pitch [deg] from a position to points, (n, 3)."""
    away = points - position
    yaw = np.degrees(np.arctan2(away[:, 0], away[:, 1])) % 360.0
    return yaw, np.degrees(np.arctan2(away[:, 2], np.hypot(away[:, 0], away[:, 1])))
