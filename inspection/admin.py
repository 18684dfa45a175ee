"""The admin's pages for the ground: curators correct assets and zones here; imports and graphs can be looked at."""

from typing import Any

from django import forms
from django.contrib import admin, messages
from django.contrib.gis.db import models
from django.core.exceptions import ValidationError
from django.db.models import QuerySet
from django.http import HttpRequest
from django.utils.html import format_html
from django.utils.safestring import SafeString

from inspection import services
from inspection.admin_json import JSONObjectField, StrictJSONField
from inspection.admin_map import GeoJSONField
from inspection.models import (
    Asset,
    AssetKind,
    Bridge,
    DataImport,
    GraphSnapshot,
    Ground,
    NoFlyZone,
    PowerLine,
    PowerTower,
    Railway,
    TerrainTile,
    ZoneSet,
)
from inspection.osm.tags import MAX_HEIGHT_M
from inspection.selectors import asset_label
from workspace.admin import ReadOnlyAdmin

FORM_FIELDS = {models.GeometryField: {"form_class": GeoJSONField}, models.JSONField: {"form_class": StrictJSONField}}


class AssetForm(forms.ModelForm):
    kind: AssetKind | None = None
    tags = JSONObjectField(required=False, widget=forms.Textarea)

    def clean_height_m(self) -> float | None:
        height_m = self.cleaned_data["height_m"]
        if height_m is not None and not 0.0 < height_m <= MAX_HEIGHT_M:
            raise ValidationError(f"A height is above 0, up to {MAX_HEIGHT_M:g} m; empty when not known.", code="invalid")
        return height_m

    def clean(self) -> dict[str, Any]:
        cleaned = super().clean()
        kind = self.kind or cleaned.get("kind")
        geometry = cleaned.get("geometry")
        if geometry is not None and kind and (fault := services.geometry_fault(kind=AssetKind(kind), geometry=geometry)):
            self.add_error("geometry", ValidationError(fault))
        return cleaned


@admin.register(Asset)
class AssetAdmin(admin.ModelAdmin):
    """A saved asset counts as edited: imports leave it alone from then on."""

    form = AssetForm
    formfield_overrides = FORM_FIELDS
    kind: AssetKind | None = None  # of the pages that show one kind
    list_display = ["label", "kind", "subtype", "voltages", "operator", "osm", "is_flyable", "is_edited", "vanished_at"]
    list_filter = ["kind", "is_flyable", "is_edited", ("vanished_at", admin.EmptyFieldListFilter), "data_import"]
    search_fields = ["name", "ref", "operator", "=osm_id"]
    show_full_result_count = False
    autocomplete_fields = ["data_import"]
    readonly_fields = ["osm", "max_voltage_v", "length_m", "data_import", "is_edited", "created_at", "updated_at"]
    fieldsets = [
        (None, {"fields": ["kind", "subtype", "name", "ref", "operator", "is_flyable", "vanished_at"]}),
        ("Where", {"fields": ["geometry", "length_m"]}),
        ("Facts", {"fields": ["voltages_v", "max_voltage_v", "circuits", "height_m", "tags"]}),
        ("Source", {"fields": ["osm", "data_import", "is_edited", "created_at", "updated_at"]}),
    ]

    def get_queryset(self, request: HttpRequest) -> QuerySet[Asset]:
        return super().get_queryset(request).defer("node_osm_ids", "parts")

    def get_fieldsets(self, request: HttpRequest, obj: Any = None) -> Any:
        if self.kind is None:
            return self.fieldsets
        return [(name, {"fields": [field for field in options["fields"] if field != "kind"]}) for name, options in self.fieldsets]

    @admin.display(ordering="ref")
    def label(self, asset: Asset) -> str:
        return asset_label(asset)

    @admin.display(description="kV", ordering="max_voltage_v")
    def voltages(self, asset: Asset) -> str:
        return ", ".join(f"{voltage_v / 1000:g}" for voltage_v in asset.voltages_v)

    @admin.display(description="OSM", ordering="osm_id")
    def osm(self, asset: Asset) -> str | SafeString:
        if asset.osm_id is None:
            return "drawn here"
        kind = asset.get_osm_type_display().lower()
        return format_html('<a href="https://www.openstreetmap.org/{}/{}">{}{}</a>', kind, asset.osm_id, asset.osm_type, asset.osm_id)

    def save_model(self, request: HttpRequest, obj: Asset, form: Any, change: bool) -> None:
        obj.kind = self.kind or obj.kind
        services.save_asset(asset=obj, actor=request.user)

    def delete_model(self, request: HttpRequest, obj: Asset) -> None:
        services.delete_asset(asset=obj, actor=request.user)

    def delete_queryset(self, request: HttpRequest, queryset: QuerySet[Asset]) -> None:
        for asset in queryset:
            services.delete_asset(asset=asset, actor=request.user)


class _KindAdmin(AssetAdmin):
    """The pages of one kind: the kind is not asked for."""

    list_filter = [name for name in AssetAdmin.list_filter if name != "kind"]

    def get_form(self, request: HttpRequest, obj: Any = None, change: bool = False, **options: Any) -> Any:
        form = super().get_form(request, obj, change, **options)
        form.kind = self.kind
        if "geometry" in form.base_fields:
            form.base_fields["geometry"].widget.is_point = self.kind == AssetKind.TOWER
        return form


@admin.register(PowerTower)
class PowerTowerAdmin(_KindAdmin):
    kind = AssetKind.TOWER
    list_display = ["label", "subtype", "height_m", "operator", "osm", "is_flyable", "is_edited", "vanished_at"]


@admin.register(PowerLine)
class PowerLineAdmin(_KindAdmin):
    kind = AssetKind.LINE
    list_display = ["label", "subtype", "voltages", "circuits", "operator", "length_m", "osm", "is_flyable", "is_edited", "vanished_at"]


@admin.register(Railway)
class RailwayAdmin(_KindAdmin):
    kind = AssetKind.RAILWAY
    list_display = ["label", "subtype", "operator", "length_m", "osm", "is_flyable", "is_edited", "vanished_at"]


@admin.register(Bridge)
class BridgeAdmin(_KindAdmin):
    kind = AssetKind.BRIDGE
    list_display = ["label", "subtype", "operator", "osm", "is_flyable", "is_edited", "vanished_at"]


@admin.register(NoFlyZone)
class NoFlyZoneAdmin(admin.ModelAdmin):
    formfield_overrides = FORM_FIELDS
    list_display = ["name", "zone_set", "restriction", "lower_limit", "upper_limit", "is_permanent", "updated_at"]
    list_filter = ["zone_set", "restriction"]
    list_select_related = ["zone_set"]
    search_fields = ["name", "identifier", "reason"]
    readonly_fields = ["zone_set", "identifier", "layer", "source_heights", "circle", "properties", "created_at", "updated_at"]
    fieldsets = [
        (None, {"fields": ["name", "restriction", "reason"]}),
        ("Where", {"fields": ["geometry", "circle"]}),
        ("Heights", {"fields": ["lower_limit_m", "lower_reference", "upper_limit_m", "upper_reference", "source_heights"]}),
        ("Times", {"fields": ["schedule"]}),
        ("Source", {"fields": ["zone_set", "identifier", "layer", "properties", "created_at", "updated_at"]}),
    ]

    @admin.display(description="from")
    def lower_limit(self, zone: NoFlyZone) -> str:
        return _height(zone.lower_limit_m, zone.lower_reference)

    @admin.display(description="to")
    def upper_limit(self, zone: NoFlyZone) -> str:
        return _height(zone.upper_limit_m, zone.upper_reference)

    @admin.display(boolean=True, description="permanent")
    def is_permanent(self, zone: NoFlyZone) -> bool:
        return zone.schedule is None

    def save_model(self, request: HttpRequest, obj: NoFlyZone, form: Any, change: bool) -> None:
        services.save_zone(zone=obj, actor=request.user)
        if obj.zone_set is not None:
            messages.warning(request, f"This zone comes from {obj.zone_set}: the next import of that source replaces it.")

    def delete_model(self, request: HttpRequest, obj: NoFlyZone) -> None:
        services.delete_zone(zone=obj, actor=request.user)

    def delete_queryset(self, request: HttpRequest, queryset: QuerySet[NoFlyZone]) -> None:
        for zone in queryset:
            services.delete_zone(zone=zone, actor=request.user)


def _height(value_m: float | None, reference: str) -> str:
    return "not stated" if value_m is None else f"{value_m:g} m {reference}".strip()


@admin.register(ZoneSet)
class ZoneSetAdmin(ReadOnlyAdmin):
    list_display = ["name", "source_format", "data_import"]
    list_select_related = ["data_import"]
    search_fields = ["name"]


@admin.register(DataImport)
class DataImportAdmin(ReadOnlyAdmin):
    list_display = ["file_name", "kind", "is_synthetic", "data_timestamp", "imported_at", "imported_by", "attribution"]
    list_filter = ["kind", "is_synthetic"]
    list_select_related = ["imported_by"]
    search_fields = ["file_name", "sha256"]
    date_hierarchy = "imported_at"


@admin.register(TerrainTile)
class TerrainTileAdmin(ReadOnlyAdmin):
    list_display = ["__str__", "columns", "rows", "step_lon_deg", "step_lat_deg", "vertical_datum"]
    list_select_related = ["data_import"]
    exclude = ["heights_amsl_m", "extent"]

    def get_queryset(self, request: HttpRequest) -> QuerySet[TerrainTile]:
        return super().get_queryset(request).defer("heights_amsl_m")


@admin.register(GraphSnapshot)
class GraphSnapshotAdmin(ReadOnlyAdmin):
    list_display = ["version", "ground_revision", "nodes", "edges", "components", "excluded_nodes", "excluded_edges", "build_s", "built_at"]
    exclude = ["arrays"]

    def get_queryset(self, request: HttpRequest) -> QuerySet[GraphSnapshot]:
        return super().get_queryset(request).defer("arrays")


@admin.register(Ground)
class GroundAdmin(ReadOnlyAdmin):
    list_display = ["revision", "changed_at"]
