"""The API describes itself, offline."""

import re
from io import StringIO

import pytest
from django.contrib.staticfiles import finders
from django.core.management import call_command
from django.test import Client

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
