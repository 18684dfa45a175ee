"""Assets as GeoJSON features."""

import json
from typing import Any

from rest_framework import serializers

from inspection.models import AssetKind, AssetReference
from inspection.selectors import asset_detail, asset_label
from inspection.selectors.assets import DrawnAsset
from inspection.selectors.register.assets import LastInspection
from inspection.serializers.features import SourceSerializer, collection_serializer, feature_serializer, source_json
from workspace.api.external_data import AttributesField
from workspace.jobs.serializers import Declared


class AssetPropertiesSerializer(serializers.Serializer):
    kind = serializers.ChoiceField(choices=AssetKind.choices)
    subtype = serializers.CharField()
    label: Declared = serializers.CharField(help_text="what people call it: ref, name, or words made from what is known")
    detail = serializers.CharField(help_text="a second fact: a support's line, voltage and operator, what a bridge carries; may be empty")
    name = serializers.CharField()
    ref = serializers.CharField()
    operator = serializers.CharField()
    voltages_v = serializers.ListField(child=serializers.IntegerField(), help_text="highest first")
    circuits = serializers.IntegerField(allow_null=True)
    height_m = serializers.FloatField(allow_null=True, help_text="above ground; null when not stated")
    length_m = serializers.FloatField(allow_null=True)
    osm = serializers.CharField(allow_null=True, help_text="type and id, such as w123")
    is_flyable = serializers.BooleanField(help_text="part of the inspection graph")
    line = serializers.IntegerField(allow_null=True, help_text="of a support: the line of the highest voltage that it carries")
    line_label: Declared = serializers.CharField(help_text="of this line; may be empty")
    region = serializers.IntegerField(allow_null=True, help_text="the region of its import")
    inspected_at = serializers.DateTimeField(
        allow_null=True, help_text="when an aircraft of your organisation inspected it, or any part of a line, last"
    )
    inspected_share = serializers.FloatField(
        allow_null=True, help_text="of a line or railway: the share of its length that was ever inspected, 0 to 1; null: never, or no line"
    )
    updated_at = serializers.DateTimeField()
    centre = serializers.ListField(child=serializers.FloatField(), min_length=2, max_length=2, help_text="lon, lat")
    external_id = serializers.CharField(help_text="your organisation's id of it; may be empty")
    attributes = AttributesField(required=True, help_text="your organisation's own")


class AssetDetailPropertiesSerializer(AssetPropertiesSerializer):
    tags = serializers.DictField(help_text="as the source has them")
    revision = serializers.IntegerField(help_text="the ETag")
    is_edited = serializers.BooleanField(help_text="changed by a curator")
    follows = serializers.BooleanField(help_text="there is a source whose facts can be taken again")
    asset_set = serializers.CharField(allow_null=True, help_text="the set of a file other than OpenStreetMap's")
    vanished_at = serializers.DateTimeField(allow_null=True, help_text="when an import no longer had it")
    source: Declared = SourceSerializer(allow_null=True)


AssetFeatureSerializer = feature_serializer("AssetFeature", AssetPropertiesSerializer)
AssetDetailFeatureSerializer = feature_serializer("AssetDetailFeature", AssetDetailPropertiesSerializer)


class AssetCollectionSerializer(collection_serializer("AssetCollection", AssetFeatureSerializer)):  # type: ignore[misc]
    total = serializers.IntegerField(required=False, help_text="on all pages; where it was asked for")


FIELDS_OF_AN_ASSET = (
    "kind", "subtype", "osm_type", "osm_id", "centre", "name", "ref", "operator", "voltages_v", "max_voltage_v", "circuits", "height_m",
    "length_m", "is_flyable", "carries", "place_on_line", "places_on_line", "updated_at",
    "line__kind", "line__subtype", "line__osm_type", "line__osm_id", "line__ref", "line__name", "line__operator", "line__max_voltage_v",
    "line__line", "data_import__region",
)  # fmt: skip


def asset_properties(asset: DrawnAsset, reference: AssetReference | None, inspection: LastInspection | None) -> dict[str, Any]:
    """Return the properties of the feature. `reference` and `inspection` are of the reader's organisation."""
    return {
        "kind": asset.kind,
        "subtype": asset.subtype,
        "label": asset_label(asset),
        "detail": asset_detail(asset),
        "name": asset.name,
        "ref": asset.ref,
        "operator": asset.operator,
        "voltages_v": asset.voltages_v,
        "circuits": asset.circuits,
        "height_m": asset.height_m,
        "length_m": asset.length_m,
        "osm": f"{asset.osm_type}{asset.osm_id}" if asset.osm_id is not None else None,
        "is_flyable": asset.is_flyable,
        "line": asset.line_id,
        "line_label": asset_label(asset.line) if asset.line is not None else "",
        "region": asset.data_import and asset.data_import.region_id,
        "inspected_at": inspection and inspection.at,
        "inspected_share": inspection and inspection.share,
        "updated_at": asset.updated_at,
        "centre": [asset.centre.x, asset.centre.y],
        "external_id": reference.external_id if reference else "",
        "attributes": reference.attributes if reference else {},
    }


def asset_feature(asset: DrawnAsset, reference: AssetReference | None, inspection: LastInspection | None) -> dict[str, Any]:
    """Return the feature. `asset` has `geometry_json` from inspection.selectors."""
    properties = asset_properties(asset, reference, inspection)
    return {"type": "Feature", "id": asset.pk, "geometry": json.loads(asset.geometry_json), "properties": properties}


def asset_detail_feature(asset: DrawnAsset, reference: AssetReference | None, inspection: LastInspection | None) -> dict[str, Any]:
    feature = asset_feature(asset, reference, inspection)
    feature["properties"] |= {
        "tags": asset.tags,
        "revision": asset.revision,
        "is_edited": asset.is_edited,
        "follows": asset.source_facts is not None,
        "asset_set": asset.asset_set and asset.asset_set.name,
        "vanished_at": asset.vanished_at,
        "source": source_json(asset.data_import),
    }
    return feature
