"""The admin's geometry field: a map without external resources, and its GeoJSON text."""

import json
from typing import Any

import shapely
from django import forms
from django.conf import settings
from django.contrib.gis.geos import GEOSGeometry
from django.core.exceptions import ValidationError
from django.forms.fields import InvalidJSONInput
from django.forms.widgets import Script

from inspection.geodesy.geometry_validator import GeometryFault, checked_geometry
from inspection.importers.strict_json import JsonFault, can_be_stored, parse_strict_json
from inspection.services.facts import coordinates_of

WGS84_SRID = 4326
AREA_TYPES = {"POLYGON", "MULTIPOLYGON"}


class MapWidget(forms.Textarea):
    """A map beside the text: it shows the text's geometry, and a point can be dragged."""

    template_name = "admin/map_widget.html"
    is_point = False

    class Media:
        css = {"all": ["lib/maplibre-gl/maplibre-gl.css"]}
        js = [Script("js/admin/geometry_map.js", type="module")]

    def __init__(self, attrs: dict[str, Any] | None = None) -> None:
        super().__init__({"rows": 6, "cols": 80, "spellcheck": "false", **(attrs or {})})

    def get_context(self, name: str, value: Any, attrs: dict[str, Any] | None) -> dict[str, Any]:
        context = super().get_context(name, value, attrs)
        context["widget"]["is_point"] = self.is_point
        return context


class GeoJSONField(forms.Field):
    """GeoJSON text that passes the geometry validator; invalid text is shown again with the place of the fault."""

    widget = MapWidget

    def __init__(self, *, geom_type: str, srid: int, max_geom_collections: int | None = None, **options: Any) -> None:
        """Take srid and max_geom_collections from the model field: the validator accepts only WGS84, and no collections."""
        super().__init__(**options)
        self.geom_type = geom_type
        self.widget.is_point = geom_type == "POINT"

    def prepare_value(self, value: Any) -> Any:
        if not isinstance(value, GEOSGeometry):
            return value
        return json.dumps({"type": value.geom_type, "coordinates": coordinates_of(value)})

    def to_python(self, value: Any) -> GEOSGeometry | None:
        if value in self.empty_values or not str(value).strip():
            return None
        try:
            shape = checked_geometry(parse_strict_json(str(value), max_bytes=settings.DATA_UPLOAD_MAX_MEMORY_SIZE))
        except (JsonFault, GeometryFault) as fault:
            raise ValidationError(str(fault), code="invalid") from fault
        wanted = AREA_TYPES if self.geom_type in AREA_TYPES else {self.geom_type}
        if self.geom_type != "GEOMETRY" and shape.geom_type.upper() not in wanted:
            raise ValidationError(f"A {self.geom_type.capitalize()} is needed here, not a {shape.geom_type}.", code="invalid")
        return GEOSGeometry(memoryview(shapely.to_wkb(shape)), srid=WGS84_SRID)

    def has_changed(self, initial: Any, data: Any) -> bool:
        try:
            return bool(self.to_python(self.prepare_value(initial)) != self.to_python(data))
        except ValidationError:
            return True


class StrictJSONField(forms.JSONField):
    """Refuses invalid JSON (NaN, endless nesting) and values that PostgreSQL cannot store, and shows the text again with the fault."""

    def to_python(self, value: Any) -> Any:
        if isinstance(value, str) and value.strip():
            try:
                parsed = parse_strict_json(value, max_bytes=settings.DATA_UPLOAD_MAX_MEMORY_SIZE)
            except JsonFault as fault:
                raise ValidationError(str(fault), code="invalid") from fault
            if not can_be_stored(parsed):
                raise ValidationError("The texts have characters that are none.", code="invalid")
        return super().to_python(value)

    def bound_data(self, data: Any, initial: Any) -> Any:
        try:
            bound = super().bound_data(data, initial)
        except (ValueError, RecursionError):
            return InvalidJSONInput(data)
        return bound if can_be_stored(bound) else InvalidJSONInput(data)


class JSONObjectField(StrictJSONField):
    """A JSON object: a mapping of names to values."""

    def to_python(self, value: Any) -> Any:
        value = {} if value in self.empty_values else super().to_python(value)
        if not isinstance(value, dict):
            raise ValidationError('An object is needed here, such as {"power": "tower"}.', code="invalid")
        return value
