"""manage.py delete_region: delete all assets of a box, an import or a set."""

from typing import Any

from django.core.management.base import BaseCommand, CommandError, CommandParser

from inspection.models import AssetSet, DataImport
from inspection.services.regions import AssetGroup, counts_of_group, delete_assets


class Command(BaseCommand):
    help = (
        "Delete the assets of a box, of one import or of one set, except those that were drawn or edited by hand. Missions keep their "
        "references, and the next file that has an asset restores it. Without --yes it only counts them."
    )

    def add_arguments(self, parser: CommandParser) -> None:
        which = parser.add_mutually_exclusive_group(required=True)
        which.add_argument("--bbox", help="west,south,east,north in degrees; assets that intersect it")
        which.add_argument("--import", dest="data_import", type=int, help="number of a data import, as the admin lists them")
        which.add_argument("--set", dest="asset_set", help="name of a set of assets that came from other files than OpenStreetMap's")
        parser.add_argument("--yes", action="store_true", help="delete them")

    def handle(self, *args: Any, **options: Any) -> None:
        group = self._group(options)
        counts = delete_assets(group=group, actor=None) if options["yes"] else counts_of_group(group)
        words = ", ".join(f"{number} {kind}" for kind, number in sorted(counts.items())) or "nothing"
        self.stdout.write(f"{words} deleted" if options["yes"] else f"{words} would be deleted; --yes deletes")

    def _group(self, options: dict[str, Any]) -> AssetGroup:
        if options["bbox"]:
            try:
                west, south, east, north = (float(part) for part in options["bbox"].split(","))
            except ValueError as error:
                raise CommandError("--bbox is four numbers: west,south,east,north") from error
            if not (-180 <= west <= 180 and -180 <= east <= 180 and -90 <= south < north <= 90):
                raise CommandError("--bbox reaches beyond the earth, or south is not below north")
            return AssetGroup(box=(west, south, east, north))
        if options["data_import"] is not None:
            row = DataImport.objects.filter(pk=options["data_import"]).first()
            if row is None:
                raise CommandError(f"There is no import {options['data_import']}.")
            return AssetGroup(data_import=row)
        found = AssetSet.objects.filter(name=options["asset_set"]).first()
        if found is None:
            raise CommandError(f"There is no set {options['asset_set']!r}.")
        return AssetGroup(asset_set=found)
