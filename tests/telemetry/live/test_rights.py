"""Who may listen: every websocket against every role, organisation and token, and for how long (findings: S4)."""

import time
from collections.abc import Callable
from datetime import timedelta
from typing import Any

import pytest
from django.contrib.sessions.models import Session
from django.utils import timezone
from websocket import WebSocket, WebSocketBadStatusException

from config.websocket_urls import websocket_urlpatterns
from missions.models import CredentialKind, Mission
from missions.services.fleet.credentials import make_credential
from tests.accounts.users import a_user
from tests.missions.commands.outbox import a_uav
from tests.telemetry.live.page import Page
from tests.workspace.live.proxied_site import Endpoint, close_code
from workspace.api_tokens import create_api_token
from workspace.jobs.services import create_job
from workspace.live import sockets
from workspace.models import ApiToken, Organisation, Role, User

pytestmark = pytest.mark.django_db(transaction=True)

SOON_S = 8.0  # what is promised is 5 s; tests run beside others


def a_mission(organisation: Organisation) -> Mission:
    return Mission.objects.create(name="Bexley", organisation=organisation)


def live_of_mission(organisation: Organisation) -> str:
    return f"/ws/missions/{a_mission(organisation).pk}/live"


def job(organisation: Organisation) -> str:
    return f"/ws/jobs/{create_job(organisation=organisation, created_by=None, task='missions.tasks.solve_plan', parameters={}).pk}"


# Every route: where it leads in an organisation. None belongs to nothing: everybody sees what is their own organisation's.
ROUTES: dict[str, Callable[[Organisation], str] | None] = {
    "ws/live": None,
    "ws/missions/<uuid:mission_id>/live": live_of_mission,
    "ws/jobs/<uuid:job_id>": job,
}


def token_of(user: User) -> str:
    return create_api_token(user=user, name="test", expires_at=timezone.now() + timedelta(hours=1))


def is_let_in(endpoint: Endpoint, path: str, **who: Any) -> bool:
    try:
        endpoint.open(path, **who).close()
    except WebSocketBadStatusException as refused:
        assert refused.status_code == 403
        return False
    return True


def test_every_route_is_in_the_table() -> None:
    assert {str(route.pattern) for route in websocket_urlpatterns} == set(ROUTES)


@pytest.mark.parametrize("route", ROUTES)
def test_every_role_listens_in_its_own_organisation_and_nowhere_else(here: Endpoint, route: str) -> None:
    home, elsewhere = Organisation.objects.get(pk=1), Organisation.objects.create(name="Elsewhere")
    address = ROUTES[route]
    path = "/" + route if address is None else address(home)
    for role in Role:
        own, stranger = a_user(role), a_user(role, elsewhere)
        for who in (own, stranger):
            may = address is None or who is own
            assert is_let_in(here, path, user=who) is may, role
            assert is_let_in(here, path, token=token_of(who), origin=None) is may, role
    refused = {
        "nobody": {},
        "a cookie that names no origin": {"user": a_user(), "origin": None},
        "another site with a session": {"user": a_user(), "origin": "http://evil.example"},
        "another site with a token": {"token": token_of(a_user()), "origin": "http://evil.example"},
        "a token that nobody has": {"token": "spw_none", "origin": None},
        "a token that has ended": {"token": ended_token(), "origin": None},
        "somebody who was locked out": {"token": locked_out_token(), "origin": None},
        "a UAV": {"token": uav_token(), "origin": None},
        "a session that has ended, under another's name": {"user": a_user(), "token": "spw_none"},
    }
    assert [what for what, who in refused.items() if is_let_in(here, path, **who)] == []


def test_what_is_not_there_or_deleted_lets_nobody_in(here: Endpoint) -> None:
    user = a_user()
    deleted = a_mission(user.organisation)
    Mission.objects.filter(pk=deleted.pk).update(deleted_at=timezone.now())
    for path in (f"/ws/missions/{deleted.pk}/live", f"/ws/missions/{Mission().pk}/live", f"/ws/jobs/{Mission().pk}", "/ws/nothing"):
        with pytest.raises((WebSocketBadStatusException, OSError)):
            here.open(path, user=user)


def test_a_page_of_the_organisation_shows_nothing_of_another(here: Endpoint) -> None:
    elsewhere = Organisation.objects.create(name="Elsewhere")
    Mission.objects.create(name="theirs", organisation=elsewhere, state="draft", ended_at=timezone.now())
    Mission.objects.create(name="ours", ended_at=timezone.now())
    page = Page(here.open("/ws/live", user=a_user()))
    page.take()
    assert [mission["name"] for mission in page.shows["missions"].values()] == ["ours"]


def test_whoever_may_not_listen_any_more_is_hung_up_on_within_five_seconds(here: Endpoint) -> None:
    assert sockets.CHECK_PERSON_INTERVAL_S <= 4.0
    elsewhere = Organisation.objects.create(name="Elsewhere")
    ends: dict[str, Callable[[User], object]] = {
        "signed out everywhere": lambda user: User.objects.filter(pk=user.pk).update(session_generation=1),
        "session expired": expire_sessions,
        "signed out": forget_sessions,
        "role revoked": lambda user: User.objects.filter(pk=user.pk).update(role=Role.VIEWER),
        "locked out": lambda user: User.objects.filter(pk=user.pk).update(is_active=False),
        "organisation changed": lambda user: User.objects.filter(pk=user.pk).update(organisation=elsewhere),
        "user deleted": lambda user: user.delete(),
    }
    by_token: dict[str, Callable[[User], object]] = {
        "token revoked": lambda user: ApiToken.objects.filter(user=user).update(revoked_at=timezone.now()),
        "token expired": lambda user: ApiToken.objects.filter(user=user).update(expires_at=timezone.now()),
    }
    mission = a_mission(Organisation.objects.get(pk=1))
    opened: dict[str, tuple[User, WebSocket]] = {}
    for number, why in enumerate([*ends, *by_token]):
        user = a_user()
        who = {"token": token_of(user)} if why in by_token else {"user": user}
        opened[why] = user, here.open(f"/ws/missions/{mission.pk}/live" if number % 2 else "/ws/live", **who)
        Page(opened[why][1]).take()
    ended_s = time.monotonic()
    for why, end in (ends | by_token).items():
        end(opened[why][0])
    assert {why: close_code(socket) for why, (_, socket) in opened.items()} == dict.fromkeys(opened, 4401)
    assert time.monotonic() - ended_s < SOON_S


def test_a_page_of_a_mission_that_is_deleted_is_told_that_it_is_gone(here: Endpoint) -> None:
    mission = a_mission(Organisation.objects.get(pk=1))
    page = Page(here.open(f"/ws/missions/{mission.pk}/live", user=a_user()))
    page.take()
    ended_s = time.monotonic()
    Mission.objects.filter(pk=mission.pk).update(deleted_at=timezone.now())
    assert close_code(page.socket) == 4404
    assert time.monotonic() - ended_s < SOON_S


@pytest.mark.parametrize(
    "message",
    [
        pytest.param("x" * 1_000_000, id="a megabyte"),
        pytest.param(b'{"type": "resync"}', id="bytes"),
        pytest.param('{"type": "resync"' + " " * 5_000 + "}", id="more than 4 kB"),
        pytest.param("{", id="no JSON"),
        pytest.param("[1]", id="no object"),
        pytest.param('{"type":"drop"}', id="an unknown word"),
        pytest.param('{"type": "ack","sequence":7}', id="has what it was never told"),
        pytest.param('{"type": "ack","sequence":"1"}', id="no number"),
        pytest.param('{"type": "resync","and":1}', id="more than it may say"),
    ],
)
def test_whoever_says_what_no_page_says_is_hung_up_on(here: Endpoint, message: str | bytes) -> None:
    page = Page(here.open("/ws/live", user=a_user()))
    page.take()
    (page.socket.send if isinstance(message, str) else page.socket.send_binary)(message)
    assert close_code(page.socket) == 4400


def ended_token() -> str:
    token = token_of(user := a_user())
    ApiToken.objects.filter(user=user).update(expires_at=timezone.now())
    return token


def locked_out_token() -> str:
    token = token_of(user := a_user())
    User.objects.filter(pk=user.pk).update(is_active=False)
    return token


def uav_token() -> str:
    return make_credential(uav=a_uav("Tern"), actor=a_user(), kind=CredentialKind.LINK_TOKEN).secret


def sessions_of(user: User) -> list[Session]:
    return [session for session in Session.objects.all() if session.get_decoded().get("_auth_user_id") == str(user.pk)]


def expire_sessions(user: User) -> None:
    Session.objects.filter(pk__in=[session.pk for session in sessions_of(user)]).update(expire_date=timezone.now())


def forget_sessions(user: User) -> None:
    Session.objects.filter(pk__in=[session.pk for session in sessions_of(user)]).delete()
