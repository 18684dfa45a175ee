"""The API describes itself, offline."""

import gzip
import re
from concurrent.futures import ThreadPoolExecutor
from io import StringIO
from pathlib import Path
from typing import Any

import pytest
from django.contrib.staticfiles import finders
from django.core.management import call_command
from django.test import Client

from workspace import api_document

pytestmark = pytest.mark.django_db


def test_the_document_is_valid_and_without_a_warning() -> None:
    call_command("spectacular", "--validate", "--fail-on-warn", stdout=StringIO())


def test_every_operation_has_a_summary_and_says_which_errors_it_knows() -> None:
    document = Client().get("/api/schema", headers={"Accept": "application/vnd.oai.openapi+json"}).json()
    operations = [operation for methods in document["paths"].values() for operation in methods.values()]
    assert operations
    for operation in operations:
        if operation["operationId"] != "schema_retrieve":
            assert operation.get("summary"), operation["operationId"]
        assert {"400", "401", "403", "404", "503"} <= set(operation["responses"])


def test_the_documentation_loads_only_files_of_this_host_and_no_inline_script() -> None:
    page = Client().get("/api/docs").content.decode()
    loaded = re.findall(r'<(?:script|link)[^>]*(?:src|href)="([^"]+)"', page)
    assert len(loaded) >= 5
    assert not re.search(r"<script>|<style>", page)
    for address in loaded:
        if address.startswith("/static/"):
            assert finders.find(address.removeprefix("/static/")), address
        else:
            assert address.startswith("/api/docs?")
            assert Client().get(address)["Content-Type"].startswith("application/javascript")


def test_the_document_is_made_once_however_many_ask(monkeypatch: pytest.MonkeyPatch, settings: Any, tmp_path: Path) -> None:
    settings.STATIC_ROOT = tmp_path
    api_document._stored.cache_clear()
    made: list[str] = []
    make = api_document._made

    def counted(form: str) -> bytes:
        made.append(form)
        return make(form)

    monkeypatch.setattr(api_document, "_made", counted)
    with ThreadPoolExecutor(8) as askers:
        answers = list(askers.map(lambda _: Client().get("/api/schema").content, range(16)))
    assert made == ["yaml"]
    assert len(set(answers)) == 1
    api_document._stored.cache_clear()
    assert Client().get("/api/schema").content == answers[0], "another process reads what is kept"
    assert made == ["yaml"]
    api_document._stored.cache_clear()


def test_it_is_asked_for_again_by_its_etag_and_sent_packed_to_whom_can_unpack_it() -> None:
    first = Client().get("/api/schema", headers={"Accept": "application/json"})
    assert first["Content-Type"] == "application/json; charset=utf-8"
    again = Client().get("/api/schema", headers={"Accept": "application/json", "If-None-Match": first["ETag"]})
    assert (again.status_code, again.content) == (304, b"")
    packed = Client().get("/api/schema", headers={"Accept": "application/json", "Accept-Encoding": "gzip"})
    assert (packed["Content-Encoding"], packed["Vary"]) == ("gzip", "Accept, Accept-Encoding")
    assert gzip.decompress(packed.content) == first.content
    assert packed["ETag"] != first["ETag"]
    assert Client().get("/api/schema")["Content-Type"].startswith("application/vnd.oai.openapi;")
    assert Client().post("/api/schema").status_code == 405


def test_it_is_the_same_in_every_language() -> None:
    assert len({Client().get("/api/schema", headers={"Accept-Language": language}).content for language in ("en", "de")}) == 1
