"""Every error has one shape, whatever raised it."""

from typing import Any

import pytest
from django.db import DataError, OperationalError
from django.test import Client
from rest_framework import serializers

from tests.accounts.users import a_user, client_of
from workspace import selectors
from workspace.api.errors import ApiProblem, error_response
from workspace.api.throttling import ScopedRate

ECHO = "/api/v1/echo"
pytestmark = [pytest.mark.django_db, pytest.mark.urls("tests.workspace.api.echo_urls")]


@pytest.fixture
def client() -> Client:
    return client_of(a_user())


def send(client: Client, body: bytes | str, content_type: str = "application/json") -> Any:
    return client.post(ECHO, body, content_type=content_type)


def code(answer: Any, status: int) -> str:
    assert answer.status_code == status, answer.content
    error = answer.json()["error"]
    assert set(error) == {"code", "message", "details"}
    assert error["message"]
    return error["code"]


@pytest.mark.parametrize(
    ("accept", "content_type"),
    [
        ("*/*", "application/json"),
        ("application/json", "application/json"),
        ("application/problem+json", "application/problem+json"),
        ("application/json, application/problem+json;q=0.9", "application/problem+json"),
    ],
)
def test_an_error_is_also_a_problem_of_rfc_9457(client: Client, accept: str, content_type: str) -> None:
    addresses = {
        "/api/v1/jobs?limit=0": (400, "invalid"),
        "/api/v1/missions?cursor=x": (400, "invalid_cursor"),
        "/api/v1/n": (404, "not_found"),
    }
    for address, (status, kind) in addresses.items():
        answer = client.get(address, headers={"Accept": accept})
        assert code(answer, status) == kind
        assert answer["Content-Type"] == content_type
        problem = answer.json()
        assert problem.pop("error")["message"] == problem["detail"]
        titles = {400: "Bad Request", 404: "Not Found"}
        assert (problem["type"], problem["title"]) == (f"urn:problem-type:spanwise:{kind}", titles[status])
        assert (problem["status"], problem["instance"]) == (status, address.partition("?")[0])


def test_who_takes_only_problems_is_answered_all_the_same(client: Client) -> None:
    answer = client.get("/api/v1/jobs", headers={"Accept": "application/problem+json"})
    assert (answer.status_code, answer["Content-Type"]) == (200, "application/json")


def test_a_limit_that_is_reached_is_told_in_headers(client: Client, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ScopedRate, "THROTTLE_RATES", {"plans": "2/minute"})
    answers = [send(client, "{}") for _ in range(5)]
    assert code(answers[-1], 429) == "throttled"
    assert answers[-1]["RateLimit-Policy"] == '"plans";q=2;w=60'
    assert answers[-1]["RateLimit"] == f'"plans";r=0;t={answers[-1]["Retry-After"]}'


def test_json_comes_back_as_it_was_sent(client: Client) -> None:
    assert send(client, '{"text": "größer", "number": 1.5, "list": [null, true]}').json() == {
        "text": "größer",
        "number": 1.5,
        "list": [None, True],
    }


@pytest.mark.parametrize(
    "body",
    [
        '{"a": NaN}',
        '{"a": Infinity}',
        '{"a": -Infinity}',
        '{"a": 1e999}',
        '{"a": -1e999}',
        '{"a": ' + "9" * 5000 + "}",
        '{"a": "\\u0000"}',
        '{"\\u0000": 1}',
        '{"a": "\\ud800"}',
        b'{"a": "\xff"}',
        "{",
        " ",
        "[" * 33 + "]" * 33,
        "[" * 20_000 + "]" * 20_000,
        '{"a":' * 100_000,
    ],
)
def test_what_is_not_strict_json_is_refused(client: Client, body: bytes | str) -> None:
    assert code(send(client, body), 400) == "parse_error"


@pytest.mark.parametrize("character", ["\\u0007", "\\b", "\\u001b", "\x7f", "\x85", "\\u202e", "\u2066"])
def test_control_characters_and_turned_writing_are_refused_in_any_text(client: Client, character: str) -> None:
    assert code(send(client, f'{{"name": "Tern{character}x"}}'), 400) == "parse_error"


def test_lines_tabs_and_all_scripts_are_texts(client: Client) -> None:
    assert send(client, '{"why": "Zürich\\n\\tΑθήνα שלום 東京 \\\\u0007"}').status_code == 200


def test_32_levels_are_not_too_deep(client: Client) -> None:
    assert send(client, "[" * 32 + "]" * 32).status_code == 200


def test_a_body_over_the_limit_is_refused(client: Client) -> None:
    assert code(send(client, b'"' + b"x" * 2_100_000 + b'"'), 413) == "too_large"


def test_a_body_that_is_not_json_is_refused(client: Client) -> None:
    assert code(send(client, "a=1", "application/x-www-form-urlencoded"), 415) == "unsupported_media_type"
    assert code(client.post(ECHO, {"a": "1"}), 415) == "unsupported_media_type"


def test_a_method_that_is_not_there(client: Client) -> None:
    assert code(client.delete("/api/v1/jobs"), 405) == "method_not_allowed"
    assert code(client.options("/api/v1/jobs"), 405) == "method_not_allowed"


def test_an_address_that_is_not_there(client: Client) -> None:
    assert code(client.get("/api/v1/nothing"), 404) == "not_found"
    assert code(client.get("/api/v1/assets/999999999999999999999999"), 404) == "not_found"


def test_a_media_type_that_is_not_there(client: Client) -> None:
    assert code(client.get("/api/v1/jobs", headers={"Accept": "text/csv"}), 406) == "not_acceptable"


def test_a_host_that_is_not_ours(client: Client) -> None:
    assert code(client.get("/api/v1/jobs", headers={"Host": "elsewhere.example"}), 400) == "bad_request"


def test_our_own_fault_tells_nothing_of_itself(client: Client, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(selectors, "jobs_of_organisation", lambda organisation: 1 / 0)
    answer = client.get("/api/v1/jobs")
    assert code(answer, 500) == "server_error"
    assert "ZeroDivision" not in answer.content.decode()


def test_a_database_that_is_away_is_said_so(client: Client, monkeypatch: pytest.MonkeyPatch) -> None:
    def away(organisation: object) -> None:
        raise OperationalError("connection refused")

    monkeypatch.setattr(selectors, "jobs_of_organisation", away)
    answer = client.get("/api/v1/jobs")
    assert code(answer, 503) == "database_away"
    assert int(answer["Retry-After"]) > 0


def test_a_database_that_is_away_is_said_so_outside_the_api_too(monkeypatch: pytest.MonkeyPatch) -> None:
    def away(*args: object) -> None:
        raise OperationalError("connection refused")

    client = client_of(a_user())
    monkeypatch.setattr("django.contrib.sessions.backends.db.SessionStore.load", away)
    for address in ("/", "/api/v1/jobs"):
        answer = client.get(address)
        assert answer.status_code == 503
        assert int(answer["Retry-After"]) > 0


def test_a_page_that_is_not_there_is_a_page(client: Client) -> None:
    answer = client.get("/nothing")
    assert answer.status_code == 404
    assert answer["Content-Type"].startswith("text/html")


def body_of(error: Exception) -> dict[str, Any]:
    response = error_response(error, {})
    assert response is not None
    return response.data["error"]


def test_faults_of_nested_input_are_told_by_place() -> None:
    error = serializers.ValidationError({"targets": [{}, {"position": ["Two numbers."]}], "non_field_errors": ["Too many."]})
    assert body_of(error) == {
        "code": "invalid",
        "message": "targets.1.position: Two numbers.",
        "details": {"targets.1.position": ["Two numbers."], "": ["Too many."]},
    }


def test_a_problem_says_when_to_try_again() -> None:
    response = error_response(ApiProblem(503, "graph_outdated", "Wait.", retry_after_s=5), {})
    assert response is not None
    assert (response.status_code, response["Retry-After"]) == (503, "5")


def test_a_value_that_no_column_can_hold_is_the_senders_fault() -> None:
    assert body_of(DataError("integer out of range"))["code"] == "invalid"
