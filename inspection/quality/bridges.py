"""Bridges without a way: nothing says what they carry."""

from shapely import Point

from inspection.quality.infrastructure import GapGround
from inspection.quality.issue import Gap


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
