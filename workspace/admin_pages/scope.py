"""Restriction of the admin to rows of the user's organisation; installation operators see all."""

from typing import Any, ClassVar

from django.contrib import admin
from django.contrib.admin.filters import RelatedFieldListFilter
from django.db.models import Q, QuerySet
from django.forms import ModelForm
from django.http import HttpRequest

from workspace.api.signed_in import user_of
from workspace.models import Organisation

ORGANISATION = "organisation"


class OwnOrganisationForm(ModelForm):
    """Sets the organisation itself, so that uniqueness within it is validated."""

    organisation: ClassVar[Organisation]

    def __init__(self, *args: Any, **options: Any) -> None:
        super().__init__(*args, **options)
        if self.instance.pk is None:
            self.instance.organisation = self.organisation

    def _get_validation_exclusions(self) -> set[str]:
        exclusions: set[str] = super()._get_validation_exclusions()  # type: ignore[misc]
        return exclusions - {ORGANISATION}


class OwnRelatedFilter(RelatedFieldListFilter):
    """Offers only the rows that the related model's admin shows to this user."""

    def field_choices(self, field: Any, request: HttpRequest, model_admin: Any) -> Any:
        rows = rows_shown(model_admin.admin_site, field.remote_field.model, request)
        return field.get_choices(include_blank=False, limit_choices_to=None if rows is None else Q(pk__in=rows.values("pk")))


class OrganisationScopedAdmin(admin.ModelAdmin):
    """Filters rows, choices and filters by organisation. Every ModelAdmin inherits from it and sets `organisation_path`."""

    organisation_path: str | None = ORGANISATION  # lookup of the organisation; None: map data, which all organisations share
    is_for_operators_alone = False

    def get_queryset(self, request: HttpRequest) -> QuerySet[Any]:
        rows = super().get_queryset(request)
        user = user_of(request)
        if self.organisation_path is None or user.operates_installation:
            return rows
        return rows.filter(self.own_rows(user.organisation_id))

    def own_rows(self, organisation_id: int) -> Q:
        return Q(**{str(self.organisation_path): organisation_id})

    def get_list_filter(self, request: HttpRequest) -> list[Any]:
        filters = super().get_list_filter(request)
        if user_of(request).operates_installation:
            return list(filters)
        own = [one for one in filters if not (isinstance(one, str) and one.rpartition("__")[2] == ORGANISATION)]
        return [(one, OwnRelatedFilter) if isinstance(one, str) and self._is_relation(one) else one for one in own]

    def get_exclude(self, request: HttpRequest, obj: Any = None) -> list[str]:
        return [*(super().get_exclude(request, obj) or []), ORGANISATION]

    def get_form(self, request: HttpRequest, obj: Any = None, change: bool = False, **options: Any) -> Any:
        form = super().get_form(request, obj, change, **options)
        if self.organisation_path == ORGANISATION:
            return type(form.__name__, (form, OwnOrganisationForm), {ORGANISATION: user_of(request).organisation})
        return form

    def formfield_for_foreignkey(self, db_field: Any, request: HttpRequest, **options: Any) -> Any:
        rows = rows_shown(self.admin_site, db_field.remote_field.model, request)
        return super().formfield_for_foreignkey(db_field, request, **(options if rows is None else options | {"queryset": rows}))

    def has_module_permission(self, request: HttpRequest) -> bool:
        return self._is_open_to(request) and super().has_module_permission(request)

    def has_view_permission(self, request: HttpRequest, obj: Any = None) -> bool:
        return self._is_open_to(request) and super().has_view_permission(request, obj)

    def has_add_permission(self, request: HttpRequest) -> bool:
        return self._is_open_to(request) and super().has_add_permission(request)

    def has_change_permission(self, request: HttpRequest, obj: Any = None) -> bool:
        return self._is_open_to(request) and super().has_change_permission(request, obj)

    def has_delete_permission(self, request: HttpRequest, obj: Any = None) -> bool:
        return self._is_open_to(request) and super().has_delete_permission(request, obj)

    def _is_open_to(self, request: HttpRequest) -> bool:
        return not self.is_for_operators_alone or user_of(request).operates_installation

    def _is_relation(self, name: str) -> bool:
        return "__" not in name and self.opts.get_field(name).is_relation


def rows_shown(site: admin.AdminSite, model: Any, request: HttpRequest) -> QuerySet[Any] | None:
    """Return the rows of a model that this user sees in the admin; None where the model has no page."""
    return site.get_model_admin(model).get_queryset(request) if site.is_registered(model) else None
