"""The short way of a small plan: the view's own answers, the view's own refusals."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
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
from missions.views.fast_path import small_plan
from tests.accounts.users import somebody
from tests.missions.api import plan_body
from tests.missions.worlds import World, world
from tests.workspace.counters import forget_counts
from workspace.api.throttling import ScopedRate
from workspace.api_tokens import create_api_token
from workspace.models import ApiToken, Role, User

pytestmark = pytest.mark.django_db
SHORT_WAYS = ("missions.views.fast_path_middleware.small_plan", "missions.views.plans.small_plan")
CSRF_TOKEN = "k" * 32
TOLD = ("Content-Type", "Cache-Control", "Vary", "X-Frame-Options", "X-Content-Type-Options")


@pytest.fixture
def here() -> World:
    return world()


def program_of(user: User) -> Client:
    token = create_api_token(user=user, name="load", expires_at=timezone.now() + timedelta(days=1))
    return Client(headers={"Authorization": f"Bearer {token}"}, raise_request_exception=False)


def asked(client: Client, body: Any, **options: Any) -> Any:
    return client.post("/api/v1/plans", body, content_type="application/json", **options)


def both_ways(client: Client, body: Any, **options: Any) -> tuple[Any, Any, bool]:
    """The answer, the answer of the view alone, and whether the short way was gone."""
    taken = []

    def noted(*args: Any, **kwargs: Any) -> Any:
        taken.append(small_plan(*args, **kwargs))
        return taken[-1]

    with mock.patch(SHORT_WAYS[0], noted), mock.patch(SHORT_WAYS[1], noted):
        first = asked(client, body, **options)
    with the_view_alone():
        second = asked(client, body, **options)
    return first, second, any(answer is not None for answer in taken)


@contextmanager
def the_view_alone() -> Iterator[None]:
    with mock.patch(SHORT_WAYS[0], return_value=None), mock.patch(SHORT_WAYS[1], return_value=None):
        yield


def test_the_answer_is_the_views_byte_for_byte(here: World) -> None:
    client = program_of(somebody(Role.OPERATOR))
    bodies = [
        plan_body(here.towers[2], here.towers[4]),
        plan_body(here.towers[1], {"position": [10.0, 56.3]}),  # the second is too far away: said in words
        plan_body(here.line),
        plan_body(here.towers[0], objective="makespan", return_to_start=True),
    ]
    for body in bodies:
        short, long, _ = both_ways(client, body)
        assert short.status_code == long.status_code == 200, short.content
        assert short.content == long.content
        assert {name: short[name] for name in short.headers if name not in ("Allow", "X-Request-ID")} == {
            name: long[name] for name in long.headers if name not in ("Allow", "Vary", "X-Request-ID")
        }
    assert both_ways(client, bodies[0])[2]


@pytest.mark.parametrize(
    "body",
    [
        b"",
        b"{",
        b"[]",
        b'{"uavs": NaN}',
        b'\xff{"uavs": []}',
        json.dumps({"uavs": [], "targets": []}).encode(),
        json.dumps({"uavs": [{"name": "A", "position": [10, 91]}], "targets": [{"position": [10, 56]}]}).encode(),
        json.dumps({"uavs": [{"name": "A", "position": [10, 56]}], "targets": [{"asset": 999_999_999}]}).encode(),
        b" " * 70_000 + b"{}",
    ],
    ids=["empty", "half", "list", "nan", "no utf-8", "nobody", "north of the pole", "unknown asset", "long"],
)
def test_what_is_wrong_is_said_by_the_view(here: World, body: bytes) -> None:
    short, long, gone = both_ways(program_of(somebody(Role.OPERATOR)), body)
    assert not gone
    assert short.status_code == long.status_code == 400
    assert short.content == long.content


def test_the_headers_are_the_views(here: World) -> None:
    first, second, gone = both_ways(program_of(somebody(Role.OPERATOR)), plan_body(here.towers[2]))
    assert gone
    told = {*first.headers, *second.headers} - {"X-Request-ID", "Allow"}
    assert {name: first.headers.get(name) for name in told} == {name: second.headers.get(name) for name in told}


def test_another_hosts_name_is_refused(here: World) -> None:
    first, second, gone = both_ways(program_of(somebody(Role.OPERATOR)), plan_body(here.towers[2]), headers={"Host": "elsewhere.example"})
    assert not gone
    assert first.status_code == second.status_code == 400


def test_a_plan_is_made_in_the_language_that_is_asked_for(here: World) -> None:
    make_plan = services.make_plan
    languages = []

    def noted(**kwargs: Any) -> Any:
        languages.append(translation.get_language())
        return make_plan(**kwargs)

    with mock.patch.object(services, "make_plan", noted):
        for language in ("de", "en"):
            _, _, gone = both_ways(program_of(somebody(Role.OPERATOR)), plan_body(here.towers[2]), headers={"Accept-Language": language})
            assert gone
    assert languages == ["de", "de", "en", "en"]


def test_requests_are_counted_by_the_address_they_came_to(here: World) -> None:
    answer, _, gone = both_ways(program_of(somebody(Role.OPERATOR)), plan_body(here.towers[2]))
    assert gone
    assert answer.resolver_match.route == "api/v1/plans"


@pytest.mark.parametrize("role", Role)
def test_a_role_may_plan_the_short_way_if_the_view_lets_it(here: World, role: Role) -> None:
    short, long, gone = both_ways(program_of(somebody(role)), plan_body(here.towers[2]))
    assert short.status_code == long.status_code == (200 if role in (Role.OPERATOR, Role.ADMINISTRATOR) else 403)
    assert gone == (short.status_code == 200)


def refused(client: Client, here: World) -> int:
    short, long, gone = both_ways(client, plan_body(here.towers[2]))
    assert not gone
    assert short.status_code == long.status_code
    return short.status_code


def test_no_token_no_plan(here: World) -> None:
    user = somebody(Role.OPERATOR)
    client = program_of(user)
    assert asked(client, plan_body(here.towers[2])).status_code == 200
    ApiToken.objects.update(expires_at=timezone.now())
    assert refused(client, here) == 401
    ApiToken.objects.update(expires_at=timezone.now() + timedelta(days=1), revoked_at=timezone.now())
    assert refused(client, here) == 401
    ApiToken.objects.update(revoked_at=None)
    User.objects.update(is_active=False)
    assert refused(client, here) == 401
    for header in ("Bearer", "Bearer ", "Bearer spw_ünknown", "Basic spw_x", "Bearer " + 300 * "x"):
        assert refused(Client(headers={"Authorization": header}), here) == 401
    assert refused(Client(), here) == 401


def session_of(user: User) -> Client:
    """A browser whose CSRF token is asked for, with a cookie for one."""
    client = Client(enforce_csrf_checks=True, raise_request_exception=False)
    client.force_login(user)
    client.cookies[settings.CSRF_COOKIE_NAME] = CSRF_TOKEN
    return client


def test_a_session_with_its_csrf_token_has_the_views_answer(here: World) -> None:
    client = session_of(somebody(Role.OPERATOR))
    first, second, gone = both_ways(client, plan_body(here.towers[2], here.towers[4]), headers={"X-CSRFToken": CSRF_TOKEN})
    assert gone
    assert first.status_code == second.status_code == 200
    assert first.content == second.content
    assert {name: first[name] for name in TOLD} == {name: second[name] for name in TOLD}


@pytest.mark.parametrize("token", [None, "", "another" + 25 * "x", 40 * "x"])
def test_a_session_without_its_csrf_token_is_refused_as_by_the_view(here: World, token: str | None) -> None:
    client = session_of(somebody(Role.OPERATOR))
    headers = {} if token is None else {"X-CSRFToken": token}
    first, second, gone = both_ways(client, plan_body(here.towers[2]), headers=headers)
    assert not gone
    assert first.status_code == second.status_code == 403
    assert first.json() == second.json()


def test_a_session_of_another_site_is_refused(here: World) -> None:
    client = session_of(somebody(Role.OPERATOR))
    headers = {"X-CSRFToken": CSRF_TOKEN, "Origin": "https://elsewhere.example"}
    first, second, gone = both_ways(client, plan_body(here.towers[2]), headers=headers)
    assert not gone
    assert first.status_code == second.status_code == 403


def test_a_session_that_may_not_plan_is_refused(here: World) -> None:
    viewer, operator = somebody(Role.VIEWER), somebody(Role.OPERATOR)
    left = session_of(operator)
    User.objects.filter(pk=operator.pk).update(is_active=False)
    for client, status in ((session_of(viewer), 403), (left, 401)):
        first, second, gone = both_ways(client, plan_body(here.towers[2]), headers={"X-CSRFToken": CSRF_TOKEN})
        assert not gone
        assert first.status_code == second.status_code == status


def test_a_key_and_a_preference_are_for_the_view(here: World) -> None:
    client = program_of(somebody(Role.OPERATOR))
    for headers in ({"Idempotency-Key": "k1"}, {"Idempotency-Key": ""}, {"Prefer": "wait=5"}, {"Accept": "text/html"}, {"Accept": ""}):
        assert not both_ways(client, plan_body(here.towers[2]), headers=headers)[2]


@pytest.mark.parametrize("after", ["\xa0", "\x85", "\x1c", "\x1f", "x"])
def test_a_token_with_anything_after_it_is_another_one_and_blanks_are_nothing(here: World, after: str) -> None:
    token = create_api_token(user=somebody(Role.OPERATOR), name="load", expires_at=timezone.now() + timedelta(days=1))
    assert refused(Client(headers={"Authorization": f"Bearer {token}{after}"}), here) == 401
    padded = Client(headers={"Authorization": f"  bearer   {token}  "})
    assert both_ways(padded, plan_body(here.towers[2]))[0].status_code == 200


def test_the_use_of_a_token_is_noted(here: World) -> None:
    asked(program_of(somebody(Role.OPERATOR)), plan_body(here.towers[2]))
    assert ApiToken.objects.get().last_used_at is not None


def test_both_ways_count_as_one(here: World) -> None:
    client = program_of(somebody(Role.OPERATOR))
    forget_counts()
    with mock.patch.object(ScopedRate, "THROTTLE_RATES", {"plans": "4/hour"}):
        statuses = [asked(client, plan_body(here.towers[2])).status_code for _ in range(2)]
        with the_view_alone():
            statuses += [asked(client, plan_body(here.towers[2])).status_code for _ in range(2)]
        answer = asked(client, plan_body(here.towers[2]))
    forget_counts()
    assert statuses == [200] * 4
    assert answer.status_code == 429
    assert 0 < int(answer["Retry-After"]) <= 3600


def test_without_a_network_the_view_says_so(here: World) -> None:
    GraphSnapshot.objects.all().delete()
    short, _, gone = both_ways(program_of(somebody(Role.OPERATOR)), plan_body(here.towers[2]))
    assert not gone
    assert (short.status_code, short.json()["error"]["code"]) == (503, "no_graph")


@pytest.mark.parametrize("where", ["missions.views.fast_path.holder_of", "missions.services.planning.planner.edition_now"])
def test_without_the_database_the_view_says_so(here: World, where: str) -> None:
    client = program_of(somebody(Role.OPERATOR))
    with mock.patch(where, side_effect=OperationalError("away")):
        _, _, gone = both_ways(client, plan_body(here.towers[2]))
    with mock.patch("workspace.api.authentication.prepared_rows", side_effect=OperationalError("away")):
        answer = asked(client, plan_body(here.towers[2]))
    assert not gone
    assert (answer.status_code, answer.json()["error"]["code"]) == (503, "database_away")
