"""Inputs of the detectors, the graph's arrays with a few facts, and their result: places where map data look wrong."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from inspection.network.infrastructure import InfrastructurePlaces, InfrastructureWays


@dataclass(frozen=True)
class FoundIssue:
    """A data issue. kind is a value of models.DataIssueKind. quality/repair.py defines cut_off_m."""

    kind: str
    key: str  # the same in every run while the issue exists
    asset: int
    position: tuple[float, float]  # lon, lat [deg]
    geometry: BaseGeometry
    details: dict[str, Any] = field(default_factory=dict)
    other_asset: int | None = None
    cut_off_m: float = 0.0


NO_OSM_ID = -1


@dataclass(frozen=True)
class WayFacts:
    """Facts of flyable lines or railways, in the order of their Ways."""

    osm_id: NDArray[np.int64]  # (w,) NO_OSM_ID for manually drawn ones and other files
    subtype: tuple[str, ...]
    voltages_v: tuple[tuple[int, ...], ...]  # highest first
    voltage_text: tuple[str, ...]  # as tagged
    is_edited: NDArray[np.bool_]  # (w,)


@dataclass(frozen=True)
class SupportFacts:
    """Facts of flyable supports, in the order of their Places."""

    osm_id: NDArray[np.int64]  # (s,) or NO_OSM_ID
    is_terminal: NDArray[np.bool_]  # (s,) a portal, or tagged as the end of a line or of its overhead part


@dataclass(frozen=True)
class PlainBridge:
    """A bridge that neither carries a way nor states a purpose."""

    asset: int
    key: str
    position: tuple[float, float]  # lon, lat [deg]


@dataclass(frozen=True)
class IssueSearchData:
    """Inputs of the search for issues, of one dataset version."""

    revision: int
    lines: InfrastructureWays
    line_facts: WayFacts
    railways: InfrastructureWays
    railway_facts: WayFacts
    supports: InfrastructurePlaces
    support_facts: SupportFacts
    bridges_without_way: tuple[PlainBridge, ...]
    off_network: NDArray[np.float64]  # (k, 2) vertices of what is not flown: cables, busbars, bays, lines out of use


def asset_key(letter: str, osm_id: int, asset: int) -> str:
    """Return the same key of an asset in every run: its OSM type and id, else its primary key."""
    return f"{letter}{osm_id}" if osm_id != NO_OSM_ID else f"a{asset}"


def place_key(position: NDArray[np.float64]) -> str:
    """Return a position to a tenth of a metre as text."""
    return f"{position[0]:.6f},{position[1]:.6f}"
