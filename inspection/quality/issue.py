"""One place where the data looks wrong."""

from dataclasses import dataclass, field
from typing import Any

from shapely.geometry.base import BaseGeometry


@dataclass(frozen=True)
class Gap:
    """kind is a value of models.GapKind. cut_off_m is explained in quality/search.py."""

    kind: str
    key: str  # the same on every run, for as long as the gap is there
    asset: int
    position: tuple[float, float]  # lon, lat [deg]
    geometry: BaseGeometry
    details: dict[str, Any] = field(default_factory=dict)
    other_asset: int | None = None
    cut_off_m: float = 0.0
