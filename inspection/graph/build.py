"""From the ground to the inspection graph that is clear of all its zones."""

from collections.abc import Callable

import numpy as np
import shapely

from inspection.graph.clearing import ClearedGraph, cleared
from inspection.graph.flown_heights import FlownHeights
from inspection.graph.ground_data import GroundData, Zones
from inspection.graph.network import network
from inspection.graph.rules import LinkingRules
from inspection.graph.zone_index import ZoneIndex


def build(
    ground: GroundData,
    rules: LinkingRules,
    progress: Callable[[str, float], None] | None = None,
    *,
    heights: FlownHeights | None = None,
) -> ClearedGraph:
    """The network of the ground, cleared of the ground's zones at all heights."""
    tell = progress or (lambda message, fraction: None)
    tell("joining lines and railways", 0.1)
    whole = network(ground, rules)
    tell("clearing the zones", 0.5)
    return cleared(whole, index_of(ground.zones), rules, heights or FlownHeights(), ground_revision=ground.revision)


def index_of(zones: Zones) -> ZoneIndex:
    return ZoneIndex(shapely.from_wkb(np.array(zones.wkb, dtype=object)), zones.identifier, zones.name)
