"""From the ground to the inspection graph that is clear of all its zones."""

from collections.abc import Callable

import numpy as np
import shapely

from inspection.network.build.network import network
from inspection.network.build.zone_masking import MaskedGraph, masked
from inspection.network.infrastructure import GroundData, Zones
from inspection.network.rules import FlownHeights, LinkingRules
from inspection.network.zones.zone_index import ZoneIndex


def build(
    ground: GroundData,
    rules: LinkingRules,
    progress: Callable[[str, float], None] | None = None,
    *,
    heights: FlownHeights | None = None,
) -> MaskedGraph:
    """The network of the ground, cleared of the ground's zones at all heights."""
    notify = progress or (lambda message, fraction: None)
    notify("joining lines and railways", 0.1)
    whole = network(ground, rules)
    notify("clearing the zones", 0.5)
    return masked(whole, index_of(ground.zones), rules, heights or FlownHeights(), ground_revision=ground.revision)


def index_of(zones: Zones) -> ZoneIndex:
    return ZoneIndex(shapely.from_wkb(np.array(zones.wkb, dtype=object)), zones.identifier, zones.name)
