"""Sessions in browsers: when they end, who sees them, and how each is ended."""

from datetime import UTC, datetime, timedelta
from typing import Any

import pytest
from django.contrib.sessions.models import Session
from django.test import Client
from django.utils import timezone
from hypothesis import given
from hypothesis import strategies as st

from tests.accounts.users import a_user, client_of
from workspace.api_tokens import create_api_token
from workspace.models import AuditEntry, BrowserSession, User
from workspace.sessions.browser_sessions import SessionRules, ends_at, forget_ended_sessions, note_session, session_ends_at
from workspace.sessions.session_store import SessionStore

pytestmark = pytest.mark.django_db
RULES = SessionRules(longest_s=14 * 86_400, idle_s=7_200, watching_s=43_200)
BEGAN = datetime(2026, 6, 1, 6, tzinfo=UTC)
FIREFOX = "Mozilla/5.0 (X11; Linux x86_64; rv:140.0) Gecko/20100101 Firefox/140.0"


def hours(number: float) -> timedelta:
    return timedelta(hours=number)


def ends(acted_h: float, present_h: float, rules: SessionRules = RULES) -> float:
    """Hours after the session began."""
    end = ends_at(began_at=BEGAN, acted_at=BEGAN + hours(acted_h), present_at=BEGAN + hours(present_h), rules=rules)
    return (end - BEGAN) / hours(1)


def test_a_session_ends_two_hours_after_somebody_was_there() -> None:
    assert ends(acted_h=1, present_h=1) == 3


def test_an_open_page_keeps_it_for_twelve_hours_without_an_act() -> None:
    assert ends(acted_h=1, present_h=9) == 11
    assert ends(acted_h=1, present_h=12.5) == 13


def test_nothing_keeps_it_beyond_its_longest_life() -> None:
    assert ends(acted_h=14 * 24 - 1, present_h=14 * 24 - 1) == 14 * 24


@given(st.floats(0, 400), st.floats(0, 400))
def test_to_be_there_longer_never_ends_it_earlier(acted_h: float, present_h: float) -> None:
    assert ends(acted_h, present_h + 1) >= ends(acted_h, present_h)
    assert ends(acted_h + 1, present_h) >= ends(acted_h, present_h)


def row_of(client: Client) -> BrowserSession:
    client.get("/account")
    return BrowserSession.objects.get(session_id=client.session.session_key)


def ago(row: BrowserSession, **times: timedelta) -> None:
    BrowserSession.objects.filter(pk=row.pk).update(**{name: timezone.now() - before for name, before in times.items()})


def times_of(row: BrowserSession) -> tuple[datetime, datetime]:
    row.refresh_from_db()
    return row.acted_at, row.present_at


def is_in(client: Client) -> bool:
    return bool(client.get("/api/v1/account").status_code == 200)


def test_somebody_who_was_away_too_long_signs_in_again() -> None:
    client = client_of(a_user())
    row = row_of(client)
    ago(row, acted_at=hours(1.9), present_at=hours(1.9))
    assert is_in(client)
    ago(row, acted_at=hours(2.1), present_at=hours(2.1))
    assert not is_in(client)
    assert not Session.objects.exists(), "the row is gone, not only unread"


def test_a_page_that_reads_keeps_the_session_and_counts_as_no_act() -> None:
    client = client_of(a_user())
    row = row_of(client)
    ago(row, acted_at=hours(1.5), present_at=hours(1.5))
    before = row.present_at - hours(1.5)
    assert is_in(client)
    acted_at, present_at = times_of(row)
    assert timezone.now() - acted_at > hours(1.4)
    assert timezone.now() - present_at < hours(0.1)
    assert before < present_at


def test_opening_a_page_and_sending_something_are_acts() -> None:
    client = client_of(a_user())
    row = row_of(client)
    for act in (lambda: client.get("/account"), lambda: client.post("/api/v1/account/session")):
        ago(row, acted_at=hours(1.5), present_at=hours(1))
        act()
        assert timezone.now() - times_of(row)[0] < hours(0.1)


def test_asking_how_long_the_session_lasts_makes_it_no_longer() -> None:
    client = client_of(a_user())
    row = row_of(client)
    ago(row, acted_at=hours(1.5), present_at=hours(1.5))
    assert 1_700 <= client.get("/api/v1/account/session").json()["ends_in_s"] <= 1_800
    assert timezone.now() - times_of(row)[1] > hours(1.4)
    assert client.post("/api/v1/account/session").json()["ends_in_s"] > 7_100


def test_a_session_that_an_earlier_version_began_goes_on() -> None:
    client = client_of(a_user())
    BrowserSession.objects.all().delete()
    assert is_in(client)
    assert BrowserSession.objects.count() == 1


def test_the_version_before_deletes_a_session_without_knowing_of_its_times() -> None:
    row = row_of(client_of(a_user()))
    Session.objects.filter(pk=row.session_id)._raw_delete("default")  # type: ignore[attr-defined]
    assert BrowserSession.objects.exists()
    forget_ended_sessions()
    assert not BrowserSession.objects.exists()


def test_sessions_that_are_over_are_forgotten() -> None:
    idle, unattended, old, lasting = (row_of(client_of(a_user())) for _ in range(4))
    ago(idle, present_at=hours(3), acted_at=hours(3))
    ago(unattended, acted_at=hours(13))
    Session.objects.filter(pk=old.session_id).update(expire_date=timezone.now() - hours(1))
    forget_ended_sessions()
    assert list(BrowserSession.objects.all()) == [lasting]
    assert Session.objects.get().pk == lasting.session_id


def test_an_open_websocket_is_presence_and_no_act() -> None:
    user = a_user()
    row = row_of(client_of(user))
    ago(row, acted_at=hours(1.5), present_at=hours(1.5))
    store: Any = SessionStore(session_key=row.session_id)
    store.load()
    note_session(store, user, is_act=False)
    acted_at, present_at = times_of(row)
    assert timezone.now() - acted_at > hours(1.4)
    assert timezone.now() - present_at < hours(0.1)


def listed(client: Client) -> list[dict[str, Any]]:
    return client.get("/api/v1/account/sessions").json()["results"]  # type: ignore[no-any-return]


def twice_in() -> tuple[User, Client, Client]:
    user = a_user()
    here, there = client_of(user), client_of(user)
    there.get("/account", headers={"User-Agent": FIREFOX})
    here.get("/account")
    return user, here, there


def test_somebody_sees_their_own_sessions_alone_and_which_one_this_is() -> None:
    user, here, _ = twice_in()
    client_of(a_user()).get("/account")
    found = listed(here)
    assert {session["user_agent"] for session in found} == {FIREFOX, ""}
    assert [session["user_agent"] for session in found if session["is_this_one"]] == [""]
    assert set(found[0]) == {
        "id", "user_agent", "address", "place", "began_at", "present_at", "ends_at", "is_this_one",
    }, "and no key of a session"  # fmt: skip
    row = user.browser_sessions.get(user_agent=FIREFOX)
    assert session_ends_at(row) == row.present_at + hours(2)


def test_one_session_is_ended_and_the_others_stay() -> None:
    user, here, there = twice_in()
    other = next(session for session in listed(here) if not session["is_this_one"])
    assert here.delete(f"/api/v1/account/sessions/{other['id']}").status_code == 204
    assert (is_in(here), is_in(there)) == (True, False)
    assert AuditEntry.objects.get(action="session ended").subject_id == str(user.pk)


def test_nobody_ends_a_session_of_somebody_else_or_with_a_token() -> None:
    user, here, _ = twice_in()
    row = row_of(client_of(a_user()))
    assert here.delete(f"/api/v1/account/sessions/{row.pk}").status_code == 404
    token = create_api_token(user=user, name="script", expires_at=timezone.now() + timedelta(days=1))
    program = Client(headers={"Authorization": f"Bearer {token}"})
    assert program.delete(f"/api/v1/account/sessions/{user.browser_sessions.get(user_agent='').pk}").status_code == 403
    assert program.get("/api/v1/account/session").status_code == 404


def test_after_signing_out_everywhere_else_the_others_are_not_listed() -> None:
    _, here, there = twice_in()
    here.post("/api/v1/account/sign-out-everywhere")
    assert [session["is_this_one"] for session in listed(here)] == [True]
    assert not is_in(there)


def test_what_outlives_a_session_wants_the_password_again_after_a_while(settings: Any) -> None:
    settings.PASSWORD_HASHERS = ["django.contrib.auth.hashers.MD5PasswordHasher"]
    user, here, there = twice_in()
    user.set_password("inspect-the-lines")
    user.save()
    here, there = client_of(user), client_of(user)
    rows = {client: row_of(client) for client in (here, there)}

    def asked() -> list[int]:
        token = {"name": "script", "days": 1}
        return [
            here.post("/api/v1/account/tokens", token, content_type="application/json").status_code,
            here.delete(f"/api/v1/account/sessions/{rows[there].pk}").status_code,
        ]

    ago(rows[here], began_at=hours(0.3))
    assert asked() == [403, 403]
    assert here.post("/api/v1/account/proof", {"password": "wrong"}, content_type="application/json").status_code == 400
    assert asked() == [403, 403]
    assert is_in(there)
    assert here.post("/api/v1/account/proof", {"password": "inspect-the-lines"}, content_type="application/json").status_code == 204
    assert asked() == [201, 204]


def test_browsers_keep_no_page_and_no_answer_that_does_not_say_so() -> None:
    client = client_of(a_user())
    assert {client.get(path)["Cache-Control"] for path in ("/account", "/", "/api/v1/account", "/api/v1/jobs")} == {"no-store"}


def test_a_session_of_the_version_before_django_allauth_stays() -> None:
    vera = a_user()
    store = SessionStore()
    store.update(
        {
            "_auth_user_id": str(vera.pk),
            "_auth_user_backend": "workspace.api.authentication.RoleBackend",
            "_auth_user_hash": vera.get_session_auth_hash(),
        }
    )
    store.save()
    client = Client()
    client.cookies["sessionid"] = store.session_key
    assert client.get("/api/v1/account").json()["username"] == vera.username
