"""manage.py import_terrain: reads a terrain model from a GeoTIFF or HGT file."""

import json
import sys
from pathlib import Path
from typing import Any

from django.core.management.base import BaseCommand, CommandError, CommandParser

from inspection.services import TerrainFileError, import_terrain


class Command(BaseCommand):
    help = (
        "Read a terrain model: a GeoTIFF in EPSG:4326 with one band of heights in metres above sea level, or an SRTM .hgt file. "
        "Without terrain data every plan says 'flat ground assumed'."
    )

    def add_arguments(self, parser: CommandParser) -> None:
        parser.add_argument("file", type=Path, help="the terrain file")
        parser.add_argument("--datum", default="EGM96", help="what the heights count from (default: EGM96, as SRTM)")
        parser.add_argument("--json", action="store_true", help="print the counts as JSON")
        parser.add_argument("--synthetic", action="store_true", help="the terrain is made up; it is said so wherever it is shown")

    def handle(self, *args: Any, **options: Any) -> None:
        path: Path = options["file"]
        if not path.is_file():
            raise CommandError(f"{path} is no file.")
        is_watched = sys.stderr.isatty()

        def show(stage: str, share: float) -> None:
            self.stderr.write(f"\r\033[K{share:4.0%} {stage}", style_func=str, ending="")

        try:
            data_import = import_terrain(
                path=path, is_synthetic=options["synthetic"], vertical_datum=options["datum"][:50], progress=show if is_watched else None
            )
        except TerrainFileError as error:
            raise CommandError(f"{path.name}: {error}") from error
        finally:
            if is_watched:
                self.stderr.write("\r\033[K", style_func=str, ending="")
        counts = data_import.counts
        if options["json"]:
            self.stdout.write(json.dumps(counts))
            return
        self.stdout.write(
            f"{path.name}: {counts['blocks']} blocks, heights from {counts['lowest_m']:.0f} to {counts['highest_m']:.0f} m, "
            f"{counts['voids']} of {counts['posts']} posts void"
        )
