"""The page of the API: every operation of the document in a described group, with an example that is valid."""

import json
import os
import re
import subprocess
from pathlib import Path
from typing import Any

import pytest
from django.conf import settings
from django.test import Client
from openapi_schema_validator import OAS30WriteValidator
from referencing import Registry, Resource
from referencing.jsonschema import DRAFT4

from scripts.development.api_types import NODE
from tests.accounts.users import a_user, client_of
from workspace.api.api_document import stored
from workspace.api.api_page import headings
from workspace.models import Role

pytestmark = pytest.mark.django_db

EXAMPLES = """
import { asCurl, asPython, exampleRequest } from "SCRIPTS/examples.js";
let text = "";
for await (const piece of process.stdin) text += piece;
const api = JSON.parse(text), found = {};
for (const [path, methods] of Object.entries(api.paths))
  for (const method of Object.keys(methods)) {
    const request = exampleRequest(api, path, method);
    found[methods[method].operationId] = { request, curl: asCurl("http://it", request), python: asPython("http://it", request) };
  }
console.log(JSON.stringify(found));
"""
SCRIPTS = Path(settings.BASE_DIR) / "static" / "js" / "api_docs"


@pytest.fixture(scope="module")
def document() -> Any:
    return json.loads(stored("json").plain)


@pytest.fixture(scope="module")
def examples() -> Any:
    program = EXAMPLES.replace("SCRIPTS", str(SCRIPTS))
    command = [NODE, "--input-type=module", "--eval", program]
    return json.loads(subprocess.run(command, input=stored("json").plain, capture_output=True, check=True).stdout)  # noqa: S603


def operations(document: Any) -> dict[str, Any]:
    return {each["operationId"]: each for methods in document["paths"].values() for each in methods.values()}


def test_every_operation_is_in_one_described_group_under_a_heading(document: Any) -> None:
    groups = [group for heading in headings() for group in heading.groups]
    shown = [operation.id for group in groups for operation in group.operations]
    assert sorted(shown) == sorted(operations(document))
    assert [group.name for group in groups if not (group.title and group.description and group.operations)] == []


def test_the_page_is_open_to_strangers_and_links_to_the_document() -> None:
    page = Client().get("/api/docs")
    assert page.status_code == 200
    text = page.content.decode()
    assert 'id="get_mission"' in text
    assert "http://testserver/api/v1/missions" in text
    for address in re.findall(r'href="(/api/schema[^"]+)"', text):
        assert Client().get(address).status_code == 200
    assert 'id="open-account"' not in text
    assert 'id="open-account"' in client_of(a_user(Role.VIEWER)).get("/api/docs").content.decode()


def test_the_page_has_no_inline_script_and_loads_only_files_of_this_host() -> None:
    text = Client().get("/api/docs").content.decode()
    loaded = re.findall(r'<(?:script|link)[^>]*(?:src|href)="([^"]+)"', text)
    assert loaded
    assert all(address.startswith("/static/") for address in loaded)
    assert not re.search(r"<script>|<style>", text)


def test_the_document_is_sent_in_the_form_that_its_address_names() -> None:
    assert Client().get("/api/schema?format=json")["Content-Type"] == "application/json; charset=utf-8"
    assert Client().get("/api/schema?format=yaml").content.startswith(b"openapi:")
    assert Client().get("/api/schema?format=xml").status_code == 404


def test_bodies_of_examples_are_valid(document: Any, examples: Any) -> None:
    api = with_absolute_references(document)
    registry = Registry().with_resource("urn:api", Resource(contents=api, specification=DRAFT4))
    faults = {}
    for name, operation in operations(api).items():
        content = operation.get("requestBody", {}).get("content", {}).get("application/json")
        if content:
            checker = OAS30WriteValidator(content["schema"], registry=registry)
            faults[name] = [fault.message for fault in checker.iter_errors(examples[name]["request"]["body"])]
    assert len(faults) > 80
    assert {name: words for name, words in faults.items() if words} == {}


def with_absolute_references(part: Any) -> Any:
    if isinstance(part, dict):
        return {name: f"urn:api{each}" if name == "$ref" else with_absolute_references(each) for name, each in part.items()}
    return [with_absolute_references(each) for each in part] if isinstance(part, list) else part


def test_examples_in_python_are_python(examples: Any) -> None:
    for name, example in examples.items():
        compile(example["python"], name, "exec")


def test_examples_for_a_shell_send_what_they_show(examples: Any) -> None:
    """The shell itself reads them: a function in place of curl prints its arguments."""
    names = list(examples)
    script = "curl() { printf '%s\\0' \"$@\"; printf '\\1'; }\n" + "\n".join(examples[name]["curl"] for name in names)
    environment = os.environ | {"SPANWISE_TOKEN": "spw_x", "SPANWISE_UAV_TOKEN": "spw_u"}
    done = subprocess.run(["bash", "-c", script], env=environment, capture_output=True, text=True, check=True)  # noqa: S603, S607
    sent = dict(zip(names, (call.split("\0") for call in done.stdout.split("\1")), strict=False))
    assert len(sent) == len(names)
    for name, arguments in sent.items():
        request = examples[name]["request"]
        assert arguments[:2] == ["-X", request["method"]]
        assert arguments[2].startswith(f"http://it{request['path']}")
        assert "Authorization: Bearer spw_" in arguments[4]
        if "body" in request:
            assert json.loads(arguments[arguments.index("-d") + 1]) == request["body"]


@pytest.mark.parametrize("place", [1, 2])
def test_the_samples_of_getting_started_are_python(place: int) -> None:
    text = Client().get("/api/docs").content.decode()
    samples = [code for code in re.findall(r"<pre[^>]*><code>(.*?)</code></pre>", text, re.S) if code.startswith("import")]
    compile(samples[place - 1], f"sample {place}", "exec")
