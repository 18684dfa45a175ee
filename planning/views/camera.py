"""Cameras and gimbals: what a photo shows from a distance, and how far away a UAV may be for it.

Formulas of the pinhole camera: K. Kraus, Photogrammetry, 2nd edition, chapter 1; the same as in mission planners for surveys.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from operation.reasons import Reason

DOWN_DEG = -90.0
MIN_VIEW_DEG, MAX_VIEW_DEG = 0.5, 150.0  # of a picture's sides
MAX_SQUARE_ERROR = 0.1  # between a pixel's width and height: above that a figure is wrong


class InvalidCamera(ValueError):
    """A figure of a camera that cannot be; faults by its name."""

    def __init__(self, faults: dict[str, Reason]) -> None:
        super().__init__(", ".join(faults))
        self.faults = faults


@dataclass(frozen=True)
class Gimbal:
    """The range of angles [deg] that can be commanded: pitch 0 is the horizon and -90 straight down; yaw is relative to the airframe.

    Without a range of yaw (None) the camera looks where the UAV's nose points, and the UAV turns for a photo.
    """

    pitch_min_deg: float = DOWN_DEG
    pitch_max_deg: float = 0.0
    yaw_min_deg: float | None = None
    yaw_max_deg: float | None = None


@dataclass(frozen=True)
class Camera:
    """A camera body with one lens. offset_m: of its lens from the UAV's antenna: forward, right and up [m].

    focal_lengths_mm: real focal lengths, ascending; one for a fixed lens, the steps of a zoom otherwise. min_interval_s: between photos.
    """

    name: str
    sensor_width_mm: float
    sensor_height_mm: float
    pixels_wide: int
    pixels_high: int
    focal_lengths_mm: tuple[float, ...]
    min_interval_s: float = 2.0
    nearest_focus_m: float = 1.0
    shutter_s: float = 1.0 / 1000.0
    gimbal: Gimbal = Gimbal()
    offset_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    is_thermal: bool = False

    def __post_init__(self) -> None:
        faults = {
            field: Reason("camera_not_positive")
            for field in ("sensor_width_mm", "sensor_height_mm", "pixels_wide", "pixels_high", "min_interval_s", "shutter_s")
            if not (math.isfinite(getattr(self, field)) and getattr(self, field) > 0)
        }
        steps = self.focal_lengths_mm
        if not steps or not all(math.isfinite(step) and step > 0 for step in steps) or list(steps) != sorted(set(steps)):
            faults["focal_lengths_mm"] = Reason("camera_focal_lengths")
        if not (math.isfinite(self.nearest_focus_m) and self.nearest_focus_m >= 0):
            faults["nearest_focus_m"] = Reason("camera_not_positive")
        if not -180.0 <= self.gimbal.pitch_min_deg <= self.gimbal.pitch_max_deg <= 180.0:
            faults["gimbal"] = Reason("camera_gimbal")
        if not all(map(math.isfinite, self.offset_m)):
            faults["offset_m"] = Reason("camera_offset")
        if not faults and abs(self.pixel_width_mm / self.pixel_height_mm - 1.0) > MAX_SQUARE_ERROR:
            faults["pixels_high"] = Reason("camera_pixels_not_square")
        if not faults and not all(MIN_VIEW_DEG <= own <= MAX_VIEW_DEG for step in steps for own in field_of_view_deg(self, step)):
            faults["focal_lengths_mm"] = Reason("camera_field_of_view", {"min": MIN_VIEW_DEG, "max": MAX_VIEW_DEG})
        if faults:
            raise InvalidCamera(faults)

    @property
    def pixel_width_mm(self) -> float:
        return self.sensor_width_mm / self.pixels_wide

    @property
    def pixel_height_mm(self) -> float:
        return self.sensor_height_mm / self.pixels_high

    @property
    def pixel_mm(self) -> float:
        """The larger side of a pixel on the sensor."""
        return max(self.pixel_width_mm, self.pixel_height_mm)


def gsd_m(camera: Camera, distance_m: float, focal_mm: float) -> float:
    """Ground sample distance: what one pixel shows, measured across the optical axis, of a surface at this distance along the axis [m]."""
    return distance_m * camera.pixel_mm / focal_mm


def oblique_gsd_m(camera: Camera, distance_m: float, focal_mm: float, angle_deg: float) -> float:
    """What one pixel shows along a surface that is seen at this angle from its normal [m], in the direction in which it is the most.

    Infinite at 90° and beyond, where the surface is not seen.
    """
    if angle_deg >= 90.0:
        return math.inf
    return gsd_m(camera, distance_m, focal_mm) / math.cos(math.radians(angle_deg))


def footprint_m(camera: Camera, distance_m: float, focal_mm: float) -> tuple[float, float]:
    """Width and height [m] of what a photo shows across its optical axis at this distance."""
    return distance_m * camera.sensor_width_mm / focal_mm, distance_m * camera.sensor_height_mm / focal_mm


def field_of_view_deg(camera: Camera, focal_mm: float) -> tuple[float, float]:
    """Horizontal and vertical angle of view [deg]."""
    return (
        2.0 * math.degrees(math.atan(camera.sensor_width_mm / (2.0 * focal_mm))),
        2.0 * math.degrees(math.atan(camera.sensor_height_mm / (2.0 * focal_mm))),
    )


def standoff_m(camera: Camera, asked_gsd_m: float, focal_mm: float) -> float:
    """The greatest distance [m] at which a pixel shows no more than this."""
    return asked_gsd_m * focal_mm / camera.pixel_mm


def spacing_m(footprint: float, overlap: float) -> float:
    """The distance [m] between photos of which neighbours share this part (0 to less than 1) of a footprint [m]."""
    if not 0.0 <= overlap < 1.0:
        raise ValueError("overlap must be from 0 to less than 1")
    return footprint * (1.0 - overlap)


def blur_px(speed_mps: float, exposure_s: float, gsd: float) -> float:
    """By how many pixels a point moves over the sensor while the shutter is open, flown across the optical axis; gsd [m]."""
    return speed_mps * exposure_s / gsd


def max_speed_mps(camera: Camera, gsd: float, spacing: float, allowed_px: float = 0.5) -> float:
    """The greatest speed [m/s] over ground that keeps blur within allowed_px and photos no farther apart than spacing [m]; gsd [m]."""
    return min(allowed_px * gsd / camera.shutter_s, spacing / camera.min_interval_s)


@dataclass(frozen=True)
class Lens:
    """A focal length that is used, and the distances [m] along the optical axis at which it is sharp and fine enough."""

    focal_mm: float
    nearest_m: float
    farthest_m: float


def camera_to_json(camera: Camera) -> dict[str, Any]:
    return {
        "name": camera.name,
        "sensor_width_mm": camera.sensor_width_mm,
        "sensor_height_mm": camera.sensor_height_mm,
        "pixels_wide": camera.pixels_wide,
        "pixels_high": camera.pixels_high,
        "focal_lengths_mm": list(camera.focal_lengths_mm),
        "min_interval_s": camera.min_interval_s,
        "nearest_focus_m": camera.nearest_focus_m,
        "shutter_s": camera.shutter_s,
        "gimbal_pitch_min_deg": camera.gimbal.pitch_min_deg,
        "gimbal_pitch_max_deg": camera.gimbal.pitch_max_deg,
        "gimbal_yaw_min_deg": camera.gimbal.yaw_min_deg,
        "gimbal_yaw_max_deg": camera.gimbal.yaw_max_deg,
        "offset_m": list(camera.offset_m),
        "is_thermal": camera.is_thermal,
    }


def camera_from_json(value: Mapping[str, Any]) -> Camera:
    """Return the camera; figures that are left out have their defaults. Raises InvalidCamera."""
    given = {name: value[name] for name in ("min_interval_s", "nearest_focus_m", "shutter_s", "is_thermal") if name in value}
    angles = {name: value[f"gimbal_{name}"] for name in ("pitch_min_deg", "pitch_max_deg", "yaw_min_deg", "yaw_max_deg")
              if f"gimbal_{name}" in value}  # fmt: skip
    forward_m, right_m, up_m = value.get("offset_m", (0.0, 0.0, 0.0))
    return Camera(
        value["name"], value["sensor_width_mm"], value["sensor_height_mm"], value["pixels_wide"], value["pixels_high"],
        tuple(value["focal_lengths_mm"]), gimbal=Gimbal(**angles), offset_m=(forward_m, right_m, up_m), **given,
    )  # fmt: skip
