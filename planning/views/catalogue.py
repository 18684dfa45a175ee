"""Common inspection cameras with the source of each figure."""

import json
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from planning.views.camera import Camera, Gimbal

FILE = Path(__file__).with_name("camera_catalogue.json")
USUAL_INTERVAL_S, USUAL_FOCUS_M = 2.0, 1.0  # where no source states them


@dataclass(frozen=True)
class CatalogueCamera:
    """sources: title, url, date, and the figures that each states; derived: how figures without a source follow from others."""

    key: str
    maker: str
    payload: str
    camera: Camera
    sources: tuple[dict[str, Any], ...]
    derived: dict[str, str]


@cache
def catalogue() -> dict[str, CatalogueCamera]:
    """Return the cameras by key. A body without a stated gimbal counts as one on a gimbal that looks from the horizon straight down."""
    return {row["key"]: _read(row) for row in json.loads(FILE.read_text(encoding="utf-8"))}


def _read(row: dict[str, Any]) -> CatalogueCamera:
    pitch_min_deg, pitch_max_deg = row["gimbal_pitch_min_deg"], row["gimbal_pitch_max_deg"]
    stated = () if pitch_min_deg is None else (pitch_min_deg, pitch_max_deg, row["gimbal_yaw_min_deg"], row["gimbal_yaw_max_deg"])
    camera = Camera(
        row["name"], row["sensor_width_mm"], row["sensor_height_mm"], row["pixels_wide"], row["pixels_high"],
        tuple(row["focal_lengths_mm"]),
        min_interval_s=row["min_interval_s"] or USUAL_INTERVAL_S,
        nearest_focus_m=USUAL_FOCUS_M if row["nearest_focus_m"] is None else row["nearest_focus_m"],
        gimbal=Gimbal(*stated),
        is_thermal=row["is_thermal"],
    )  # fmt: skip
    return CatalogueCamera(row["key"], row["maker"], row["payload"], camera, tuple(row["sources"]), row["derived"])
