"""manage.py make_demo_region DIR: write a synthetic region as the files that the importers read."""

import json
from pathlib import Path
from typing import Any

from django.contrib.gis.gdal import GDALRaster
from django.core.management.base import BaseCommand, CommandParser

from inspection.demo_region import DEFAULT_SEED, QUILLMOOR_NAME, REGION_NAME, make_quillmoor, make_region, write_osm_file
from inspection.demo_region.hills import TerrainGrid

GDAL_FLOAT32 = 6
EGM96_SRID = 9707  # WGS 84, with heights above EGM96: the file states its vertical reference


class Command(BaseCommand):
    help = (
        "Write the synthetic demo region: demo.osm.pbf, demo-zones.json (ED-269) and demo-terrain.tif; or quillmoor.osm.pbf, "
        "a second synthetic region that is mapped as real regions are. The same seed gives the same files."
    )
    requires_system_checks: list[str] = []

    def add_arguments(self, parser: CommandParser) -> None:
        parser.add_argument("directory", metavar="DIR", type=Path)
        parser.add_argument("--seed", type=int, default=DEFAULT_SEED)
        parser.add_argument("--region", choices=["elme-valley", "quillmoor"], default="elme-valley")

    def handle(self, *args: Any, directory: Path, seed: int, region: str, **options: Any) -> None:
        directory.mkdir(parents=True, exist_ok=True)
        if region == "quillmoor":
            self._write_quillmoor(directory / "quillmoor.osm.pbf", seed)
        else:
            self._write_elme_valley(directory, seed)

    def _write_quillmoor(self, path: Path, seed: int) -> None:
        drawing = make_quillmoor(seed)
        write_osm_file(path, drawing)
        self.stdout.write(f"{QUILLMOOR_NAME} (synthetic, seed {seed}): {len(drawing.nodes)} nodes, {len(drawing.ways)} ways")
        self.stdout.write(str(path))

    def _write_elme_valley(self, directory: Path, seed: int) -> None:
        region = make_region(seed)
        osm_path, zones_path, terrain_path = (directory / name for name in ("demo.osm.pbf", "demo-zones.json", "demo-terrain.tif"))
        write_osm_file(osm_path, region.osm)
        zones_path.write_text(json.dumps(region.zones, indent=2) + "\n")
        _write_terrain(terrain_path, region.terrain)
        counts = ", ".join(f"{count} {name.replace('_', ' ')}" for name, count in region.counts().items())
        self.stdout.write(f"{REGION_NAME} (synthetic, seed {seed}): {counts}")
        for path in (osm_path, zones_path, terrain_path):
            self.stdout.write(str(path))


def _write_terrain(path: Path, terrain: TerrainGrid) -> None:
    rows, columns = terrain.heights_amsl_m.shape
    GDALRaster(
        {
            "driver": "GTiff",
            "name": str(path),
            "width": columns,
            "height": rows,
            "srid": EGM96_SRID,
            "origin": (terrain.west_deg, terrain.north_deg),
            "scale": (terrain.step_deg, -terrain.step_deg),
            "datatype": GDAL_FLOAT32,
            "bands": [{"data": terrain.heights_amsl_m.tobytes(), "nodata_value": -9999.0}],
            "papsz_options": {"compress": "deflate", "predictor": "3"},
        }
    )
