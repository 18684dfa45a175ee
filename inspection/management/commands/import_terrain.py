"""manage.py import_terrain: reads a terrain model from a GeoTIFF or HGT file, or from a zip of several."""

from pathlib import Path
from typing import Any

from django.core.management.base import CommandError, CommandParser

from inspection.management.import_command import ImportCommand, Progress
from inspection.models import DataImport, ImportKind
from inspection.services import TerrainFileError, import_terrain


class Command(ImportCommand):
    kind = ImportKind.TERRAIN
    help = (
        "Read a terrain model: a GeoTIFF with one band of heights above sea level, an SRTM .hgt file, or a zip of several of them. "
        "Without terrain data every plan says 'flat ground assumed'."
    )

    def add_arguments(self, parser: CommandParser) -> None:
        super().add_arguments(parser)
        parser.add_argument("--datum", default="", help="what the heights count from, such as EGM96, for a file that does not state it")

    def read(self, path: Path, options: dict[str, Any], progress: Progress | None) -> DataImport:
        try:
            return import_terrain(path=path, is_synthetic=options["synthetic"], vertical_datum=options["datum"], progress=progress)
        except TerrainFileError as error:
            raise CommandError(f"{path.name}: {error}") from error

    def notify(self, name: str, counts: dict[str, Any]) -> None:
        self.stdout.write(
            f"{name}: {counts['blocks']} blocks, heights from {counts['lowest_m']:.0f} to {counts['highest_m']:.0f} m above "
            f"{counts['vertical_datum']}, {counts['voids']} of {counts['posts']} posts void"
        )
        for note in counts["notes"]:
            self.stdout.write(f"  {note}")
