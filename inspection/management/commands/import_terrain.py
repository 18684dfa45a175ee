"""manage.py import_terrain: reads a terrain model from a GeoTIFF or HGT file."""

from pathlib import Path
from typing import Any

from django.core.management.base import CommandError, CommandParser

from inspection.management.import_command import ImportCommand, Progress
from inspection.models import DataImport
from inspection.services import TerrainFileError, import_terrain


class Command(ImportCommand):
    help = (
        "Read a terrain model: a GeoTIFF in EPSG:4326 with one band of heights in metres above sea level, or an SRTM .hgt file. "
        "Without terrain data every plan says 'flat ground assumed'."
    )

    def add_arguments(self, parser: CommandParser) -> None:
        super().add_arguments(parser)
        parser.add_argument("--datum", default="EGM96", help="what the heights count from (default: EGM96, as SRTM)")

    def read(self, path: Path, options: dict[str, Any], progress: Progress | None) -> DataImport:
        try:
            return import_terrain(path=path, is_synthetic=options["synthetic"], vertical_datum=options["datum"][:50], progress=progress)
        except TerrainFileError as error:
            raise CommandError(f"{path.name}: {error}") from error

    def tell(self, name: str, counts: dict[str, Any]) -> None:
        self.stdout.write(
            f"{name}: {counts['blocks']} blocks, heights from {counts['lowest_m']:.0f} to {counts['highest_m']:.0f} m, "
            f"{counts['voids']} of {counts['posts']} posts void"
        )
