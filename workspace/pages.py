"""Base of all pages: the user for the page's script. All other content comes from the REST API."""

import json
from functools import cache
from http import HTTPStatus
from pathlib import Path
from typing import Any

from django.conf import settings
from django.contrib.auth.mixins import LoginRequiredMixin
from django.contrib.staticfiles import finders
from django.contrib.staticfiles.storage import staticfiles_storage
from django.http import HttpRequest, HttpResponse
from django.urls import resolve
from django.views.generic import TemplateView

from workspace.api.signed_in import SignedInPageRequest
from workspace.sessions.browser_sessions import seconds_left

ALERT_COUNTS = "/api/v1/alerts/counts"
GROUND = "/api/v1/ground"


class OpenPage(TemplateView):
    """An HTML shell for everybody, in the frame of the pages; `page` is empty without a user."""

    answers: tuple[str, ...] = ()  # addresses of the API whose answers the page holds: its script does not request them

    def get_context_data(self, **kwargs: Any) -> dict[str, Any]:
        user = self.request.user
        if not user.is_authenticated:
            return super().get_context_data(**kwargs) | {"page": {}}
        page = {
            "userId": user.pk, "organisationId": user.organisation_id, "userName": user.username, "role": user.role,
            "canPlan": user.can_plan, "canCurate": user.can_curate,
            "sessionEndsIn_s": seconds_left(self.request.session),
        } | self.page(**kwargs)  # fmt: skip
        answers = {address: found for address in self.answers if (found := _answer(self.request, address)) is not None}
        return super().get_context_data(**kwargs) | {"page": page, "answers": answers}

    def page(self, **kwargs: Any) -> dict[str, Any]:
        """Return what the page's script needs before its first request."""
        return {}


def _answer(request: HttpRequest, address: str) -> Any:
    """Return what the API answers to the user of a page; None where it refuses."""
    view, positional, named = resolve(address)
    response = view(request, *positional, **named)
    return response.data if response.status_code == HTTPStatus.OK else None


class SignedInPage(LoginRequiredMixin, OpenPage):
    """An HTML shell for an authenticated user."""

    answers: tuple[str, ...] = (ALERT_COUNTS,)
    request: SignedInPageRequest


def raster_maps() -> dict[str, Any]:
    """Return the addresses of raster maps under the map; empty where there are none."""
    return {
        "baseMap": {"tiles": settings.BASE_MAP_TILES, "attribution": settings.BASE_MAP_ATTRIBUTION},
        "satellite": {"tiles": settings.SATELLITE_TILES, "attribution": settings.SATELLITE_ATTRIBUTION},
    }


SERVICE_WORKER = "js/offline/service_worker.js"


def service_worker(_request: HttpRequest) -> HttpResponse:
    """Return the service worker from the root, as its scope is the path below its URL; a version makes a new one replace it."""
    script = f"globalThis.VERSION = {json.dumps(_version())};\n{_source()}"
    return HttpResponse(script, content_type="text/javascript; charset=utf-8", headers={"Cache-Control": "no-cache"})


def _version() -> str:
    """Return the version of the static files, whose names contain their hashes."""
    return str(getattr(staticfiles_storage, "manifest_hash", ""))


@cache
def _source() -> str:
    if staticfiles_storage.exists(SERVICE_WORKER):
        with staticfiles_storage.open(SERVICE_WORKER) as file:
            return str(file.read().decode())
    return Path(str(finders.find(SERVICE_WORKER))).read_text(encoding="utf-8")


class OfflinePage(TemplateView):
    """A page without a user: its script reads and lists what the browser has stored."""

    template_name = "offline.html"
