"""Admin pages for assets, one for all kinds and one for each."""

from typing import Any

from django import forms
from django.contrib import admin
from django.contrib.gis.db import models
from django.core.exceptions import ValidationError
from django.db.models import Field, QuerySet
from django.http import HttpRequest
from django.utils.html import format_html
from django.utils.safestring import SafeString

from inspection import services
from inspection.admin.curated import CuratedAdmin, CuratedForm, expected_revision
from inspection.admin_map import GeoJSONField, JSONObjectField, StrictJSONField
from inspection.importers.osm.tags import MAX_HEIGHT_M
from inspection.models import Asset, AssetKind, Bridge, DataImport, ImportKind, PowerLine, PowerTower, Railway
from inspection.selectors import asset_label
from inspection.services.curation import many_edits
from workspace.api.signed_in import user_of

FORM_FIELDS: dict[type[Field], dict[str, Any]] = {
    models.GeometryField: {"form_class": GeoJSONField},
    models.JSONField: {"form_class": StrictJSONField},
}


class AssetForm(CuratedForm):
    history_subject = "asset"
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


class ImportFilter(admin.SimpleListFilter):
    """The newest imports that can contain assets; finding those that do would scan the whole table."""

    title = "import"
    parameter_name = "data_import"
    newest = 20

    def lookups(self, request: HttpRequest, model_admin: Any) -> list[tuple[str, str]]:
        imports = DataImport.objects.filter(kind__in=[ImportKind.OSM, ImportKind.ASSETS])[: self.newest]
        return [(str(row.pk), f"{row.file_name}, {row.imported_at:%d %b %Y}") for row in imports]

    def queryset(self, request: HttpRequest, queryset: QuerySet[Asset]) -> QuerySet[Asset]:
        chosen = self.value()
        return queryset.filter(data_import=int(chosen)) if chosen and chosen.isascii() and chosen.isdigit() else queryset


@admin.register(Asset)
class AssetAdmin(CuratedAdmin):
    """Assets; a saved one counts as edited, and imports no longer change it."""

    form = AssetForm
    history_subject = "asset"
    formfield_overrides = FORM_FIELDS
    kind: AssetKind | None = None  # on the pages of one kind
    list_display = ["label", "kind", "subtype", "voltages", "operator", "osm", "is_flyable", "is_edited", "vanished_at"]
    list_filter = ["kind", "is_flyable", "is_edited", ("vanished_at", admin.EmptyFieldListFilter), "asset_set", ImportFilter]
    search_fields = ["name", "ref", "operator", "=osm_id", "=source_key"]
    show_full_result_count = False
    actions = ["mark_flyable", "mark_not_flyable"]
    readonly_fields = [
        "osm",
        "asset_set",
        "source_key",
        "max_voltage_v",
        "length_m",
        "data_import",
        "is_edited",
        "created_at",
        "updated_at",
    ]
    fieldsets = [
        (None, {"fields": ["kind", "subtype", "name", "ref", "operator", "is_flyable", "vanished_at", "expected_revision"]}),
        ("Where", {"fields": ["geometry", "length_m"]}),
        ("Facts", {"fields": ["voltages_v", "max_voltage_v", "circuits", "height_m", "tags"]}),
        ("Source", {"fields": ["osm", "asset_set", "source_key", "data_import", "is_edited", "created_at", "updated_at"]}),
    ]

    def get_queryset(self, request: HttpRequest) -> QuerySet[Asset]:
        return super().get_queryset(request).select_related("asset_set").defer("node_osm_ids", "parts")

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

    @admin.display(description="source", ordering="osm_id")
    def osm(self, asset: Asset) -> str | SafeString:
        if asset.osm_id is None:
            return asset.asset_set.name if asset.asset_set else "drawn here"
        kind = asset.get_osm_type_display().lower()
        return format_html('<a href="https://www.openstreetmap.org/{}/{}">{}{}</a>', kind, asset.osm_id, asset.osm_type, asset.osm_id)

    def save_model(self, request: HttpRequest, obj: Asset, form: Any, change: bool) -> None:
        obj.kind = self.kind or obj.kind
        services.save_asset(asset=obj, actor=user_of(request), expected_revision=expected_revision(form))

    def delete_model(self, request: HttpRequest, obj: Asset) -> None:
        services.delete_asset(asset=obj, actor=user_of(request))

    def delete_queryset(self, request: HttpRequest, queryset: QuerySet[Asset]) -> None:
        with many_edits():
            for asset in queryset:
                services.delete_asset(asset=asset, actor=user_of(request))

    @admin.action(description="Mark the chosen as flyable", permissions=["change"])
    def mark_flyable(self, request: HttpRequest, queryset: QuerySet[Asset]) -> None:
        self._mark(request, queryset, is_flyable=True)

    @admin.action(description="Mark the chosen as not flyable", permissions=["change"])
    def mark_not_flyable(self, request: HttpRequest, queryset: QuerySet[Asset]) -> None:
        self._mark(request, queryset, is_flyable=False)

    def _mark(self, request: HttpRequest, queryset: QuerySet[Asset], *, is_flyable: bool) -> None:
        def mark(asset: Asset) -> None:
            asset.is_flyable = is_flyable
            services.save_asset(asset=asset, actor=user_of(request))

        if number := self.change_each(request, queryset.exclude(is_flyable=is_flyable), mark):
            self.message_user(request, f"{number} marked as {'flyable' if is_flyable else 'not flyable'}.")


class _KindAdmin(AssetAdmin):
    """The page of one kind, on which the kind is preset."""

    list_filter = [name for name in AssetAdmin.list_filter if name != "kind"]

    def get_form(self, request: HttpRequest, obj: Any = None, change: bool = False, **options: Any) -> Any:
        form = super().get_form(request, obj, change, **options)
        if issubclass(form, AssetForm):
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
