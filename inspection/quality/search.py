"""All detectors over one ground.

What a gap cuts off (`cut_off_m`, by which the list is sorted) is the length of line network that depends on it:

- ends apart, dead end: the smaller of the two parts of the network that joining would connect; 0 where they hang together anyway, or
  where a dead end has no other part of the network, of its voltage, within 2 km;
- long span: the span, and the smaller side beyond it where nothing else connects that side;
- line without towers: the line; a row of towers on no line: the shortest tree through them;
- line with some vertices without tower, single tower, bridge, voltage: 0.

Parts of the network are lines that share nodes, as the inspection graph joins them, without its links between things that stand near.
"""

from collections.abc import Callable

from shapely import Point

from inspection.quality.infrastructure import Gap, GapGround
from inspection.quality.lines import impossible_voltages, line_ends
from inspection.quality.network import Network
from inspection.quality.supports import lone_towers, long_spans, missing_supports

RECIPE = 2  # counted up when the rules change, so that the next search looks at a ground that it has seen


def bridges_without_way(ground: GapGround) -> list[Gap]:
    return [
        Gap(
            kind="bridge_without_way",
            key=f"bridge_without_way {bridge.key}",
            asset=bridge.asset,
            position=bridge.position,
            geometry=Point(bridge.position),
        )
        for bridge in ground.bridges_without_way
    ]


def search(ground: GapGround, progress: Callable[[str], None] | None = None) -> list[Gap]:
    """Every gap of the ground, the one that cuts off most first; equal grounds give equal lists, each key once."""
    tell = progress or (lambda message: None)
    tell("joining lines")
    network = Network(ground)
    found: list[Gap] = []
    for words, detector in (
        ("long spans", long_spans), ("vertices without a tower", missing_supports), ("towers on no line", lone_towers),
        ("ends of lines", line_ends),
    ):  # fmt: skip
        tell(words)
        found += detector(network)
    tell("bridges and voltages")
    found += bridges_without_way(ground) + impossible_voltages(ground)
    by_key = {gap.key: gap for gap in reversed(found)}
    return sorted(by_key.values(), key=lambda gap: (-gap.cut_off_m, -gap.details.get("missing_towers", 0), gap.key))
