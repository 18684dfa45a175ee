"""manage.py import_assets: reads assets from a file in any format of docs/data-sources.md, all rows or none."""

import json
from pathlib import Path
from typing import Any

from django.core.management.base import CommandError, CommandParser

from inspection.management.import_command import ImportCommand, Progress
from inspection.models import DataImport, ImportKind
from inspection.services import AssetFileError, UnfinishedMapping, import_assets


class Command(ImportCommand):
    kind = ImportKind.ASSETS
    help = (
        "Read assets from a GeoJSON, KML, KMZ, zipped Shapefile, GeoPackage, CSV, GML, FlatGeobuf, DXF or zipped File Geodatabase file. "
        "They become one set; the next file of that set brings it up to date. "
        "--mapping says what the columns mean, as JSON or as the name of a file with it, such as "
        '{"kind": "tower", "columns": {"ref": "nr", "height": "height_ft"}, "units": {"height": "ft"}}; see docs/data-sources.md. '
        "A set that has been imported before keeps its mapping."
    )

    def add_arguments(self, parser: CommandParser) -> None:
        super().add_arguments(parser)
        parser.add_argument("--set", dest="set_name", help="name of the asset set (default: the file's name without its ending)")
        parser.add_argument("--mapping", default="", help="what the columns mean: JSON, or a file with JSON")
        parser.add_argument("--replace-edited", action="store_true", help="overwrite what was edited by hand")

    def read(self, path: Path, options: dict[str, Any], progress: Progress | None) -> DataImport:
        try:
            return import_assets(
                path=path, parameters=_mapping(options["mapping"]) | {"set_name": options["set_name"]}, progress=progress,
                is_synthetic=options["synthetic"], replace_edited=options["replace_edited"],
            )  # fmt: skip
        except AssetFileError as error:
            faults = "".join(f"\n  {fault}" for fault in error.faults)
            raise CommandError(f"{path.name} is refused, nothing of it was stored:{faults}") from error
        except UnfinishedMapping as error:
            raise CommandError(f"{error} (--mapping)") from error

    def parameters(self, options: dict[str, Any]) -> dict[str, Any]:
        stated = _mapping(options["mapping"]) | {"replace_edited": options["replace_edited"]}
        return stated | ({"set_name": options["set_name"]} if options["set_name"] else {})

    def notify(self, name: str, counts: dict[str, Any]) -> None:
        self.stdout.write(f"{name}: {counts['format']}, {counts['crs']}")
        numbers = ", ".join(f"{counts[action]} {action}" for action in ("new", "changed", "vanished", "kept", "unchanged"))
        self.stdout.write(numbers)
        if counts["external_ids"]:
            self.stdout.write(f"{counts['external_ids']} external ids given")
        for reason, rows in counts["left_out"].items():
            self.stdout.write(f"{rows} rows were left out: {reason}")
        for role, values in counts["unread_values"].items():
            self.stdout.write(f"{values} values of {role} could not be read")


def _mapping(text: str) -> dict[str, Any]:
    if not text:
        return {}
    try:
        value = json.loads(text if text.lstrip().startswith("{") else Path(text).read_text(encoding="utf-8"))
    except (ValueError, OSError) as error:
        raise CommandError(f"The mapping cannot be read: {error}") from error
    if not isinstance(value, dict):
        raise CommandError("The mapping is a JSON object.")
    return value
