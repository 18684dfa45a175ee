"""Ground drawn in metres around a place, as the arrays that the builder reads."""

from collections.abc import Sequence

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from inspection.geodesy.wgs84 import WGS84
from inspection.network.infrastructure import NO_OSM_NODE, GroundData, InfrastructurePlaces, InfrastructureWays, Zones

LAT, LON = 47.0, 9.0

Spot = tuple[float, float]  # metres east, metres north


def lonlat(spot: Spot) -> Spot:
    """The position so many metres east and north of the origin, to a millimetre within some kilometres."""
    east, north = spot
    lon, lat, _ = WGS84.fwd(LON, LAT, 0.0 if north >= 0 else 180.0, abs(north))
    lon, lat, _ = WGS84.fwd(lon, lat, 90.0 if east >= 0 else 270.0, abs(east))
    return lon, lat


def places(spots: Sequence[Spot], *, first_asset: int, osm: Sequence[int] = (), heights: Sequence[float] = ()) -> InfrastructurePlaces:
    return InfrastructurePlaces(
        asset=first_asset + np.arange(len(spots), dtype=np.int64),
        osm_node=np.array(osm if len(osm) else [NO_OSM_NODE] * len(spots), dtype=np.int64),
        position=np.array([lonlat(spot) for spot in spots], dtype=np.float64).reshape(-1, 2),
        height_m=np.array(heights if len(heights) else [np.nan] * len(spots), dtype=np.float64),
    )


def ways(*vertices: Sequence[Spot], first_asset: int, osm: Sequence[Sequence[int]] = ()) -> InfrastructureWays:
    nodes = [list(row) for row in osm] if len(osm) else [[NO_OSM_NODE] * len(way) for way in vertices]
    return InfrastructureWays(
        asset=first_asset + np.arange(len(vertices), dtype=np.int64),
        height_m=np.full(len(vertices), np.nan),
        first=np.concatenate([[0], np.cumsum([len(way) for way in vertices])]).astype(np.int64),
        osm_node=np.array([node for row in nodes for node in row], dtype=np.int64),
        position=np.array([lonlat(spot) for way in vertices for spot in way], dtype=np.float64).reshape(-1, 2),
    )


def zone(*corners: Spot) -> BaseGeometry:
    return shapely.Polygon([lonlat(corner) for corner in corners])


def square(middle: Spot, half_m: float) -> BaseGeometry:
    east, north = middle
    return zone(*[(east + x * half_m, north + y * half_m) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))])


def ground(
    *,
    supports: InfrastructurePlaces | None = None,
    bridges: InfrastructurePlaces | None = None,
    lines: InfrastructureWays | None = None,
    railways: InfrastructureWays | None = None,
    zones=(),
) -> GroundData:
    return GroundData(
        revision=1,
        supports=supports or places([], first_asset=1),
        bridges=bridges or places([], first_asset=1),
        lines=lines or ways(first_asset=1),
        railways=railways or ways(first_asset=1),
        zones=Zones(
            tuple(shapely.to_wkb(polygon) for polygon in zones),
            np.arange(len(zones), dtype=np.int64) + 1,
            tuple(f"zone {number + 1}" for number in range(len(zones))),
        ),
    )
