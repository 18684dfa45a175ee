"""A zone as its source states it, ready to be stored."""

from dataclasses import dataclass, field
from typing import Any

from shapely import MultiPolygon

from inspection.geodesy.geometry_validator import GeometryFault

FOOT_M = 0.3048
NO_CEILING = 99_999  # written by some sources (Switzerland) where there is no upper limit
HEIGHT_REFERENCES = ("AGL", "AMSL", "WGS84")
UNITS_M = {"M": 1.0, "FT": FOOT_M}


@dataclass(frozen=True)
class HeightBand:
    """Limits in metres with their references; None and "" mean not stated. as_stated is what the file says, unit and all."""

    lower_limit_m: float | None = None
    lower_reference: str = ""
    upper_limit_m: float | None = None
    upper_reference: str = ""
    as_stated: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class ZoneRecord:
    """One layer of a zone; a zone of several layers has several records of one identifier."""

    identifier: str
    layer: int
    name: str
    geometry: MultiPolygon
    band: HeightBand = HeightBand()
    restriction: str = ""
    reason: str = ""
    circle: dict[str, Any] | None = None  # {"centre": [lon, lat], "radius_m": number}; geometry encloses it
    schedule: list[Any] | None = None  # None: permanent
    properties: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class UnreadRecord:
    """A record with a fault. bbox: west, south, east, north [deg] of those of its positions that can be read; None where none can."""

    fault: GeometryFault
    name: str = ""
    identifier: str = ""
    bbox: tuple[float, float, float, float] | None = None
