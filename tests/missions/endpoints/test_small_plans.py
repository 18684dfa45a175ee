"""A small plan is answered by the one view: who may ask, how often, in which form, and what is refused."""

import json
from datetime import timedelta
from typing import Any
from unittest import mock

import pytest
from django.conf import settings
from django.db import OperationalError
from django.test import Client
from django.utils import timezone, translation

from inspection.models import GraphSnapshot
from missions import services
from tests.accounts.users import a_user
from tests.missions.api import plan_body
from tests.missions.worlds import World
from tests.workspace.counters import forget_counts
from workspace.api.throttling import ScopedRate
from workspace.api_tokens import create_api_token
from workspace.models import ApiToken, Role, User

pytestmark = pytest.mark.django_db
CSRF_TOKEN = "k" * 32


def program_of(user: User) -> Client:
    token = create_api_token(user=user, name="load", expires_at=timezone.now() + timedelta(days=1))
    return Client(headers={"Authorization": f"Bearer {token}"}, raise_request_exception=False)


def session_of(user: User) -> Client:
    """A browser whose CSRF token is asked for, with a cookie for one."""
    client = Client(enforce_csrf_checks=True, raise_request_exception=False)
    client.force_login(user)
    client.cookies[settings.CSRF_COOKIE_NAME] = CSRF_TOKEN
    return client


def asked(client: Client, body: Any, **options: Any) -> Any:
    return client.post("/api/v1/plans", body, content_type="application/json", **options)


def status_of(client: Client, here: World, **options: Any) -> int:
    return int(asked(client, plan_body(here.towers[2]), **options).status_code)


def test_programs_and_people_get_the_same_plan(here: World) -> None:
    operator = a_user(Role.OPERATOR)
    program, person = program_of(operator), session_of(operator)
    for body in (
        plan_body(here.towers[2], here.towers[4]),
        plan_body(here.towers[1], {"position": [10.0, 56.3]}),  # the second is too far away: said in words
        plan_body(here.line),
        plan_body(here.towers[0], objective="makespan", return_to_start=True),
    ):
        first, second = asked(program, body), asked(person, body, headers={"X-CSRFToken": CSRF_TOKEN})
        assert first.status_code == second.status_code == 200, first.content
        assert first.content == second.content


def test_the_headers_of_a_plan(here: World) -> None:
    operator = a_user(Role.OPERATOR)
    for answer in (
        asked(program_of(operator), plan_body(here.towers[2])),
        asked(session_of(operator), plan_body(here.towers[2]), headers={"X-CSRFToken": CSRF_TOKEN}),
    ):
        assert answer["Content-Type"] == "application/json"
        assert answer["Content-Length"] == str(len(answer.content))
        assert answer["X-Frame-Options"] == "DENY"
        assert answer["X-Content-Type-Options"] == "nosniff"
    assert answer["Cache-Control"] == "no-store"


@pytest.mark.parametrize(
    ("body", "place"),
    [
        (b"", "uavs"),
        (b"{", None),
        (b"[]", ""),
        (b'{"uavs": NaN}', None),
        (b'\xff{"uavs": []}', None),
        (json.dumps({"uavs": [], "targets": []}).encode(), "uavs"),
        (json.dumps({"uavs": [{"name": "A", "position": [10, 91]}], "targets": [{"position": [10, 56]}]}).encode(), "uavs.0.position"),
        (json.dumps({"uavs": [{"name": "A", "position": [10, 56]}], "targets": [{"asset": 999_999_999}]}).encode(), "targets.0.asset"),
        (b" " * 70_000 + b"{}", "uavs"),
    ],
    ids=["empty", "half", "list", "nan", "no utf-8", "nobody", "north of the pole", "unknown asset", "long"],
)
def test_what_is_wrong_is_said_by_its_place(here: World, body: bytes, place: str | None) -> None:
    answer = asked(program_of(a_user(Role.OPERATOR)), body)
    assert answer.status_code == 400
    error = answer.json()["error"]
    assert error["message"]
    assert error["details"] is None if place is None else place in error["details"]


def test_another_hosts_name_is_refused(here: World) -> None:
    assert status_of(program_of(a_user(Role.OPERATOR)), here, headers={"Host": "elsewhere.example"}) == 400


def test_a_plan_is_made_in_the_language_that_is_asked_for(here: World) -> None:
    make_plan = services.make_plan
    languages = []

    def noted(**kwargs: Any) -> Any:
        languages.append(translation.get_language())
        return make_plan(**kwargs)

    with mock.patch.object(services, "make_plan", noted):
        for language in ("de", "en"):
            assert status_of(program_of(a_user(Role.OPERATOR)), here, headers={"Accept-Language": language}) == 200
    assert languages == ["de", "en"]


def test_what_is_wrong_is_said_in_the_language_of_each_request(here: World) -> None:
    client, body = program_of(a_user(Role.OPERATOR)), plan_body(here.towers[2], uavs=[{"name": "x" * 101, "position": [10, 56]}])
    stated = [asked(client, body, headers={"Accept-Language": language}).json()["error"]["details"] for language in ("de", "en", "de")]
    assert stated[0] == stated[2] != stated[1]
    assert stated[1] == {"uavs.0.name": ["Ensure this field has no more than 100 characters."]}


def test_requests_are_counted_by_the_address_they_came_to(here: World) -> None:
    answer = asked(program_of(a_user(Role.OPERATOR)), plan_body(here.towers[2]))
    assert answer.resolver_match.route == "api/v1/plans"


@pytest.mark.parametrize("role", Role)
def test_operators_and_administrators_may_plan(here: World, role: Role) -> None:
    assert status_of(program_of(a_user(role)), here) == (200 if role in (Role.OPERATOR, Role.ADMINISTRATOR) else 403)


def test_no_token_no_plan(here: World) -> None:
    client = program_of(a_user(Role.OPERATOR))
    assert status_of(client, here) == 200
    ApiToken.objects.update(expires_at=timezone.now())
    assert status_of(client, here) == 401
    ApiToken.objects.update(expires_at=timezone.now() + timedelta(days=1), revoked_at=timezone.now())
    assert status_of(client, here) == 401
    ApiToken.objects.update(revoked_at=None)
    User.objects.update(is_active=False)
    assert status_of(client, here) == 401
    for header in ("Bearer", "Bearer ", "Bearer spw_ünknown", "Basic spw_x", "Bearer " + 300 * "x"):
        assert status_of(Client(headers={"Authorization": header}), here) == 401
    assert status_of(Client(), here) == 401


@pytest.mark.parametrize("token", [None, "", "another" + 25 * "x", 40 * "x"])
def test_a_session_without_its_csrf_token_is_refused(here: World, token: str | None) -> None:
    answer = asked(session_of(a_user(Role.OPERATOR)), plan_body(here.towers[2]), headers={} if token is None else {"X-CSRFToken": token})
    assert answer.status_code == 403
    assert answer.json()["error"]["code"] == "permission_denied"


def test_a_session_of_another_site_is_refused(here: World) -> None:
    headers = {"X-CSRFToken": CSRF_TOKEN, "Origin": "https://elsewhere.example"}
    assert status_of(session_of(a_user(Role.OPERATOR)), here, headers=headers) == 403


def test_a_session_that_may_not_plan_is_refused(here: World) -> None:
    viewer, operator = a_user(Role.VIEWER), a_user(Role.OPERATOR)
    left = session_of(operator)
    User.objects.filter(pk=operator.pk).update(is_active=False)
    for client, status in ((session_of(viewer), 403), (left, 401)):
        assert status_of(client, here, headers={"X-CSRFToken": CSRF_TOKEN}) == status


def test_a_key_is_answered_once(here: World) -> None:
    client, body = program_of(a_user(Role.OPERATOR)), plan_body(here.towers[2])
    first, second = (asked(client, body, headers={"Idempotency-Key": "k1"}) for _ in range(2))
    assert (first.status_code, second.status_code) == (200, 200)
    assert second["Idempotency-Replayed"] == "true"
    assert first.json() == second.json()
    assert status_of(client, here, headers={"Idempotency-Key": ""}) == 400
    assert asked(client, plan_body(here.towers[3]), headers={"Idempotency-Key": "k1"}).status_code == 422


def test_a_small_plan_is_waited_for_by_nobody(here: World) -> None:
    answer = asked(program_of(a_user(Role.OPERATOR)), plan_body(here.towers[2]), headers={"Prefer": "wait=5"})
    assert answer.status_code == 200
    assert "Preference-Applied" not in answer


@pytest.mark.parametrize(("accept", "status"), [("text/html", 406), ("", 200), ("application/json;q=0.5, text/html", 200)])
def test_the_form_of_an_answer_is_agreed_on(here: World, accept: str, status: int) -> None:
    assert status_of(program_of(a_user(Role.OPERATOR)), here, headers={"Accept": accept}) == status


@pytest.mark.parametrize("after", ["\xa0", "\x85", "\x1c", "\x1f", "x"])
def test_a_token_with_anything_after_it_is_another_one_and_blanks_are_nothing(here: World, after: str) -> None:
    token = create_api_token(user=a_user(Role.OPERATOR), name="load", expires_at=timezone.now() + timedelta(days=1))
    assert status_of(Client(headers={"Authorization": f"Bearer {token}{after}"}), here) == 401
    assert status_of(Client(headers={"Authorization": f"  bearer   {token}  "}), here) == 200


def test_the_use_of_a_token_is_noted(here: World) -> None:
    asked(program_of(a_user(Role.OPERATOR)), plan_body(here.towers[2]))
    assert ApiToken.objects.get().last_used_at is not None


def test_who_asks_too_often_is_told_when_to_ask_again(here: World) -> None:
    client = program_of(a_user(Role.OPERATOR))
    forget_counts()
    with mock.patch.object(ScopedRate, "THROTTLE_RATES", {"plans": "4/hour"}):
        statuses = [status_of(client, here) for _ in range(4)]
        answer = asked(client, plan_body(here.towers[2]))
    forget_counts()
    assert statuses == [200] * 4
    assert answer.status_code == 429
    assert 0 < int(answer["Retry-After"]) <= 3600


def test_without_a_network_there_is_no_plan(here: World) -> None:
    GraphSnapshot.objects.all().delete()
    answer = asked(program_of(a_user(Role.OPERATOR)), plan_body(here.towers[2]))
    assert (answer.status_code, answer.json()["error"]["code"]) == (503, "no_graph")


@pytest.mark.parametrize(
    "where", ["workspace.api.authentication.prepared_rows", "missions.services.planning.planner.current_dataset_version"]
)
def test_without_the_database_there_is_no_plan(here: World, where: str) -> None:
    client = program_of(a_user(Role.OPERATOR))
    with mock.patch(where, side_effect=OperationalError("away")):
        answer = asked(client, plan_body(here.towers[2]))
    assert (answer.status_code, answer.json()["error"]["code"]) == (503, "database_away")
