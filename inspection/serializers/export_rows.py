"""Assets and zones as rows of a file."""

from collections.abc import Iterator
from itertools import islice

import shapely

from inspection.exporters.rows import Columns, ExportRow
from inspection.models import AssetKind
from inspection.selectors import references_of
from inspection.selectors.register.assets import AssetFilter, assets_that_match, last_inspections
from inspection.selectors.register.zones import ZoneFilter, zones_that_match
from inspection.serializers.assets import FIELDS_OF_AN_ASSET, asset_properties
from inspection.serializers.zones import zone_properties

BATCH = 2_000
ZONE_BATCH = 500
LAYERS = {AssetKind.TOWER: "towers", AssetKind.LINE: "lines", AssetKind.RAILWAY: "railways", AssetKind.BRIDGE: "bridges"}
ASSET_COLUMNS: Columns = {
    "kind": "TEXT", "subtype": "TEXT", "label": "TEXT", "name": "TEXT", "ref": "TEXT", "operator": "TEXT", "voltages_v": "TEXT",
    "circuits": "INTEGER", "height_m": "REAL", "length_m": "REAL", "is_flyable": "BOOLEAN", "line_label": "TEXT", "osm": "TEXT",
    "external_id": "TEXT", "inspected_at": "DATETIME", "inspected_share": "REAL",
}  # fmt: skip
ZONE_COLUMNS: Columns = {
    "name": "TEXT", "identifier": "TEXT", "layer": "INTEGER", "zone_set": "TEXT", "restriction": "TEXT", "reason": "TEXT",
    "lower_limit_m": "REAL", "lower_reference": "TEXT", "upper_limit_m": "REAL", "upper_reference": "TEXT", "schedule": "TEXT",
    "is_active": "BOOLEAN",
}  # fmt: skip


def asset_rows(wanted: AssetFilter) -> Iterator[ExportRow]:
    """Yield the assets kind by kind."""
    found = assets_that_match(wanted).only(*FIELDS_OF_AN_ASSET).order_by("kind", "pk").iterator(BATCH)
    while batch := list(islice(found, BATCH)):
        keys = [asset.pk for asset in batch]
        references, inspected = references_of(wanted.organisation_id, keys), last_inspections(wanted.organisation_id, keys)
        for asset in batch:
            values = asset_properties(asset, references.get(asset.pk), inspected.get(asset.pk))
            inspected_at = values["inspected_at"]
            stated = {name: values[name] for name in ASSET_COLUMNS} | {
                "voltages_v": ";".join(map(str, values["voltages_v"])),
                "inspected_at": inspected_at and inspected_at.isoformat().replace("+00:00", "Z"),
            }
            layer = LAYERS[AssetKind(asset.kind)]
            yield ExportRow(layer, asset.pk, asset.geometry_json, asset.centre.x, asset.centre.y, stated)


def zone_rows(wanted: ZoneFilter) -> Iterator[ExportRow]:
    """Yield the zones, oldest first."""
    for zone in zones_that_match(wanted).order_by("pk").iterator(ZONE_BATCH):
        values = zone_properties(zone)
        limits = {
            f"{side}_{name}": (values[f"{side}_limit"] or {}).get(key)
            for side in ("lower", "upper")
            for name, key in (("limit_m", "value_m"), ("reference", "reference"))
        }
        stated = {name: values[name] for name in ZONE_COLUMNS if name in values} | limits | {"schedule": values["schedule_words"]}
        middle = shapely.from_geojson(zone.geometry_json).representative_point()
        yield ExportRow("zones", zone.pk, zone.geometry_json, middle.x, middle.y, stated)
