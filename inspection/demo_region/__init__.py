"""Two synthetic regions: Elme Valley, the demo region with zones, hills and UAV bases, and Quillmoor, mapped like real regions.

Nothing in them exists. The same seed gives the same region. The ordinary importers read their files.
"""

from inspection.demo_region.osm_file import write_osm_file
from inspection.demo_region.place import BASES, DEFAULT_SEED, REGION_NAME, BasedUav, DemoBase
from inspection.demo_region.quillmoor import QUILLMOOR_NAME, make_quillmoor
from inspection.demo_region.region import DemoRegion, make_region

__all__ = [
    "BASES",
    "DEFAULT_SEED",
    "QUILLMOOR_NAME",
    "REGION_NAME",
    "BasedUav",
    "DemoBase",
    "DemoRegion",
    "make_quillmoor",
    "make_region",
    "write_osm_file",
]  # fmt: skip
