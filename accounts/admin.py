"""Admin pages of the workspace: users, tokens, and the read-only histories."""

from typing import Any

import django.contrib.auth.admin  # noqa: F401 - registers groups, also if this module is loaded first
from allauth.account.models import EmailAddress
from allauth.mfa.models import Authenticator
from allauth.socialaccount.models import SocialAccount, SocialApp, SocialToken
from django.contrib import admin, messages
from django.contrib.auth.models import Group
from django.db import transaction
from django.db.models import Count, QuerySet
from django.http import HttpRequest, HttpResponse, HttpResponseRedirect
from django.utils import timezone
from django.utils.safestring import SafeString

from accounts.invitations import InvitationState, in_state, revoke_invitation
from accounts.users import NoAdministratorLeft, OperatorsAlone, change_users, delete_user, save_user
from workspace.admin_pages.history import HistoryAdmin, as_table, what_changed
from workspace.admin_pages.scope import OrganisationScopedAdmin
from workspace.api.permissions import may_change
from workspace.api.signed_in import user_of
from workspace.models import DEFAULT_ORGANISATION_ID, ApiToken, AuditEntry, Invitation, Job, Organisation, Role, SignInEntry, User

admin.site.unregister(Group)  # permissions follow from the role
admin.site.unregister([EmailAddress, Authenticator, SocialAccount, SocialApp, SocialToken])  # rows of all organisations


class ReadOnlyAdmin(OrganisationScopedAdmin):
    """Read-only admin for rows that the program writes."""

    def has_add_permission(self, request: HttpRequest) -> bool:
        return False

    def has_change_permission(self, request: HttpRequest, obj: Any = None) -> bool:
        return False

    def has_delete_permission(self, request: HttpRequest, obj: Any = None) -> bool:
        return False


@admin.register(Organisation)
class OrganisationAdmin(OrganisationScopedAdmin):
    """Organisations, for installation operators. One with missions or history can be renamed, but not deleted."""

    organisation_path = "pk"
    is_for_operators_alone = True

    list_display = ["name", "user_count", "created_at"]
    search_fields = ["name"]

    def get_queryset(self, request: HttpRequest) -> QuerySet[Organisation]:
        return super().get_queryset(request).annotate(user_count=Count("users"))

    @admin.display(ordering="user_count")
    def user_count(self, organisation: Any) -> int:
        return int(organisation.user_count)

    def has_delete_permission(self, request: HttpRequest, obj: Any = None) -> bool:
        if obj is None:
            return super().has_delete_permission(request)
        return obj.pk != DEFAULT_ORGANISATION_ID and not any(
            relation.related_model._base_manager.filter(**{relation.field.name: obj}).exists() for relation in obj._meta.related_objects
        )


@admin.register(User)
class UserAdmin(HistoryAdmin):
    """Accounts and their roles. At least one administrator who can log in remains. New users are invited and set their own password."""

    history_subject = "user"
    list_display = ["username", "first_name", "last_name", "email", "role", "organisation", "is_active", "last_login"]
    list_filter = ["role", "is_active", "organisation", "last_login"]
    list_select_related = ["organisation"]
    search_fields = ["username", "first_name", "last_name", "email", "organisation__name"]
    filter_horizontal = []
    readonly_fields = ["organisation", "is_service", "last_login", "last_seen_at", "date_joined"]
    fieldsets = [
        (None, {"fields": ["username", "role", "organisation", "is_active", "is_service"]}),
        ("Person", {"fields": ["first_name", "last_name", "email"]}),
        ("Preferences", {"fields": ["theme", "units", "time_zone", "language", "single_keys"]}),
        ("Times", {"fields": ["last_login", "last_seen_at", "date_joined"]}),
    ]
    actions = ["let_in", "keep_out", "make_viewers", "make_operators", "make_curators", "make_administrators"]

    def get_readonly_fields(self, request: HttpRequest, obj: Any = None) -> Any:
        """Return the read-only fields: a service account keeps its name, and has no personal name or mail address."""
        fixed = ["username", "first_name", "last_name", "email"] if obj is not None and obj.is_service else []
        return [*super().get_readonly_fields(request, obj), *fixed]

    def lookup_allowed(self, lookup: str, value: str, request: HttpRequest) -> bool:
        return not lookup.startswith("password") and super().lookup_allowed(lookup, value, request)

    def has_add_permission(self, request: HttpRequest) -> bool:
        return False

    def has_change_permission(self, request: HttpRequest, obj: Any = None) -> bool:
        return (obj is None or may_change(user_of(request), obj)) and super().has_change_permission(request, obj)

    def has_delete_permission(self, request: HttpRequest, obj: Any = None) -> bool:
        return (obj is None or may_change(user_of(request), obj)) and super().has_delete_permission(request, obj)

    def changeform_view(self, request: HttpRequest, *args: Any, **options: Any) -> HttpResponse:
        return self._unless_last(request, super().changeform_view, *args, **options)

    def delete_view(self, request: HttpRequest, *args: Any, **options: Any) -> HttpResponse:
        return self._unless_last(request, super().delete_view, *args, **options)

    def changelist_view(self, request: HttpRequest, *args: Any, **options: Any) -> HttpResponse:
        return self._unless_last(request, super().changelist_view, *args, **options)

    def save_model(self, request: HttpRequest, obj: User, form: Any, change: bool) -> None:
        save_user(user=obj, actor=user_of(request))

    def delete_model(self, request: HttpRequest, obj: User) -> None:
        delete_user(user=obj, actor=user_of(request))

    def delete_queryset(self, request: HttpRequest, queryset: QuerySet[User]) -> None:
        with transaction.atomic():
            for user in queryset:
                delete_user(user=user, actor=user_of(request))

    @admin.action(description="Let the chosen sign in", permissions=["change"])
    def let_in(self, request: HttpRequest, queryset: QuerySet[User]) -> None:
        self._change(request, queryset, "may sign in", is_active=True)

    @admin.action(description="Keep the chosen out", permissions=["change"])
    def keep_out(self, request: HttpRequest, queryset: QuerySet[User]) -> None:
        self._change(request, queryset, "can no longer sign in", is_active=False)

    @admin.action(description="Make the chosen viewers", permissions=["change"])
    def make_viewers(self, request: HttpRequest, queryset: QuerySet[User]) -> None:
        self._change(request, queryset, "made viewers", role=Role.VIEWER)

    @admin.action(description="Make the chosen operators", permissions=["change"])
    def make_operators(self, request: HttpRequest, queryset: QuerySet[User]) -> None:
        self._change(request, queryset, "made operators", role=Role.OPERATOR)

    @admin.action(description="Make the chosen curators", permissions=["change"])
    def make_curators(self, request: HttpRequest, queryset: QuerySet[User]) -> None:
        self._change(request, queryset, "made curators", role=Role.CURATOR)

    @admin.action(description="Make the chosen administrators", permissions=["change"])
    def make_administrators(self, request: HttpRequest, queryset: QuerySet[User]) -> None:
        self._change(request, queryset, "made administrators", role=Role.ADMINISTRATOR)

    def _change(self, request: HttpRequest, queryset: QuerySet[User], words: str, **change: Any) -> None:
        changed = change_users(users=queryset, actor=user_of(request), **change)
        self.message_user(request, f"{changed} {words}.")

    def _unless_last(self, request: HttpRequest, view: Any, *args: Any, **options: Any) -> HttpResponse:
        try:
            return view(request, *args, **options)
        except (NoAdministratorLeft, OperatorsAlone) as error:
            messages.error(request, f"{error} Nothing was changed.")
            return HttpResponseRedirect(request.get_full_path())


@admin.register(ApiToken)
class ApiTokenAdmin(OrganisationScopedAdmin):
    """Tokens, which their owner or `manage.py api_token` makes and sees once; here they are revoked."""

    organisation_path = "user__organisation"

    list_display = ["name", "user", "created_at", "expires_at", "revoked_at", "last_used_at"]
    list_filter = ["expires_at", "revoked_at"]
    list_select_related = ["user"]
    search_fields = ["name", "user__username"]
    readonly_fields = ["name", "user", "created_at", "expires_at", "revoked_at", "last_used_at"]
    fields = [*readonly_fields]
    actions = ["revoke"]

    def has_add_permission(self, request: HttpRequest) -> bool:
        return False

    @admin.action(description="Revoke the chosen tokens", permissions=["change"])
    def revoke(self, request: HttpRequest, queryset: Any) -> None:
        revoked = queryset.filter(revoked_at=None).update(revoked_at=timezone.now())
        self.message_user(request, f"{revoked} revoked.")


@admin.register(Invitation)
class InvitationAdmin(ReadOnlyAdmin):
    """Invitations, which the administration page makes, showing their link once; here they are revoked."""

    list_display = ["email", "role", "organisation", "invited_by", "created_at", "expires_at", "revoked_at", "accepted_at", "accepted_by"]
    list_filter = ["role", "organisation", "accepted_at", "revoked_at"]
    list_select_related = ["organisation", "invited_by", "accepted_by"]
    search_fields = ["email", "invited_by__username", "accepted_by__username"]
    fields = ["organisation", "email", "role", "invited_by", "created_at", "expires_at", "revoked_at", "accepted_at", "accepted_by"]
    actions = ["take_back"]

    @admin.action(description="Take the chosen invitations back", permissions=["view"])
    def take_back(self, request: HttpRequest, queryset: QuerySet[Invitation]) -> None:
        waiting = queryset.filter(in_state(InvitationState.OPEN))
        revoked = [revoke_invitation(invitation=invitation, actor=user_of(request)) for invitation in waiting]
        self.message_user(request, f"{len(revoked)} taken back.")


@admin.register(SignInEntry)
class SignInEntryAdmin(ReadOnlyAdmin):
    """The sign-in log. Tries with unknown names belong to no organisation: installation operators see them here."""

    organisation_path = "user__organisation"
    list_display = ["recorded_at", "outcome", "user", "address", "user_agent"]
    list_filter = ["outcome", "recorded_at"]
    list_select_related = ["user"]
    search_fields = ["user__username", "user__email", "=address"]
    date_hierarchy = "recorded_at"


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
    list_filter = ["subject_type", "action", "organisation"]
    list_select_related = ["actor", "organisation"]
    search_fields = ["=subject_id", "actor__username", "actor__first_name", "actor__last_name"]
    fields = ["recorded_at", "actor", "action", "subject_type", "subject_id", "organisation", "changes"]
    readonly_fields = ["changes"]
    date_hierarchy = "recorded_at"

    @admin.display(description="what changed")
    def changes(self, entry: AuditEntry) -> SafeString:
        return as_table(what_changed(entry))
