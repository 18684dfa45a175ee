"""The OpenAPI document: made once per version of the program, stored in a file, and sent from there.

Making it takes seconds of processor time. `manage.py make_api_document`, which `./run` and the image's build call, writes the files; a
process that finds none of its version makes and stores it.
"""

import gzip
import hashlib
import os
import threading
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from django.conf import settings
from django.http import Http404, HttpRequest, HttpResponse
from django.utils import translation
from django.utils.cache import get_conditional_response
from django.views.decorators.http import require_safe
from drf_spectacular.generators import SchemaGenerator
from drf_spectacular.renderers import OpenApiJsonRenderer, OpenApiYamlRenderer

APPS = (
    "accounts",
    "config",
    "inspection",
    "mavlink",
    "missions",
    "operation",
    "planning",
    "results",
    "simulation",
    "telemetry",
    "workspace",
)
FORMS = {"yaml": OpenApiYamlRenderer, "json": OpenApiJsonRenderer}
FORM_OF = {
    "application/vnd.oai.openapi": "yaml",
    "application/yaml": "yaml",
    "application/vnd.oai.openapi+json": "json",
    "application/json": "json",
}

_making = threading.Lock()


@dataclass(frozen=True)
class Document:
    """One form of the document, plain and packed."""

    plain: bytes
    packed: bytes
    sha256: str


@require_safe
def api_document(request: HttpRequest) -> HttpResponse:
    """Return the document in YAML, or in JSON if Accept or `?format=json` asks for it, with an ETag; no login is needed."""
    media_type = _named_type(request.GET["format"]) if "format" in request.GET else request.get_preferred_type(list(FORM_OF))
    media_type = media_type or "application/vnd.oai.openapi"
    document = stored(FORM_OF[media_type])
    is_packed = "gzip" in request.headers.get("Accept-Encoding", "")
    etag = f'"{document.sha256[:32]}{"-gz" if is_packed else ""}"'
    answer = get_conditional_response(request, etag=etag) or HttpResponse(
        document.packed if is_packed else document.plain, content_type=f"{media_type}; charset=utf-8"
    )
    if is_packed and answer.status_code == 200:
        answer["Content-Encoding"] = "gzip"
    answer["ETag"], answer["Vary"], answer["Cache-Control"] = etag, "Accept, Accept-Encoding", "public, no-cache"
    return answer


def _named_type(form: str) -> str:
    if form not in FORMS:
        raise Http404
    return f"application/{form}"


def stored(form: str) -> Document:
    """Return the document in this form, "yaml" or "json"; of concurrent requests one makes it and the others wait."""
    with _making:
        return _stored(form)


@cache
def _stored(form: str) -> Document:
    path = Path(settings.STATIC_ROOT) / "api" / f"{version_of_the_program()}.{form}.gz"
    try:
        packed = path.read_bytes()
        plain = gzip.decompress(packed)
    except (OSError, EOFError):
        plain = _made(form)
        packed = gzip.compress(plain, mtime=0)
        _keep(path, packed)
    return Document(plain, packed, hashlib.sha256(plain).hexdigest())


def version_of_the_program() -> str:
    """Return a digest of the program's own sources."""
    digest = hashlib.sha256()
    for app in APPS:
        for path in sorted((Path(settings.BASE_DIR) / app).rglob("*.py")):
            digest.update(path.read_bytes())
    return digest.hexdigest()[:32]


def _made(form: str) -> bytes:
    with translation.override("en"):
        schema = SchemaGenerator().get_schema(request=None, public=True)
        rendered = FORMS[form]().render(schema, renderer_context={})
        return rendered.encode() if isinstance(rendered, str) else rendered


def _keep(path: Path, packed: bytes) -> None:
    """Store the document for other processes; where nothing can be written, each process makes its own."""
    written = path.with_suffix(f".{os.getpid()}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        for older in path.parent.glob(f"*.{path.name.partition('.')[2]}"):
            older.unlink(missing_ok=True)
        written.write_bytes(packed)
        written.rename(path)
    except OSError:
        written.unlink(missing_ok=True)
