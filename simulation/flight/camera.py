"""Photos on request, at time intervals or at distances, and the pose of the lens."""

import math
from collections import deque
from dataclasses import dataclass

from inspection.geodesy import LonLat
from planning.views.camera import Camera
from simulation.flight.orders import TakePhotos

SIMULATED_CAMERA = Camera(
    name="Simulated camera",
    sensor_width_mm=13.2,
    sensor_height_mm=8.8,
    pixels_wide=5_472,
    pixels_high=3_648,
    focal_lengths_mm=(8.8,),
    min_interval_s=0.5,
)  # 20 megapixels on one inch
MAX_WAITING = 100  # photos within the camera's shortest interval; later ones are not taken


@dataclass(frozen=True, slots=True)
class LensPose:
    """The true place of the lens, and where it looks: yaw from true north, pitch from the horizon (negative down), roll right side down."""

    position: LonLat
    altitude_amsl_m: float
    altitude_relative_m: float
    yaw_deg: float
    pitch_deg: float
    roll_deg: float = 0.0


@dataclass(frozen=True, slots=True)
class Shot:
    """A photo to take: the mission item that asks for it, and the sequence number of the request; None without."""

    item: int | None = None
    sequence: int | None = None


class CameraShutter:
    """The shutter of one camera; `number` counts the photos since the start.

    A single photo that is asked for again with the same sequence number is taken once: the request was repeated on its way (MAVLink,
    IMAGE_START_CAPTURE). Photos within the camera's shortest interval are taken later, as ArduPilot does.
    """

    def __init__(self, min_interval_s: float) -> None:
        self.number = 0
        self._min_interval_s = min_interval_s
        self._order: TakePhotos | None = None
        self._shot = Shot()
        self._left = 0
        self._due_s = 0.0
        self._due_m = 0.0
        self._waiting: deque[Shot] = deque()
        self._ready_s = -math.inf
        self._last_sequence: int | None = None

    def start(self, order: TakePhotos, now_s: float, flown_m: float, item: int | None = None) -> None:
        shot = Shot(item, order.sequence)
        if order.count == 1 and order.distance_m <= 0.0:
            is_repeated = order.sequence is not None and order.sequence == self._last_sequence
            if not is_repeated and len(self._waiting) < MAX_WAITING:
                self._waiting.append(shot)
            self._last_sequence = order.sequence if order.sequence is not None else self._last_sequence
            return
        self._order, self._left, self._shot = order, order.count, shot
        self._due_s, self._due_m = now_s, flown_m + order.distance_m

    def stop(self) -> None:
        self._order = None
        self._waiting.clear()

    def reset(self) -> None:
        """Begin a flight: sequence numbers may be used again."""
        self.stop()
        self._last_sequence = None

    def due(self, now_s: float, flown_m: float) -> Shot | None:
        """Return the photo that is taken now, and count it."""
        self._note_due(now_s, flown_m)
        if not self._waiting or now_s + 1e-6 < self._ready_s:
            return None
        self._ready_s = now_s + self._min_interval_s
        self.number += 1
        return self._waiting.popleft()

    def _note_due(self, now_s: float, flown_m: float) -> None:
        order = self._order
        if order is None or self._waiting:
            return
        if order.distance_m > 0.0:
            if flown_m < self._due_m:
                return
            self._due_m += order.distance_m
        else:
            if now_s + 1e-6 < self._due_s:
                return
            self._due_s = now_s if order.interval_s <= 0.0 else self._due_s + order.interval_s
            self._left -= 1
            if self._left == 0 or (order.interval_s <= 0.0 and order.count == 0):
                self._order = None
        self._waiting.append(self._shot)


def lens_offset_m(
    offset_m: tuple[float, float, float], roll_rad: float, pitch_rad: float, heading_rad: float
) -> tuple[float, float, float]:
    """Return the offset of a lens from the antenna to east, north and up; offset_m: forward, right and up of the UAV's body."""
    forward, right, down = offset_m[0], offset_m[1], -offset_m[2]
    (sr, cr), (sp, cp), (sy, cy) = ((math.sin(angle), math.cos(angle)) for angle in (roll_rad, pitch_rad, heading_rad))
    north = cp * cy * forward + (sr * sp * cy - cr * sy) * right + (cr * sp * cy + sr * sy) * down
    east = cp * sy * forward + (sr * sp * sy + cr * cy) * right + (cr * sp * sy - sr * cy) * down
    return east, north, -(-sp * forward + sr * cp * right + cr * cp * down)
