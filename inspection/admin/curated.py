"""Base of the admin pages of assets and zones: no lost updates, and a complete history."""

from collections.abc import Callable, Iterable
from typing import Any, ClassVar

from django import forms
from django.contrib import messages
from django.core.exceptions import ValidationError
from django.db.models import QuerySet
from django.http import HttpRequest, HttpResponse, HttpResponseRedirect

from accounts.admin import ReadOnlyAdmin
from inspection.services import StaleRevision
from inspection.services.curation import many_edits
from workspace.admin_pages.author_names import author_name
from workspace.admin_pages.history import HistoryAdmin
from workspace.api.signed_in import user_of
from workspace.models import AuditEntry, User

MAX_CONCURRENT = 500  # rows that one bulk action changes in a request
PEOPLE = {"created_by", "decided_by", "imported_by"}


class CuratedForm(forms.ModelForm):
    """Carries the revision that the page showed; a form with an older one is shown again."""

    history_subject = ""
    reader: ClassVar[User]
    expected_revision = forms.IntegerField(required=False, widget=forms.HiddenInput)

    def __init__(self, *args: Any, **options: Any) -> None:
        super().__init__(*args, **options)
        if "expected_revision" in self.fields:
            self.fields["expected_revision"].initial = self.instance.revision if self.instance.pk else None

    def clean(self) -> dict[str, Any]:
        cleaned: dict[str, Any] = super().clean() or self.cleaned_data
        expected = cleaned.get("expected_revision")
        if self.instance.pk and expected is not None:
            model = type(self.instance)
            current = model._base_manager.filter(pk=self.instance.pk).values_list("revision", flat=True).first()
            if current != expected:
                raise ValidationError(stale_sentence(self.history_subject, self.instance.pk, self.reader), code="stale")
        return cleaned


class CommonGroundAdmin(ReadOnlyAdmin):
    """Read-only map data that all organisations share. Only installation operators see user names."""

    organisation_path = None

    def get_list_display(self, request: HttpRequest) -> list[Any]:
        return _without_users(super().get_list_display(request), request)

    def get_search_fields(self, request: HttpRequest) -> list[Any]:
        return _without_users(super().get_search_fields(request), request)

    def get_fields(self, request: HttpRequest, obj: Any = None) -> list[Any]:
        return _without_users(super().get_fields(request, obj), request)


class CuratedAdmin(HistoryAdmin):
    """Saves through the curation services, with the revision on which the form was filled in."""

    organisation_path = None

    def get_form(self, request: HttpRequest, obj: Any = None, change: bool = False, **options: Any) -> Any:
        form = super().get_form(request, obj, change, **options)
        form.reader = user_of(request)  # the class is made per request
        return form

    def changeform_view(self, request: HttpRequest, object_id: str | None = None, *args: Any, **options: Any) -> HttpResponse:
        try:
            return super().changeform_view(request, object_id, *args, **options)
        except StaleRevision as error:
            messages.error(request, stale_sentence(error.subject, error.key, user_of(request)))
            return HttpResponseRedirect(request.get_full_path())

    def change_each(self, request: HttpRequest, queryset: QuerySet[Any], change: Callable[[Any], None]) -> int:
        """Change each of the chosen rows, all or none; refuses more than can be done in a request."""
        number = queryset.count()
        if number > MAX_CONCURRENT:
            self.message_user(
                request, f"{number} rows are chosen; at most {MAX_CONCURRENT} are changed at once. Nothing was changed.", messages.ERROR
            )
            return 0
        with many_edits():
            for row in queryset.select_for_update(of=["self"]):
                change(row)
        return number


def stale_sentence(subject: str, key: int | None, reader: User) -> str:
    last = AuditEntry.objects.select_related("actor").filter(subject_type=subject, subject_id=str(key)).order_by("-pk").first()
    if last is None:
        return "This has changed in the meantime, and nothing was saved. Open it again to see it as it is now."
    who = author_name(last.actor, reader) or "An import"
    return (
        f"{who} has changed this in the meantime ({last.action}, {last.recorded_at:%H:%M} UTC), and nothing was saved. "
        "What you entered is still below; open the page again to see it as it is now."
    )


def _without_users(names: Iterable[Any], request: HttpRequest) -> list[Any]:
    if user_of(request).operates_installation:
        return list(names)
    return [name for name in names if str(name).partition("__")[0] not in PEOPLE]


def expected_revision(form: Any) -> int | None:
    value: int | None = form.cleaned_data.get("expected_revision")
    return value
