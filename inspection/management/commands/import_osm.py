"""manage.py import_osm: reads power lines, towers, railways and bridges from an OpenStreetMap file."""

from pathlib import Path
from typing import Any

from django.core.management.base import CommandError

from inspection.importers.osm.file_validator import OsmFileError
from inspection.management.import_command import ImportCommand, Progress
from inspection.models import DataImport, ImportKind
from inspection.services import import_osm


class Command(ImportCommand):
    kind = ImportKind.OSM
    help = (
        "Read power lines, towers, railways and bridges from an OpenStreetMap file (.osm.pbf, .osm, .osm.gz, .osm.bz2 or Overpass JSON). "
        "The same file again changes nothing; a newer file updates what changed and marks what vanished; edited assets stay as they are."
    )

    def read(self, path: Path, options: dict[str, Any], progress: Progress | None) -> DataImport:
        try:
            return import_osm(path=path, is_synthetic=options["synthetic"], progress=progress)
        except OsmFileError as error:
            raise CommandError(f"{path.name}: {error}") from error

    def notify(self, name: str, counts: dict[str, Any]) -> None:
        self.stdout.write(
            f"{name}: {counts['tower'] + counts['pole'] + counts['portal']} supports, {counts['line'] + counts['minor_line']} lines "
            f"({counts['line_km'] + counts['minor_line_km']:.1f} km), {counts['railway']} railway ways ({counts['railway_km']:.1f} km), "
            f"{counts['bridge']} bridges"
        )
        self.stdout.write(
            f"{counts['new']} new, {counts['changed']} changed, {counts['unchanged']} unchanged, {counts['vanished']} vanished, "
            f"{counts['kept_edited']} edited and kept"
        )
        for reason, number in counts["skipped"].items():
            self.stdout.write(f"skipped {number}: {reason.replace('_', ' ')}")
