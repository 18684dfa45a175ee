"""What the detectors read, the graph's own arrays and a few facts besides, and what they find: places where the data look wrong."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from inspection.network.infrastructure import InfrastructurePlaces, InfrastructureWays


@dataclass(frozen=True)
class FoundIssue:
    """kind is a value of models.DataIssueKind. cut_off_m is explained in quality/repair.py."""

    kind: str
    key: str  # the same on every run, for as long as the issue is there
    asset: int
    position: tuple[float, float]  # lon, lat [deg]
    geometry: BaseGeometry
    details: dict[str, Any] = field(default_factory=dict)
    other_asset: int | None = None
    cut_off_m: float = 0.0


NO_OSM_ID = -1


@dataclass(frozen=True)
class WayFacts:
    """Of flyable lines or railways, in the order of their Ways."""

    osm_id: NDArray[np.int64]  # (w,) NO_OSM_ID for what was drawn or came from another file
    subtype: tuple[str, ...]
    voltages_v: tuple[tuple[int, ...], ...]  # highest first
    voltage_text: tuple[str, ...]  # as tagged
    is_edited: NDArray[np.bool_]  # (w,)


@dataclass(frozen=True)
class SupportFacts:
    """Of flyable supports, in the order of their Places."""

    osm_id: NDArray[np.int64]  # (s,) or NO_OSM_ID
    is_terminal: NDArray[np.bool_]  # (s,) a portal, or tagged as where a line ends or goes under ground


@dataclass(frozen=True)
class PlainBridge:
    """A bridge that neither carries a way nor says what it is for."""

    asset: int
    key: str
    position: tuple[float, float]  # lon, lat [deg]


@dataclass(frozen=True)
class IssueSearchData:
    """Everything that issues are looked for in, as of one revision of the ground."""

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
    """What names an asset on every run: its OSM type and id, else its primary key."""
    return f"{letter}{osm_id}" if osm_id != NO_OSM_ID else f"a{asset}"


def place_key(position: NDArray[np.float64]) -> str:
    """A position to a tenth of a metre."""
    return f"{position[0]:.6f},{position[1]:.6f}"
