"""The admin's pages for what came over the links: to be looked at only."""

from django.contrib import admin

from telemetry.models import UnknownVehicle
from workspace.admin import ReadOnlyAdmin


@admin.register(UnknownVehicle)
class UnknownVehicleAdmin(ReadOnlyAdmin):
    """They belong to no organisation: administrators adopt or ignore them on the page of the fleet."""

    list_display = ["mavlink_system_id", "autopilot", "vehicle_type", "address", "is_signed", "state", "heard_at", "uav", "settled_by"]
    list_filter = ["state", "autopilot", "is_signed"]
    list_select_related = ["uav", "settled_by"]
    search_fields = ["mavlink_system_id", "address", "uav__name"]
    date_hierarchy = "heard_at"
