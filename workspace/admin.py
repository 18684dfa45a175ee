"""The admin's pages for the workspace: people, tokens, and the histories that nobody edits."""

from typing import Any

from django.contrib import admin
from django.contrib.auth.admin import UserAdmin as DjangoUserAdmin
from django.contrib.auth.models import Group
from django.http import HttpRequest
from django.utils import timezone

from workspace.models import ApiToken, AuditEntry, Job, Organisation, User

admin.site.unregister(Group)  # what somebody may do follows from the role


class ReadOnlyAdmin(admin.ModelAdmin):
    """Rows that the program writes: they can be looked at."""

    def has_add_permission(self, request: HttpRequest) -> bool:
        return False

    def has_change_permission(self, request: HttpRequest, obj: Any = None) -> bool:
        return False

    def has_delete_permission(self, request: HttpRequest, obj: Any = None) -> bool:
        return False


@admin.register(Organisation)
class OrganisationAdmin(admin.ModelAdmin):
    list_display = ["name", "created_at"]
    search_fields = ["name"]


@admin.register(User)
class UserAdmin(DjangoUserAdmin):
    list_display = ["username", "first_name", "last_name", "role", "organisation", "is_active", "last_login"]
    list_filter = ["role", "is_active", "organisation"]
    list_select_related = ["organisation"]
    filter_horizontal = []
    readonly_fields = ["last_login", "date_joined"]
    fieldsets = [
        (None, {"fields": ["username", "password", "role", "organisation", "is_active"]}),
        ("Person", {"fields": ["first_name", "last_name", "email"]}),
        ("Times", {"fields": ["last_login", "date_joined"]}),
    ]
    add_fieldsets = [(None, {"fields": ["username", "usable_password", "password1", "password2", "role", "organisation"]})]


@admin.register(ApiToken)
class ApiTokenAdmin(admin.ModelAdmin):
    """Tokens are made by `manage.py api_token`, which shows them once; here they are revoked."""

    list_display = ["name", "user", "created_at", "expires_at", "revoked_at"]
    list_filter = ["expires_at", "revoked_at"]
    list_select_related = ["user"]
    search_fields = ["name", "user__username"]
    fields = ["name", "user", "created_at", "expires_at", "revoked_at"]
    readonly_fields = fields
    actions = ["revoke"]

    def has_add_permission(self, request: HttpRequest) -> bool:
        return False

    @admin.action(description="Revoke the chosen tokens", permissions=["change"])
    def revoke(self, request: HttpRequest, queryset: Any) -> None:
        revoked = queryset.filter(revoked_at=None).update(revoked_at=timezone.now())
        self.message_user(request, f"{revoked} revoked.")


@admin.register(Job)
class JobAdmin(ReadOnlyAdmin):
    list_display = ["id", "task", "state", "progress", "message", "created_by", "organisation", "created_at", "finished_at"]
    list_filter = ["state", "task", "organisation"]
    list_select_related = ["created_by", "organisation"]
    search_fields = ["id", "task", "message"]
    date_hierarchy = "created_at"


@admin.register(AuditEntry)
class AuditEntryAdmin(ReadOnlyAdmin):
    list_display = ["recorded_at", "actor", "action", "subject_type", "subject_id", "organisation"]
    list_filter = ["action", "subject_type", "organisation"]
    list_select_related = ["actor", "organisation"]
    search_fields = ["subject_id", "actor__username"]
    date_hierarchy = "recorded_at"
