"""Admin pages for missions and UAVs. Missions are changed on the operator's map and are read-only here."""

from typing import Any

from django.contrib import admin
from django.contrib.gis.db import models
from django.db.models import QuerySet
from django.http import HttpRequest

from accounts.admin import ReadOnlyAdmin
from inspection.admin_map import GeoJSONField
from missions.models import (
    Approval,
    Base,
    InspectionTarget,
    Mission,
    MissionUav,
    Route,
    Uav,
    UavCommand,
    UavCommandEvent,
    UavCredential,
    UavType,
    Waypoint,
)
from missions.services.fleet.link_changes import removal_reasons
from workspace.admin_pages.history import HistoryAdmin
from workspace.api.signed_in import user_of
from workspace.audit import record_change


class _FleetAdmin(HistoryAdmin):
    """Admin whose changes count as changes on the fleet page: they increment the revision and enter the history."""

    def save_model(self, request: HttpRequest, obj: Any, form: Any, change: bool) -> None:
        if change:
            obj.revision += 1
        super().save_model(request, obj, form, change)
        record_change(
            organisation=obj.organisation, actor=user_of(request), action="change" if change else "create",
            subject_type=self.history_subject, subject_id=obj.pk, after={name: str(form.cleaned_data[name]) for name in form.changed_data},
        )  # fmt: skip


@admin.register(Uav)
class UavAdmin(_FleetAdmin):
    history_subject = "uav"
    formfield_overrides = {models.GeometryField: {"form_class": GeoJSONField}}
    list_display = ["name", "state", "uav_type", "base_name", "battery_percent", "located_at", "mavlink_system_id", "link", "organisation"]
    list_filter = ["state", "link", "is_simulated", "allows_unsigned", "uav_type", "base_name", "end_action", "organisation"]
    list_select_related = ["uav_type", "organisation"]
    search_fields = ["name", "base_name", "serial_number", "uav_type__name"]
    readonly_fields = [  # the fleet page changes the first ones, as it protects UAVs in flight
        "state", "link", "mavlink_system_id", "allows_unsigned", "is_simulated", "is_demo",
        "autopilot_return", "autopilot_return_read_at", "revision", "created_at", "updated_at",
    ]  # fmt: skip

    def get_deleted_objects(self, objs: Any, request: HttpRequest) -> tuple[Any, Any, Any, list[Any]]:
        """Return Django's result with the reasons why a UAV must stay among the protected objects, so that it cannot be deleted."""
        objects, counts, permissions, protected = super().get_deleted_objects(objs, request)
        return objects, counts, permissions, [*protected, *(reason.message for uav in objs for reason in removal_reasons(uav))]


@admin.register(UavType)
class UavTypeAdmin(_FleetAdmin):
    history_subject = "uav_type"
    list_display = ["name", "max_range_m", "cruise_speed_mps", "battery_wh", "mass_kg", "sensors", "organisation"]
    list_filter = ["organisation"]
    list_select_related = ["organisation"]
    search_fields = ["name"]
    readonly_fields = ["revision", "created_at", "updated_at"]


@admin.register(Base)
class BaseAdmin(_FleetAdmin):
    history_subject = "base"
    formfield_overrides = {models.GeometryField: {"form_class": GeoJSONField}}
    list_display = ["name", "note", "organisation"]
    list_filter = ["organisation"]
    list_select_related = ["organisation"]
    search_fields = ["name", "note"]
    readonly_fields = ["revision", "created_at", "updated_at"]


@admin.register(UavCredential)
class UavCredentialAdmin(ReadOnlyAdmin):
    """Credentials, read-only: they are made and revoked on the fleet page, where the secret can be shown once."""

    organisation_path = "uav__organisation"
    list_display = ["uav", "kind", "created_by", "created_at", "last_used_at", "revoked_at"]
    list_filter = ["kind", ("revoked_at", admin.EmptyFieldListFilter)]
    list_select_related = ["uav", "created_by"]
    search_fields = ["uav__name"]
    exclude = ["token_sha256", "key_salt"]


class _ReadOnlyInline(admin.TabularInline):
    extra = 0
    can_delete = False
    show_change_link = True

    def has_add_permission(self, request: HttpRequest, obj: Any = None) -> bool:
        return False

    def has_change_permission(self, request: HttpRequest, obj: Any = None) -> bool:
        return False


class MissionUavInline(_ReadOnlyInline):
    model = MissionUav
    fields = ["sequence", "name", "max_range_m", "cruise_speed_mps", "end_action", "most_targets", "sensors"]


class TargetInline(_ReadOnlyInline):
    model = InspectionTarget
    fields = ["sequence", "label", "priority", "uav_name", "sensor", "state", "unassigned_reason"]


class RouteInline(_ReadOnlyInline):
    model = Route
    fk_name = "mission"
    fields = ["mission_uav", "length_m", "duration_s"]


@admin.register(Mission)
class MissionAdmin(ReadOnlyAdmin):
    list_display = ["name", "state", "objective", "total_length_m", "longest_route_m", "author", "organisation", "updated_at", "deleted_at"]
    list_filter = ["state", "objective", "organisation", ("deleted_at", admin.EmptyFieldListFilter)]
    list_select_related = ["author", "organisation"]
    search_fields = ["name", "author__username"]
    date_hierarchy = "updated_at"
    inlines = [MissionUavInline, TargetInline, RouteInline]


@admin.register(MissionUav)
class MissionUavAdmin(ReadOnlyAdmin):
    organisation_path = "mission__organisation"
    list_display = ["name", "mission", "sequence", "max_range_m", "cruise_speed_mps", "end_action", "most_targets"]
    list_select_related = ["mission"]
    search_fields = ["name", "mission__name"]


@admin.register(InspectionTarget)
class InspectionTargetAdmin(ReadOnlyAdmin):
    organisation_path = "mission__organisation"
    list_display = ["label", "mission", "sequence", "priority", "uav_name", "sensor", "state", "unassigned_reason"]
    list_filter = ["state", "priority", "unassigned_reason"]
    list_select_related = ["mission"]
    search_fields = ["label", "mission__name"]


@admin.register(Route)
class RouteAdmin(ReadOnlyAdmin):
    organisation_path = "mission__organisation"
    list_display = ["mission", "mission_uav", "length_m", "duration_s", "graph_version"]
    list_select_related = ["mission", "mission_uav"]
    search_fields = ["mission__name", "mission_uav__name"]
    exclude = ["geometry"]


@admin.register(Waypoint)
class WaypointAdmin(ReadOnlyAdmin):
    organisation_path = "route__mission__organisation"
    list_display = ["route", "sequence", "kind", "altitude_agl_m", "altitude_amsl_m", "altitude_relative_m"]
    list_filter = ["kind"]
    search_fields = ["route__mission__name"]
    show_full_result_count = False

    def get_queryset(self, request: HttpRequest) -> QuerySet[Waypoint]:
        return super().get_queryset(request).select_related("route__mission", "route__mission_uav")


@admin.register(Approval)
class ApprovalAdmin(ReadOnlyAdmin):
    """Approvals without their document, which is long: the API serves it, and its hash names it."""

    organisation_path = "mission__organisation"
    list_display = ["mission", "approved_by", "approved_at", "revoke_requested_at", "revoked_at", "content_sha256"]
    list_filter = ["mission__organisation", ("revoked_at", admin.EmptyFieldListFilter)]
    list_select_related = ["mission", "approved_by"]
    search_fields = ["mission__name", "approved_by__username", "content_sha256"]
    date_hierarchy = "approved_at"
    exclude = ["document"]


class UavCommandEventInline(_ReadOnlyInline):
    model = UavCommandEvent
    fields = ["recorded_at", "state", "attempt", "holder", "note"]
    readonly_fields = ["recorded_at"]
    show_change_link = False


@admin.register(UavCommand)
class UavCommandAdmin(ReadOnlyAdmin):
    """Commands, read-only: they are given on the mission's page and delivered by the links only."""

    list_display = [
        "created_at",
        "uav",
        "kind",
        "state",
        "mission",
        "created_by",
        "attempts",
        "finished_at",
        "outcome_code",
        "organisation",
    ]
    list_filter = ["state", "kind", "link", "organisation"]
    list_select_related = ["uav", "mission", "created_by", "organisation"]
    search_fields = ["uav__name", "mission__name", "created_by__username", "outcome_code", "outcome"]
    date_hierarchy = "created_at"
    inlines = [UavCommandEventInline]
