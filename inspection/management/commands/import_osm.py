"""manage.py import_osm: reads power lines, towers, railways and bridges from an OpenStreetMap file."""

import json
import sys
from pathlib import Path
from typing import Any

from django.core.management.base import BaseCommand, CommandError, CommandParser

from inspection.osm.file_gate import OsmFileError
from inspection.services import import_osm


class Command(BaseCommand):
    help = (
        "Read power lines, towers, railways and bridges from an OpenStreetMap file (.osm.pbf, .osm, .osm.gz, .osm.bz2 or Overpass JSON). "
        "The same file again changes nothing; a newer file updates what changed and marks what vanished; edited assets stay as they are."
    )

    def add_arguments(self, parser: CommandParser) -> None:
        parser.add_argument("file", type=Path, help="the OpenStreetMap file")
        parser.add_argument("--json", action="store_true", help="print the counts as JSON")
        parser.add_argument("--synthetic", action="store_true", help="the data is made up; it is said so wherever it is shown")

    def handle(self, *args: Any, **options: Any) -> None:
        path: Path = options["file"]
        if not path.is_file():
            raise CommandError(f"{path} is no file.")
        is_watched = sys.stderr.isatty()

        def show(stage: str, share: float) -> None:
            self.stderr.write(f"\r\033[K{share:4.0%} {stage}", style_func=str, ending="")

        try:
            data_import = import_osm(path=path, is_synthetic=options["synthetic"], progress=show if is_watched else None)
        except OsmFileError as error:
            raise CommandError(f"{path.name}: {error}") from error
        finally:
            if is_watched:
                self.stderr.write("\r\033[K", style_func=str, ending="")
        counts = data_import.counts
        if options["json"]:
            self.stdout.write(json.dumps(counts))
            return
        self.stdout.write(
            f"{path.name}: {counts['tower'] + counts['pole'] + counts['portal']} supports, {counts['line'] + counts['minor_line']} lines "
            f"({counts['line_km'] + counts['minor_line_km']:.1f} km), {counts['railway']} railway ways ({counts['railway_km']:.1f} km), "
            f"{counts['bridge']} bridges"
        )
        self.stdout.write(
            f"{counts['new']} new, {counts['changed']} changed, {counts['unchanged']} unchanged, {counts['vanished']} vanished, "
            f"{counts['kept_edited']} edited and kept"
        )
        for reason, number in counts["skipped"].items():
            self.stdout.write(f"skipped {number}: {reason.replace('_', ' ')}")
