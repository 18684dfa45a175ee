"""The admin as a whole: one sign-in for all doors."""

from typing import Any

from django.contrib.admin import AdminSite
from django.contrib.auth.views import redirect_to_login
from django.core.exceptions import PermissionDenied
from django.http import HttpRequest, HttpResponse, HttpResponseRedirect
from django.urls import reverse


class SpanwiseAdminSite(AdminSite):
    site_title = "Spanwise"
    site_header = "Spanwise administration"
    index_title = "Administration"

    def login(self, request: HttpRequest, extra_context: dict[str, Any] | None = None) -> HttpResponse:
        """Send strangers to the program's own sign-in, which limits wrong tries; tell the others that their role does not reach here."""
        if request.user.is_authenticated and not self.has_permission(request):
            raise PermissionDenied
        return redirect_to_login(request.GET.get("next") or reverse("admin:index"))

    def password_change(  # type: ignore[override] # Django's answers are pages alone by their types, not by what they are
        self, request: HttpRequest, extra_context: dict[str, Any] | None = None
    ) -> HttpResponse:
        """Lead to the account's own page, which limits wrong tries: there is no password form here."""
        return HttpResponseRedirect(reverse("account"))
