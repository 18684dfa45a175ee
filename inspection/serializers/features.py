"""Common parts of map data shapes: GeoJSON features and collections, and sources."""

from typing import Any

from rest_framework import serializers

from inspection.models import DataImport


class GeometrySerializer(serializers.Serializer):
    """A GeoJSON geometry, WGS84, longitude first."""

    type = serializers.ChoiceField(choices=["Point", "MultiPoint", "LineString", "MultiLineString", "Polygon", "MultiPolygon"])
    coordinates = serializers.ListField(child=serializers.JSONField())


class SourceSerializer(serializers.Serializer):
    """The file that a row came from."""

    file_name = serializers.CharField()
    attribution = serializers.CharField(help_text="author and licence")
    licence = serializers.CharField(help_text="empty when nobody stated it")
    source_address = serializers.CharField(help_text="empty for a file that somebody sent")
    fetched_at = serializers.DateTimeField(allow_null=True)
    valid_from = serializers.DateTimeField(allow_null=True, help_text="as the file states it")
    valid_until = serializers.DateTimeField(allow_null=True, help_text="as the file states it")
    is_synthetic = serializers.BooleanField()
    imported_at = serializers.DateTimeField()


def feature_serializer(name: str, properties: type[serializers.Serializer]) -> type[serializers.Serializer]:
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


def collection_serializer(name: str, feature: type[serializers.Serializer]) -> type[serializers.Serializer]:
    return type(
        f"{name}Serializer",
        (serializers.Serializer,),
        {
            "type": serializers.ChoiceField(choices=["FeatureCollection"]),
            "features": feature(many=True),
            "next": serializers.CharField(allow_null=True, help_text="address of the next page"),
        },
    )


def source_json(data_import: DataImport | None) -> dict[str, Any] | None:
    if data_import is None:
        return None
    names = (
        "file_name", "attribution", "licence", "source_address", "fetched_at", "valid_from", "valid_until", "is_synthetic", "imported_at",
    )  # fmt: skip
    return {name: getattr(data_import, name) for name in names}
