"""What the browser keeps for when the server cannot be reached: the service worker, and the page that it shows where it has no copy."""

import json
from functools import cache
from pathlib import Path

from django.contrib.staticfiles import finders
from django.contrib.staticfiles.storage import staticfiles_storage
from django.http import HttpRequest, HttpResponse
from django.views.generic import TemplateView

SERVICE_WORKER = "js/offline/service_worker.js"


def service_worker(_request: HttpRequest) -> HttpResponse:
    """From the root, as a worker serves only what stands below its own address; with a version, so that a new one replaces it."""
    script = f"globalThis.VERSION = {json.dumps(_version())};\n{_source()}"
    return HttpResponse(script, content_type="text/javascript; charset=utf-8", headers={"Cache-Control": "no-cache"})


def _version() -> str:
    """Of the static files, which have names that change with them."""
    return str(getattr(staticfiles_storage, "manifest_hash", ""))


@cache
def _source() -> str:
    if staticfiles_storage.exists(SERVICE_WORKER):
        with staticfiles_storage.open(SERVICE_WORKER) as file:
            return str(file.read().decode())
    return Path(str(finders.find(SERVICE_WORKER))).read_text(encoding="utf-8")


class OfflinePage(TemplateView):
    """Nobody's page: it names what the browser has kept, which its script reads there."""

    template_name = "offline.html"
