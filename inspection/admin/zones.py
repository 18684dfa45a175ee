"""Admin pages for zones, zone sets, their versions, and subscriptions."""

from typing import Any

from django.contrib import admin, messages
from django.contrib.gis.db import models
from django.core.exceptions import ValidationError
from django.db.models import Count, Field, QuerySet
from django.http import HttpRequest

from inspection import services
from inspection.admin.curated import CommonGroundAdmin, CuratedAdmin, CuratedForm, expected_revision
from inspection.admin_map import GeoJSONField, StrictJSONField
from inspection.geodesy.geometry_validator import GeometryFault
from inspection.models import NoFlyZone, ZoneSet, ZoneSetVersion, ZoneSubscription
from inspection.services.imports.subscriptions import change_subscription
from inspection.zones.schedule import checked_schedule
from workspace.api.signed_in import user_of

FORM_FIELDS: dict[type[Field], dict[str, Any]] = {
    models.GeometryField: {"form_class": GeoJSONField},
    models.JSONField: {"form_class": StrictJSONField},
}


class ZoneForm(CuratedForm):
    history_subject = "zone"

    def clean_schedule(self) -> Any:
        """Return the schedule as stored: None means always."""
        schedule = self.cleaned_data["schedule"]
        try:
            return None if schedule is None else checked_schedule(schedule, "schedule")
        except GeometryFault as fault:
            raise ValidationError(str(fault), code="invalid") from fault


@admin.register(NoFlyZone)
class NoFlyZoneAdmin(CuratedAdmin):
    form = ZoneForm
    history_subject = "zone"
    formfield_overrides = FORM_FIELDS
    list_display = ["name", "zone_set", "restriction", "lower_limit", "upper_limit", "is_permanent", "is_edited", "updated_at"]
    list_filter = ["zone_set", "restriction", "is_edited", ("schedule", admin.EmptyFieldListFilter)]
    list_select_related = ["zone_set"]
    search_fields = ["name", "identifier", "reason"]
    readonly_fields = ["zone_set", "identifier", "layer", "source_heights", "circle", "properties", "is_edited", "created_at", "updated_at"]
    fieldsets = [
        (None, {"fields": ["name", "restriction", "reason", "expected_revision"]}),
        ("Where", {"fields": ["geometry", "circle"]}),
        ("Heights", {"fields": ["lower_limit_m", "lower_reference", "upper_limit_m", "upper_reference", "source_heights"]}),
        ("Times", {"fields": ["schedule"]}),
        ("Source", {"fields": ["zone_set", "identifier", "layer", "properties", "is_edited", "created_at", "updated_at"]}),
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
        services.save_zone(zone=obj, actor=user_of(request), expected_revision=expected_revision(form))
        if obj.zone_set is not None:
            messages.info(request, f"This zone comes from {obj.zone_set}: imports of that source leave it alone from now on.")

    def delete_model(self, request: HttpRequest, obj: NoFlyZone) -> None:
        services.delete_zone(zone=obj, actor=user_of(request))

    def delete_queryset(self, request: HttpRequest, queryset: QuerySet[NoFlyZone]) -> None:
        for zone in queryset:
            services.delete_zone(zone=zone, actor=user_of(request))


def _height(value_m: float | None, reference: str) -> str:
    return "not stated" if value_m is None else f"{value_m:g} m {reference}".strip()


@admin.register(ZoneSet)
class ZoneSetAdmin(CommonGroundAdmin):
    list_display = ["name", "number_of_zones", "source_format", "data_import"]
    list_select_related = ["data_import"]
    search_fields = ["name"]

    def get_queryset(self, request: HttpRequest) -> QuerySet[ZoneSet]:
        return super().get_queryset(request).annotate(number_of_zones=Count("zones"))

    @admin.display(description="zones", ordering="number_of_zones")
    def number_of_zones(self, zone_set: Any) -> int:
        return int(zone_set.number_of_zones)


@admin.register(ZoneSetVersion)
class ZoneSetVersionAdmin(CommonGroundAdmin):
    """Versions of zone sets; a rollback is made on the zones page, which first shows the difference."""

    list_display = ["zone_set", "number", "zones", "data_import", "created_by", "created_at"]
    list_filter = ["zone_set"]
    list_select_related = ["zone_set", "data_import", "created_by"]
    exclude = ["content"]

    def get_queryset(self, request: HttpRequest) -> QuerySet[ZoneSetVersion]:
        return super().get_queryset(request).defer("content")


@admin.register(ZoneSubscription)
class ZoneSubscriptionAdmin(CommonGroundAdmin):
    """Subscriptions, made and changed on the zones page; here several are paused or resumed at once."""

    list_display = ["zone_set", "address", "interval_h", "is_active", "fetched_at", "next_fetch_at", "problem"]
    list_filter = ["is_active", ("problem", admin.EmptyFieldListFilter)]
    list_select_related = ["zone_set"]
    search_fields = ["zone_set__name", "address"]
    actions = ["pause", "resume"]

    @admin.action(description="Pause the chosen subscriptions", permissions=["view"])
    def pause(self, request: HttpRequest, queryset: QuerySet[ZoneSubscription]) -> None:
        self._set(request, queryset, is_active=False)

    @admin.action(description="Resume the chosen subscriptions", permissions=["view"])
    def resume(self, request: HttpRequest, queryset: QuerySet[ZoneSubscription]) -> None:
        self._set(request, queryset, is_active=True)

    def _set(self, request: HttpRequest, queryset: QuerySet[ZoneSubscription], *, is_active: bool) -> None:
        chosen = list(queryset.exclude(is_active=is_active))
        for subscription in chosen:
            change_subscription(subscription=subscription, actor=user_of(request), is_active=is_active)
        self.message_user(request, f"{len(chosen)} {'resumed' if is_active else 'paused'}.")
