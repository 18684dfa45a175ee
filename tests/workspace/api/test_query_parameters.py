"""Query parameters that the OpenAPI document does not name for an operation are answered 400."""

import re
from typing import Any
from urllib.parse import urlencode

import pytest
from django.conf import settings
from django.test import Client

from planning.energy.performance import BATTERIES_WH, MASSES_KG, ROTOR_DISKS_M2
from tests.accounts.users import a_user, client_of
from tests.workspace.api.described_answers import openapi_document
from workspace.models import Role

pytestmark = pytest.mark.django_db
METHODS = {"get", "post", "put", "patch", "delete"}
IDS = {"uuid": "00000000-0000-4000-8000-000000000000"}


@pytest.fixture(scope="module")
def document() -> Any:
    return openapi_document()


def operations(document: Any) -> list[tuple[str, str, set[str]]]:
    """Return method, address with made-up ids, and the described query parameters of each operation."""
    found = []
    for path, methods in document["paths"].items():
        for method, operation in methods.items():
            if method in METHODS:
                described = operation.get("parameters", [])
                address = path
                for each in described:
                    if each["in"] == "path":
                        schema = each["schema"]
                        reported = IDS.get(schema.get("format", ""), schema.get("enum", ["1"])[0])
                        address = address.replace(f"{{{each['name']}}}", str(reported))
                found.append((method, address, {each["name"] for each in described if each["in"] == "query"}))
    return found


def asked(client: Client, method: str, address: str, names: set[str]) -> Any:
    answer = client.generic(method.upper(), f"{address}?{urlencode(dict.fromkeys(names, 'x'))}", content_type="application/json")
    return answer.json().get("error") if answer["Content-Type"].startswith("application/json") else None


def test_every_operation_takes_each_described_parameter_and_no_other(document: Any) -> None:
    client = client_of(a_user(Role.ADMINISTRATOR))
    walked = operations(document)
    assert len(walked) > 150
    for method, address, names in walked:
        for name in names:
            error = asked(client, method, address, {name})
            assert error is None or error["code"] != "unknown_parameter", (method, address, name)
        error = asked(client, method, address, {*names, "not_described"})
        assert error is not None and error["code"] == "unknown_parameter", (method, address)
        assert set(error["details"]) == {"not_described"}, (method, address)
        for name in names:
            assert name in error["message"], (method, address, "names the known ones")


def test_a_misspelt_filter_is_a_problem_that_names_the_nearest_one() -> None:
    client = client_of(a_user(Role.VIEWER))
    answer = client.get("/api/v1/missions?sate=planned&limit=1", headers={"Accept": "application/problem+json"})
    assert answer.status_code == 400
    assert answer["Content-Type"] == "application/problem+json"
    problem = answer.json()
    assert (problem["type"], problem["status"], problem["instance"]) == (
        "urn:problem-type:spanwise:unknown_parameter",
        400,
        "/api/v1/missions",
    )
    assert list(problem["error"]["details"]) == ["sate"]
    assert "Did you mean state?" in problem["detail"]


def test_nothing_is_done_by_a_request_with_an_unknown_parameter() -> None:
    client = client_of(a_user(Role.OPERATOR))
    made = client.post("/api/v1/bases?dry_run=true", {"name": "North", "position": [10.0, 56.0]}, content_type="application/json")
    assert made.status_code == 400
    assert client.get("/api/v1/bases").json()["results"] == []


def test_of_many_unknown_parameters_the_first_are_named() -> None:
    many = urlencode({f"{number}{'x' * 500}": "" for number in range(500)})
    error = client_of(a_user(Role.VIEWER)).get(f"/api/v1/missions?{many}").json()["error"]
    assert len(error["details"]) == 10
    assert max(map(len, error["details"])) == 100


def test_a_method_that_is_not_there_is_answered_as_before() -> None:
    assert client_of(a_user(Role.OPERATOR)).delete("/api/v1/missions?x=1").status_code == 405


def test_the_document_and_the_pages_take_their_own_parameters() -> None:
    client = client_of(a_user(Role.VIEWER))
    assert client.get("/api/schema?format=json").status_code == 200
    assert client.get("/sign-in?next=/missions").status_code in {200, 302}


ADDRESS = re.compile(r"[\"'`](?:/api/v1)?(/[a-z][^\"'`?\s]*)\?([^\"`\n]*)")
NAME = re.compile(r"(?:^|&)([a-z_]+)=")
OF_PAGES = {("/assets", "id"), ("/uavs", "tab"), ("/zones", "id")}  # pages at paths that the API has too
SOURCES = [("static/js", "*.js"), ("examples", "*.py"), ("docs", "*.md"), ("deploy", "*.py"), ("benchmarks", "*.py"), ("scripts", "*.py")]


def addresses_in_sources() -> list[tuple[str, str, list[str]]]:
    """Return file, path and parameter names of each address that is written out in the pages' scripts, examples and documents."""
    return [
        (str(file.relative_to(settings.BASE_DIR)), path, NAME.findall(query))
        for folder, pattern in SOURCES
        for file in sorted((settings.BASE_DIR / folder).rglob(pattern))
        for path, query in ADDRESS.findall(file.read_text())
    ]


def shape_of(path: str) -> re.Pattern[str]:
    """Return what an address written by this path of the document looks like."""
    return re.compile("[^/]+".join(re.escape(part) for part in re.split(r"\{\w+\}", path)) + "$")


def query_names(methods: Any) -> set[str]:
    described = [parameter for operation in methods.values() for parameter in operation.get("parameters", [])]
    return {parameter["name"] for parameter in described if parameter["in"] == "query"}


def test_pages_examples_and_documents_ask_with_known_parameters_alone(document: Any) -> None:
    known = [(shape_of(path), query_names(methods)) for path, methods in document["paths"].items()]
    checked = 0
    for file, path, names in addresses_in_sources():
        found = [own for pattern, own in known if pattern.match(f"/api/v1{path}")]
        for name in names if found else ():
            assert (path, name) in OF_PAGES or any(name in own for own in found), (file, path, name)
            checked += 1
    assert checked >= 50


@pytest.mark.parametrize("since", ["0001-01-01", "0001-01-01T00:00:00Z", "9999-12-31T23:59:59Z"])
def test_any_time_may_be_asked_for_since_when_rows_have_changed(since: str) -> None:
    assert client_of(a_user()).get("/api/v1/zones", {"changed_since": since}).status_code == 200


@pytest.mark.parametrize("zone_set", ["-1", "0", "1000000000", "1.5", "١"])
def test_a_number_outside_the_bounds_of_the_document_is_refused(zone_set: str) -> None:
    answer = client_of(a_user()).get("/api/v1/zones", {"zone_set": zone_set})
    assert answer.status_code == 400
    assert answer.json()["error"]["details"] == {"zone_set": ["A whole number from 1 to 999999999 is needed."]}


@pytest.mark.parametrize("name", ["stale", "deleted"])
def test_what_is_neither_true_nor_false_is_refused(name: str) -> None:
    assert client_of(a_user()).get("/api/v1/missions", {name: "perhaps"}).status_code == 400


@pytest.mark.parametrize("name", [7, True])
def test_a_name_is_a_json_string(name: Any) -> None:
    body = {"name": name, "position": [9.0, 47.0]}
    answer = client_of(a_user(Role.ADMINISTRATOR)).post("/api/v1/bases", body, content_type="application/json")
    assert answer.status_code == 400
    assert answer.json()["error"]["details"] == {"name": ["Not a valid string."]}


def test_the_document_bounds_figures_of_uav_types_as_planning_does(document: Any) -> None:
    described = document["components"]["schemas"]["UavTypeRequest"]["properties"]
    bounds = {
        name: (schema["minimum"], schema["maximum"]) for name, schema in described.items() if "minimum" in schema and "maximum" in schema
    }
    assert bounds["battery_wh"] == BATTERIES_WH
    assert bounds["mass_kg"] == MASSES_KG
    assert bounds["rotor_disk_m2"] == ROTOR_DISKS_M2
    assert document["paths"]["/api/v1/uavs"]["post"]["requestBody"]["required"] is True
