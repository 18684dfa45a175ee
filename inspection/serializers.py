"""Shapes of the ground in the API: GeoJSON features."""

import json
from typing import Any

from rest_framework import serializers

from inspection.models import Asset, AssetKind, DataImport, HeightReference, NoFlyZone
from inspection.selectors import GroundSummary, asset_detail, asset_label


class GeometrySerializer(serializers.Serializer):
    """A GeoJSON geometry, WGS84, longitude first."""

    type = serializers.ChoiceField(choices=["Point", "LineString", "MultiLineString", "Polygon", "MultiPolygon"])
    coordinates = serializers.ListField(child=serializers.JSONField())


class AssetPropertiesSerializer(serializers.Serializer):
    kind = serializers.ChoiceField(choices=AssetKind.choices)
    subtype = serializers.CharField()
    label = serializers.CharField(help_text="what people call it: ref, name, or words made from what is known")
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
    centre = serializers.ListField(child=serializers.FloatField(), min_length=2, max_length=2, help_text="lon, lat")


class SourceSerializer(serializers.Serializer):
    """The file that something came from."""

    file_name = serializers.CharField()
    attribution = serializers.CharField(help_text="author and licence")
    is_synthetic = serializers.BooleanField()
    imported_at = serializers.DateTimeField()


class AssetDetailPropertiesSerializer(AssetPropertiesSerializer):
    tags = serializers.DictField(help_text="as the source has them")
    is_edited = serializers.BooleanField(help_text="changed by a curator")
    vanished_at = serializers.DateTimeField(allow_null=True, help_text="when an import no longer had it")
    updated_at = serializers.DateTimeField()
    source = SourceSerializer(allow_null=True)


class LimitSerializer(serializers.Serializer):
    value_m = serializers.FloatField()
    reference = serializers.ChoiceField(choices=HeightReference.choices, allow_blank=True, help_text="empty when not stated")


class ZonePropertiesSerializer(serializers.Serializer):
    """Facts as the source gives them; null is "not stated"."""

    name = serializers.CharField()
    identifier = serializers.CharField()
    layer = serializers.IntegerField()
    zone_set = serializers.CharField(allow_null=True)
    restriction = serializers.CharField()
    reason = serializers.CharField()
    lower_limit = LimitSerializer(allow_null=True)
    upper_limit = LimitSerializer(allow_null=True)
    source_heights = serializers.DictField(help_text="limits, unit and references in the source's own words")
    circle = serializers.DictField(
        allow_null=True, help_text="centre and radius_m, where the source gives a circle; the polygon encloses it"
    )
    schedule = serializers.JSONField(allow_null=True, help_text="when it applies, in the source's own words; null = always")
    updated_at = serializers.DateTimeField()
    source = SourceSerializer(allow_null=True)


class ZoneDetailPropertiesSerializer(ZonePropertiesSerializer):
    properties = serializers.DictField(help_text="everything else that the source says")


def _feature(name: str, properties: type[serializers.Serializer]) -> type[serializers.Serializer]:
    return type(
        f"{name}Serializer",
        (serializers.Serializer,),
        {
            "type": serializers.ChoiceField(choices=["Feature"]),
            "id": serializers.IntegerField(),
            "geometry": GeometrySerializer(),
            "properties": properties(),
        },
    )


def _collection(name: str, feature: type[serializers.Serializer]) -> type[serializers.Serializer]:
    return type(
        f"{name}Serializer",
        (serializers.Serializer,),
        {
            "type": serializers.ChoiceField(choices=["FeatureCollection"]),
            "features": feature(many=True),
            "next": serializers.CharField(allow_null=True, help_text="address of the next page"),
        },
    )


AssetFeatureSerializer = _feature("AssetFeature", AssetPropertiesSerializer)
AssetDetailFeatureSerializer = _feature("AssetDetailFeature", AssetDetailPropertiesSerializer)
AssetCollectionSerializer = _collection("AssetCollection", AssetFeatureSerializer)
ZoneFeatureSerializer = _feature("ZoneFeature", ZonePropertiesSerializer)
ZoneDetailFeatureSerializer = _feature("ZoneDetailFeature", ZoneDetailPropertiesSerializer)
ZoneCollectionSerializer = _collection("ZoneCollection", ZoneFeatureSerializer)


class GraphSummarySerializer(serializers.Serializer):
    version = serializers.IntegerField()
    nodes = serializers.IntegerField()
    edges = serializers.IntegerField()
    built_at = serializers.DateTimeField()
    is_current = serializers.BooleanField(help_text="false while the ground has changed and the next graph is not yet built")


class GroundSerializer(serializers.Serializer):
    revision = serializers.IntegerField()
    graph = GraphSummarySerializer(allow_null=True)
    extent = serializers.ListField(child=serializers.FloatField(), allow_null=True, help_text="west, south, east, north")
    counts = serializers.DictField(child=serializers.IntegerField(), help_text="by kind of asset, and `zone`")
    attribution = serializers.ListField(child=serializers.CharField())
    is_synthetic = serializers.BooleanField(help_text="some of the data is made, not real")
    has_terrain = serializers.BooleanField()


FIELDS_OF_AN_ASSET = (
    "kind", "subtype", "osm_type", "osm_id", "centre", "name", "ref", "operator", "voltages_v", "max_voltage_v", "circuits", "height_m",
    "length_m", "is_flyable", "carries", "place_on_line", "places_on_line",
    "line__ref", "line__name", "line__operator", "line__max_voltage_v",
)  # fmt: skip


def asset_feature(asset: Asset) -> dict[str, Any]:
    """`asset` comes with `geometry_json` from inspection.selectors."""
    properties = {
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
        "centre": [asset.centre.x, asset.centre.y],
    }
    return {"type": "Feature", "id": asset.pk, "geometry": json.loads(asset.geometry_json), "properties": properties}


def asset_detail_feature(asset: Asset) -> dict[str, Any]:
    feature = asset_feature(asset)
    feature["properties"] |= {
        "tags": asset.tags,
        "is_edited": asset.is_edited,
        "vanished_at": asset.vanished_at,
        "updated_at": asset.updated_at,
        "source": _source(asset.data_import),
    }
    return feature


def zone_feature(zone: NoFlyZone) -> dict[str, Any]:
    properties = {
        "name": zone.name,
        "identifier": zone.identifier,
        "layer": zone.layer,
        "zone_set": zone.zone_set.name if zone.zone_set else None,
        "restriction": zone.restriction,
        "reason": zone.reason,
        "lower_limit": _limit(zone.lower_limit_m, zone.lower_reference),
        "upper_limit": _limit(zone.upper_limit_m, zone.upper_reference),
        "source_heights": zone.source_heights,
        "circle": zone.circle,
        "schedule": zone.schedule,
        "updated_at": zone.updated_at,
        "source": _source(zone.zone_set.data_import if zone.zone_set else None),
    }
    return {"type": "Feature", "id": zone.pk, "geometry": json.loads(zone.geometry_json), "properties": properties}


def zone_detail_feature(zone: NoFlyZone) -> dict[str, Any]:
    feature = zone_feature(zone)
    feature["properties"]["properties"] = zone.properties
    return feature


def ground_json(summary: GroundSummary) -> dict[str, Any]:
    graph = summary.graph
    return {
        "revision": summary.revision,
        "graph": graph
        and {
            "version": graph.version,
            "nodes": graph.nodes,
            "edges": graph.edges,
            "built_at": graph.built_at,
            "is_current": summary.graph_is_current,
        },
        "extent": summary.extent,
        "counts": summary.counts,
        "attribution": summary.attribution,
        "is_synthetic": summary.is_synthetic,
        "has_terrain": summary.has_terrain,
    }


def _limit(value_m: float | None, reference: str) -> dict[str, Any] | None:
    return None if value_m is None else {"value_m": value_m, "reference": reference}


def _source(data_import: DataImport | None) -> dict[str, Any] | None:
    if data_import is None:
        return None
    return {
        "file_name": data_import.file_name,
        "attribution": data_import.attribution,
        "is_synthetic": data_import.is_synthetic,
        "imported_at": data_import.imported_at,
    }
