"""Read-only admin pages for what the links received."""

from django.contrib import admin
from django.db.models import Q

from accounts.admin import ReadOnlyAdmin
from telemetry.models import UnknownVehicle


@admin.register(UnknownVehicle)
class UnknownVehicleAdmin(ReadOnlyAdmin):
    """Unknown vehicles. They belong to no organisation until adopted; administrators adopt or ignore them on the fleet page."""

    organisation_path = "uav__organisation"

    list_display = [
        "mavlink_system_id",
        "autopilot",
        "vehicle_type",
        "address",
        "is_signed",
        "state",
        "last_message_at",
        "uav",
        "settled_by",
    ]
    list_filter = ["state", "autopilot", "is_signed"]
    list_select_related = ["uav", "settled_by"]
    search_fields = ["mavlink_system_id", "address", "uav__name"]
    date_hierarchy = "last_message_at"

    def own_rows(self, organisation_id: int) -> Q:
        is_unsettled = Q(uav=None) & (Q(settled_by=None) | Q(settled_by__organisation=organisation_id))
        return super().own_rows(organisation_id) | is_unsettled
