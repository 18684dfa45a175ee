"""The admin's history of a row: who changed what, before and after, from the entries that services write."""

import json
from collections.abc import Iterable
from typing import Any

from django.core.exceptions import PermissionDenied
from django.core.paginator import Paginator
from django.http import HttpRequest, HttpResponse
from django.template.response import TemplateResponse
from django.utils.html import format_html, format_html_join
from django.utils.safestring import SafeString

from workspace.admin_pages.author_names import author_name
from workspace.admin_pages.scope import OrganisationScopedAdmin
from workspace.api.signed_in import user_of
from workspace.models import AuditEntry

PAGE = 50
MAX_TEXT_LENGTH = 200
NOTHING = "–"


def what_changed(entry: AuditEntry) -> list[tuple[str, str, str]]:
    """Return name, before and after of each changed fact; for a created or deleted row, of each fact that it had."""
    before, after = entry.before, entry.after
    if not isinstance(before, dict | None) or not isinstance(after, dict | None):
        return [("", _shown(before), _shown(after))]
    names = list({**(before or {}), **(after or {})})
    if before and after:
        names = [name for name in names if before.get(name) != after.get(name)]
    return [
        (name.replace("_", " "), _shown((before or {}).get(name)), _shown((after or {}).get(name)))
        for name in names
        if not (_is_empty((before or {}).get(name)) and _is_empty((after or {}).get(name)))
    ]


def as_table(rows: Iterable[tuple[str, str, str]]) -> SafeString:
    lines = format_html_join("", "<tr><th scope='row'>{}</th><td>{}</td><td>{}</td></tr>", rows)
    return format_html(
        "<table class='changes'><thead><tr><th scope='col'>fact</th><th scope='col'>before</th><th scope='col'>after</th></tr></thead>"
        "<tbody>{}</tbody></table>",
        lines,
    )


class HistoryAdmin(OrganisationScopedAdmin):
    """Shows the row's own history instead of only the changes made in the admin."""

    history_subject = ""
    object_history_template = "admin/history_of_row.html"

    def history_view(self, request: HttpRequest, object_id: str, extra_context: dict[str, Any] | None = None) -> HttpResponse:
        row = self.get_object(request, object_id)
        if row is None:
            return super().history_view(request, object_id, extra_context)  # Django's response for a missing row
        if not self.has_view_or_change_permission(request, row):
            raise PermissionDenied
        entries = AuditEntry.objects.select_related("actor").filter(subject_type=self.history_subject, subject_id=str(row.pk))
        page = Paginator(entries.order_by("-recorded_at", "-pk"), PAGE).get_page(request.GET.get("p"))
        context = {
            **self.admin_site.each_context(request),
            "title": f"History of {row}",
            "subtitle": None,
            "page": page,
            "entries": [(entry, author_name(entry.actor, user_of(request)), as_table(what_changed(entry))) for entry in page],
            "module_name": str(self.opts.verbose_name_plural).capitalize(),
            "object": row,
            "opts": self.opts,
            **(extra_context or {}),
        }
        return TemplateResponse(request, self.object_history_template, context)


def _is_empty(value: Any) -> bool:
    return value is None or value in ("", [], {})


def _shown(value: Any) -> str:
    if _is_empty(value):
        return NOTHING
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, dict) and "coordinates" in value:
        return _geometry(value)
    if isinstance(value, list) and not any(isinstance(item, list | dict) for item in value):
        return _cut(", ".join(str(item) for item in value))
    return _cut(value if isinstance(value, str) else json.dumps(value, ensure_ascii=False, sort_keys=True))


def _geometry(value: dict[str, Any]) -> str:
    if value.get("type") == "Point":
        return f"Point {', '.join(f'{number:.7g}' for number in value['coordinates'])}"
    vertices = json.dumps(value["coordinates"]).count("], [") + 1
    return f"{value.get('type')} of {vertices} vertices"


def _cut(text: str) -> str:
    return text if len(text) <= MAX_TEXT_LENGTH else f"{text[:MAX_TEXT_LENGTH]}…"
