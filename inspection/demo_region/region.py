"""The whole demo region from one seed."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from inspection.demo_region.hills import TerrainGrid, make_hills, make_terrain_grid
from inspection.demo_region.osm_file import OsmDrawing
from inspection.demo_region.place import DEFAULT_SEED
from inspection.demo_region.power import draw_power
from inspection.demo_region.transport import draw_transport
from inspection.demo_region.zones import zones_document


@dataclass(frozen=True, eq=False)
class DemoRegion:
    osm: OsmDrawing
    zones: dict[str, Any]
    terrain: TerrainGrid

    def counts(self) -> dict[str, int]:
        supports = [node.tags["power"] for node in self.osm.nodes if node.tags.get("power") in {"tower", "pole", "portal"}]
        return {
            "supports": len(supports),
            "towers": supports.count("tower"),
            "poles": supports.count("pole"),
            "portals": supports.count("portal"),
            "power_lines": sum(way.tags.get("power") in {"line", "minor_line"} and "line" not in way.tags for way in self.osm.ways),
            "railways": len({way.tags["name"] for way in self.osm.ways if way.tags.get("railway") == "rail"}),
            "bridge_ways": sum("bridge" in way.tags for way in self.osm.ways),
            "bridge_areas": sum(way.tags.get("man_made") == "bridge" for way in self.osm.ways),
            "zones": len(self.zones["features"]),
        }


def make_region(seed: int = DEFAULT_SEED) -> DemoRegion:
    """Draw the region. Hills, power and transport use separate generators, so that a change to one does not affect the others."""
    hills_generator, power_generator, transport_generator = np.random.default_rng(seed).spawn(3)
    hills = make_hills(hills_generator)
    osm = OsmDrawing()
    draw_power(osm, hills, power_generator)
    draw_transport(osm, transport_generator)
    return DemoRegion(osm=osm, zones=zones_document(), terrain=make_terrain_grid(hills))
