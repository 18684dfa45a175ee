"""manage.py import_zones: reads no-fly zones from a GeoJSON or ED-269 file, all of them or none."""

import json
from pathlib import Path
from typing import Any

from django.core.management.base import BaseCommand, CommandError, CommandParser

from inspection.services import ZoneFileError, import_zones


class Command(BaseCommand):
    help = (
        "Read no-fly zones from a GeoJSON or ED-269 file. The zones become one set, named after the file; the next file of that name "
        "replaces it. A file with a fault is refused as a whole, and each fault is printed with its place."
    )

    def add_arguments(self, parser: CommandParser) -> None:
        parser.add_argument("file", type=Path, help="the zone file")
        parser.add_argument("--set", dest="set_name", help="name of the zone set (default: the file's name without its ending)")
        parser.add_argument("--json", action="store_true", help="print the counts as JSON")
        parser.add_argument("--synthetic", action="store_true", help="the zones are made up; it is said so wherever they are shown")

    def handle(self, *args: Any, **options: Any) -> None:
        path: Path = options["file"]
        if not path.is_file():
            raise CommandError(f"{path} is no file.")
        try:
            data_import = import_zones(path=path, set_name=options["set_name"], is_synthetic=options["synthetic"])
        except ZoneFileError as error:
            faults = "".join(f"\n  {fault}" for fault in error.faults)
            raise CommandError(f"{path.name} is refused, nothing of it was stored:{faults}") from error
        except OSError as error:
            raise CommandError(f"{path.name} cannot be read: {error.strerror}") from error
        counts = data_import.counts
        if options["json"]:
            self.stdout.write(json.dumps(counts))
            return
        self.stdout.write(f"{path.name}: {counts['zones']} zones in {counts['layers']} layers ({counts['format']})")
        self.stdout.write(f"{counts['new']} new, {counts['changed']} changed, {counts['unchanged']} unchanged, {counts['removed']} removed")
