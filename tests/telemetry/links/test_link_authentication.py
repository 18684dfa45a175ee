"""A UAV is let in by its own token, a user by theirs, and neither by the other's."""

from datetime import timedelta

import pytest
from django.test import Client
from django.utils import timezone

from missions.models import CredentialKind, UavCredential, UavState
from missions.services import make_credential, revoke_credential
from telemetry.models import TelemetryRecord, UavLink
from telemetry.views import uav_authentication
from tests.accounts.users import a_user, client_of
from tests.telemetry.links.uav_clients import LINK, linked_uav, report
from workspace.api_tokens import create_api_token
from workspace.models import Role

pytestmark = pytest.mark.django_db


def test_a_uav_is_let_in_and_has_been_heard() -> None:
    kite = linked_uav()
    assert kite.report(report()).status_code == 200
    link = UavLink.objects.get(uav=kite.uav)
    assert link.last_message_at is not None
    assert link.address == "http 127.0.0.1"
    assert UavCredential.objects.get(uav=kite.uav).last_used_at is not None


def test_the_use_of_a_token_is_noted_once_a_minute() -> None:
    kite = linked_uav()
    kite.report(report())
    first = UavCredential.objects.get(uav=kite.uav).last_used_at
    kite.report(report(2))
    assert UavCredential.objects.get(uav=kite.uav).last_used_at == first
    UavCredential.objects.update(last_used_at=first - timedelta(minutes=1))
    kite.report(report(3))
    assert UavCredential.objects.get(uav=kite.uav).last_used_at > first


@pytest.mark.parametrize("header", ["", "Bearer", "Bearer spu_wrong", "Bearer spu_\xe4", "Bearer " + "x" * 300, "Basic a2l0ZTpraXRl"])
def test_who_has_no_token_of_a_uav_is_not_let_in(header: str) -> None:
    answer = Client().post(f"{LINK}/telemetry", "{}", content_type="application/json", headers={"Authorization": header} if header else {})
    assert answer.status_code == 401
    assert answer["WWW-Authenticate"] == "Bearer"


def test_a_replaced_a_revoked_and_a_retired_uavs_token_count_no_more_at_once() -> None:
    replaced, revoked, retired = linked_uav("One"), linked_uav("Two"), linked_uav("Three")
    make_credential(uav=replaced.uav, actor=a_user(), kind=CredentialKind.LINK_TOKEN)
    revoke_credential(credential=UavCredential.objects.get(uav=revoked.uav), actor=a_user())
    retired.uav.state = UavState.RETIRED
    retired.uav.save()
    answers = [uav.report(report()) for uav in (replaced, revoked, retired)]
    assert [answer.status_code for answer in answers] == [401] * 3
    assert len({answer.content for answer in answers}) == 1
    assert not TelemetryRecord.objects.exists()


@pytest.mark.parametrize("role", Role)
def test_a_user_is_no_uav(role: Role) -> None:
    user = a_user(role)
    token = create_api_token(user=user, name="script", expires_at=timezone.now() + timedelta(days=1))
    with_token = Client().get(f"{LINK}/route", headers={"Authorization": f"Bearer {token}"})
    with_session = client_of(user).get(f"{LINK}/route")
    assert (with_token.status_code, with_session.status_code) == (401, 401)


def test_a_uav_is_no_user() -> None:
    kite = linked_uav()
    for address in ("uavs", "missions", "account", "telemetry", f"uavs/{kite.uav.pk}"):
        assert kite.client.get(f"/api/v1/{address}", headers=kite.headers).status_code == 401, address


def test_a_session_beside_a_uavs_token_changes_nothing() -> None:
    kite = linked_uav()
    kite.client.force_login(a_user(Role.ADMINISTRATOR))
    answer = kite.report(report())
    assert answer.status_code == 200
    assert TelemetryRecord.objects.get().uav == kite.uav


def test_a_network_that_guesses_is_slowed_down_and_a_right_token_is_not(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(uav_authentication, "WRONG_TOKENS", 3)
    kite = linked_uav()
    wrong = [Client().get(f"{LINK}/route", headers={"Authorization": f"Bearer spu_{guess}"}) for guess in range(5)]
    assert [answer.status_code for answer in wrong] == [401, 401, 401, 429, 429]
    assert int(wrong[-1]["Retry-After"]) > 0
    assert kite.report(report()).status_code == 200


def test_a_uav_that_asks_all_the_time_is_told_to_wait_and_another_is_not(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(uav_authentication.UavRate, "THROTTLE_RATES", {"uav-link": "3/hour"})
    kite, tern = linked_uav("Kite"), linked_uav("Tern")
    assert [kite.report(report(number)).status_code for number in range(5)] == [200, 200, 200, 429, 429]
    assert tern.report(report()).status_code == 200


def test_the_token_is_in_no_answer_and_no_log(caplog: pytest.LogCaptureFixture) -> None:
    kite = linked_uav()
    answers = [kite.report(report()), kite.report({}), kite.get("route"), kite.post("results", {})]
    assert not [answer for answer in answers if kite.token.encode() in answer.content]
    assert kite.token not in caplog.text
