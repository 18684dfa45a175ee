"""The API describes itself, offline."""

import gzip
import json
import re
import subprocess
from concurrent.futures import ThreadPoolExecutor
from io import StringIO
from pathlib import Path
from typing import Any

import pytest
from django.core.management import call_command
from django.test import Client
from openapi_spec_validator import validate

from scripts.development.api_types import GENERATOR, NODE
from workspace.api import api_document

pytestmark = pytest.mark.django_db
API_PAGE = Path(__file__).resolve().parents[3] / "docs" / "api.md"
ERROR_TYPES = {"application/json", "application/problem+json"}


@pytest.fixture(scope="module")
def document() -> Any:
    return Client().get("/api/schema", headers={"Accept": "application/vnd.oai.openapi+json"}).json()


def operation(document: Any, name: str) -> Any:
    [found] = [each for methods in document["paths"].values() for each in methods.values() if each["operationId"] == name]
    return found


def parameters(document: Any, name: str) -> set[str]:
    return {parameter["name"] for parameter in operation(document, name).get("parameters", [])}


def headers(document: Any, name: str, status: str) -> set[str]:
    described = operation(document, name)["responses"][status].get("headers", {})
    return {reference["$ref"].rpartition("/")[2] for reference in described.values()}


@pytest.mark.long
def test_the_document_passes_the_validator_of_its_standard(document: Any) -> None:
    validate(document)


def test_the_document_names_licence_and_contact(document: Any) -> None:
    assert document["info"]["license"]["name"] == "Apache-2.0"
    assert document["info"]["contact"]["name"]


@pytest.mark.parametrize("name", ["make_plan", "create_mission", "create_asset", "create_uav"])
def test_what_may_be_repeated_takes_an_idempotency_key(document: Any, name: str) -> None:
    assert "Idempotency-Key" in parameters(document, name)
    assert "422" in operation(document, name)["responses"]
    assert "Idempotency-Replayed" in headers(document, name, "200" if name == "make_plan" else "201")


def test_what_takes_no_idempotency_key_does_not_name_it(document: Any) -> None:
    assert not any("Idempotency-Key" in parameters(document, name) for name in ("list_missions", "make_uav_credential"))


def test_answers_name_their_headers(document: Any) -> None:
    assert headers(document, "get_mission", "200") == headers(document, "get_mission", "304") == {"ETag"}
    assert {"ETag", "Location"} <= headers(document, "create_mission", "201")
    assert "Location" in headers(document, "make_plan", "202")
    assert headers(document, "list_missions", "429") == {"Retry-After", "RateLimit", "RateLimit-Policy"}
    assert headers(document, "list_missions", "503") == {"Retry-After"}


def test_operations_that_refuse_tokens_do_not_name_them(document: Any) -> None:
    def ways(name: str) -> set[str]:
        return {way for ways in operation(document, name)["security"] for way in ways}

    assert ways("make_token") == ways("change_password") == {"cookieAuth"}
    assert ways("list_tokens") == {"cookieAuth", "bearerToken"}
    assert ways("report_telemetry") == {"uavToken"}


def test_every_error_has_a_body_that_is_described(document: Any) -> None:
    for methods in document["paths"].values():
        for each in methods.values():
            for status, response in each["responses"].items():
                if status >= "400":
                    assert set(response["content"]) == ERROR_TYPES, (each["operationId"], status)


def test_the_document_is_valid_and_without_a_warning() -> None:
    call_command("spectacular", "--validate", "--fail-on-warn", stdout=StringIO())


@pytest.mark.long
def test_a_generator_of_types_takes_the_whole_document_without_a_word(document: Any, tmp_path: Path) -> None:
    source, types = tmp_path / "openapi.json", tmp_path / "types.d.ts"
    source.write_text(json.dumps(document))
    done = subprocess.run([NODE, GENERATOR, source, "--output", types], capture_output=True, text=True, check=False)  # noqa: S603
    assert (done.returncode, done.stderr) == (0, "")
    made = types.read_text()
    names = [each["operationId"] for methods in document["paths"].values() for each in methods.values()]
    assert len(names) > 200
    assert [name for name in names if f'operations["{name}"]' not in made] == []


def test_answers_that_generated_clients_cannot_know_are_named_where_they_are_told_of(document: Any) -> None:
    """openapi-python-client leaves out answers without a media type that it knows, with a warning."""

    def is_known(media_type: str) -> bool:
        return media_type.startswith("text/") or media_type.endswith(("/json", "+json", "/octet-stream"))

    answers = [response for methods in document["paths"].values() for each in methods.values() for response in each["responses"].values()]
    contents = [response["content"] for response in answers if response.get("content")]
    unknown = {media_type for content in contents if not any(map(is_known, content)) for media_type in content}
    reported = API_PAGE.read_text().partition("content_type_overrides:\n")[2].partition("```")[0]
    assert unknown == set(re.findall(r"^  (\S+): application/octet-stream$", reported, flags=re.MULTILINE))


def test_every_operation_has_a_summary_and_says_which_errors_it_knows(document: Any) -> None:
    operations = [each for methods in document["paths"].values() for each in methods.values()]
    assert operations
    for each in operations:
        if each["operationId"] != "schema_retrieve":
            assert each.get("summary"), each["operationId"]
        assert {"400", "401", "403", "404", "503"} <= set(each["responses"])


@pytest.mark.long
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
