"""Common inspection cameras with the source of each figure."""

import json
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from planning.views.camera import Camera, camera_from_json

FILE = Path(__file__).with_name("camera_catalogue.json")


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
    """Return the cameras by key. Where no source states a figure it has the default of Camera and Gimbal."""
    return {row["key"]: _read(row) for row in json.loads(FILE.read_text(encoding="utf-8"))}


def _read(row: dict[str, Any]) -> CatalogueCamera:
    camera = camera_from_json({name: value for name, value in row.items() if value is not None})
    return CatalogueCamera(row["key"], row["maker"], row["payload"], camera, tuple(row["sources"]), row["derived"])
