"""The demo region: a made valley with power lines, railways, bridges, zones, hills and UAV bases, the same for the same seed.

Nothing in it exists. Its files are read by the same importers as any other data.
"""

from inspection.demo_region.osm_file import write_osm_file
from inspection.demo_region.place import BASES, DEFAULT_SEED, REGION_NAME, Base, BasedUav
from inspection.demo_region.region import DemoRegion, make_region

__all__ = ["BASES", "DEFAULT_SEED", "REGION_NAME", "Base", "BasedUav", "DemoRegion", "make_region", "write_osm_file"]
