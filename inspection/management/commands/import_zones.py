"""manage.py import_zones: reads no-fly zones from a file of an authority or of your own, all of them or none."""

from pathlib import Path
from typing import Any

from django.core.management.base import CommandError, CommandParser

from inspection.management.import_command import ImportCommand, Progress
from inspection.models import DataImport, ImportKind
from inspection.services import ZoneFileError, import_zones
from inspection.services.proposals.reading import Provenance


class Command(ImportCommand):
    kind = ImportKind.ZONES
    help = (
        "Read no-fly zones from an ED-269, ED-318, OpenAir or GeoJSON file. The zones become one set, named after the file; the next "
        "file of that name replaces it, and zones that a curator edited stay. "
        "A file with a fault is refused as a whole, and each fault is printed with its place."
    )

    def add_arguments(self, parser: CommandParser) -> None:
        super().add_arguments(parser)
        parser.add_argument("--set", dest="set_name", help="name of the zone set (default: the file's name without its ending)")
        parser.add_argument("--licence", default="", help="the licence of the data, shown with the set")
        parser.add_argument("--attribution", default="", help="whom to name as the source, shown with the set")

    def read(self, path: Path, options: dict[str, Any], progress: Progress | None) -> DataImport:
        origin = Provenance(file_name=path.name, licence=options["licence"][:200], attribution=options["attribution"][:300])
        try:
            return import_zones(path=path, set_name=options["set_name"], is_synthetic=options["synthetic"], provenance=origin)
        except ZoneFileError as error:
            faults = "".join(f"\n  {fault}" for fault in error.faults)
            raise CommandError(f"{path.name} is refused, nothing of it was stored:{faults}") from error

    def parameters(self, options: dict[str, Any]) -> dict[str, Any]:
        return {"set_name": options["set_name"], "replace_all": True} if options["set_name"] else {}

    def provenance(self, options: dict[str, Any]) -> dict[str, Any]:
        return {"licence": options["licence"][:200], "attribution": options["attribution"][:300]}

    def notify(self, name: str, counts: dict[str, Any]) -> None:
        self.stdout.write(f"{name}: {counts['zones']} zones in {counts['layers']} layers ({counts['format']})")
        self.stdout.write(f"{counts['new']} new, {counts['changed']} changed, {counts['unchanged']} unchanged, {counts['removed']} removed")
