"""Whoever has lost their password gets a link by mail; nobody learns who has an account."""

import re
import threading
import time
from collections.abc import Callable
from typing import Any

import pytest
from django.core import mail
from django.core.cache import cache
from django.test import Client

from config.environment import WrongMailAddress, mail_settings
from workspace.models import User

pytestmark = pytest.mark.django_db
OLD, NEW = "inspect-the-lines", "walk-the-corridor"


@pytest.fixture(autouse=True)
def _no_tries_yet() -> None:
    cache.clear()


@pytest.fixture
def vera() -> User:
    return User.objects.create_user("vera", "vera@example.org", OLD)


def ask(client: Client, email: str) -> str:
    return client.post("/lost-password", {"email": email}, follow=True).content.decode()


def mails(number: int) -> int:
    """How many there are; mails go out beside the answer, so as many are waited for."""
    deadline = time.monotonic() + 10
    while len(mail.outbox) < number and time.monotonic() < deadline:
        time.sleep(0.01)
    return len(mail.outbox)


def link_of_the_mail() -> str:
    assert mails(1)
    found = re.search(r"https?://[^/]+(/new-password/\S+)", mail.outbox[-1].body)
    assert found
    return found[1]


def test_the_mail_is_in_the_language_of_the_page_that_asked_for_it(client: Client, vera: User) -> None:
    client.post("/lost-password", {"email": "vera@example.org"}, headers={"Accept-Language": "de"})
    assert mails(1)
    assert mail.outbox[-1].subject == "Ein neues Passwort für Spanwise"


def test_the_link_of_the_mail_sets_a_new_password_once(client: Client, vera: User) -> None:
    assert "Look into your mail" in ask(client, "vera@example.org")
    link = link_of_the_mail()
    form = client.get(link, follow=True)
    answer = client.post(form.request["PATH_INFO"], {"new_password1": NEW, "new_password2": NEW}, follow=True)
    assert "The password is set" in answer.content.decode()
    vera.refresh_from_db()
    assert vera.check_password(NEW)
    assert "does not work any more" in Client().get(link, follow=True).content.decode()


def test_a_weak_password_is_refused_with_the_reason(client: Client, vera: User) -> None:
    ask(client, "vera@example.org")
    form = client.get(link_of_the_mail(), follow=True)
    answer = client.post(form.request["PATH_INFO"], {"new_password1": "12345678", "new_password2": "12345678"})
    assert "too common" in answer.content.decode()
    vera.refresh_from_db()
    assert vera.check_password(OLD)


def test_the_answer_does_not_tell_who_has_an_account(client: Client, vera: User) -> None:
    known, unknown = ask(client, "vera@example.org"), ask(client, "nobody@example.org")
    assert known == unknown
    assert mails(1) == 1


def test_the_answer_does_not_wait_for_the_mail_server(client: Client, vera: User, monkeypatch: pytest.MonkeyPatch) -> None:
    answered, sent = threading.Event(), threading.Event()
    send: Callable[..., Any] = mail.EmailMultiAlternatives.send

    def slow(message: Any, *args: Any) -> Any:
        assert answered.wait(10)
        result = send(message, *args)
        sent.set()
        return result

    monkeypatch.setattr("django.contrib.auth.forms.EmailMultiAlternatives.send", slow)
    assert "Look into your mail" in ask(client, "vera@example.org")
    assert mail.outbox == []
    answered.set()
    assert sent.wait(10)
    assert mails(1) == 1


def test_an_account_is_not_flooded_with_mails(client: Client, vera: User) -> None:
    for _ in range(5):
        ask(client, "vera@example.org")
    assert "Too many mails were asked for" in ask(Client(REMOTE_ADDR="192.0.2.7"), "vera@example.org")
    assert mails(5) == 5
    assert Client().login(username="vera", password=OLD)


def test_somebody_changes_their_own_password(client: Client, vera: User) -> None:
    assert client.get("/change-password").status_code == 302
    client.force_login(vera)
    wrong = client.post("/change-password", {"old_password": "no", "new_password1": NEW, "new_password2": NEW})
    assert "incorrectly" in wrong.content.decode()
    done = client.post("/change-password", {"old_password": OLD, "new_password1": NEW, "new_password2": NEW}, follow=True)
    assert "The password is changed" in done.content.decode()


def test_mail_goes_where_its_address_says() -> None:
    assert mail_settings("console://")["EMAIL_BACKEND"].endswith("console.EmailBackend")
    smtp = mail_settings("smtp+tls://post%40example.org:p%3Ass@mail.example.org")
    assert (smtp["EMAIL_HOST"], smtp["EMAIL_PORT"], smtp["EMAIL_HOST_USER"]) == ("mail.example.org", 587, "post@example.org")
    assert (smtp["EMAIL_HOST_PASSWORD"], smtp["EMAIL_USE_TLS"], smtp["EMAIL_USE_SSL"]) == ("p:ss", True, False)
    assert mail_settings("smtp+ssl://mail.example.org")["EMAIL_PORT"] == 465


@pytest.mark.parametrize("address", ["", "mailto:somebody", "smtp://", "smtp+tls://user:secret@host:port"])
def test_a_wrong_mail_address_is_refused_without_repeating_it(address: str) -> None:
    with pytest.raises(WrongMailAddress) as refused:
        mail_settings(address)
    assert "secret" not in str(refused.value)


@pytest.mark.parametrize(
    ("public", "host", "link"),
    [
        ("https://spanwise.example", "testserver:6666", "https://spanwise.example/new-password/"),
        ("", "testserver:6666", "http://testserver/new-password/"),
        ("", "127.0.0.1:8000", "http://127.0.0.1:8000/new-password/"),
    ],
)
def test_the_link_leads_to_the_sites_own_address(client: Client, vera: User, settings: Any, public: str, host: str, link: str) -> None:
    settings.PUBLIC_ADDRESS, settings.ALLOWED_HOSTS = public, ["testserver", "127.0.0.1"]
    client.post("/lost-password", {"email": "vera@example.org"}, headers={"Host": host})
    assert mails(1)
    assert link in mail.outbox[-1].body
    assert "6666" not in mail.outbox[-1].body


def test_without_a_way_for_mail_no_link_is_written_into_a_log(
    client: Client, vera: User, settings: Any, capfd: pytest.CaptureFixture[str], caplog: pytest.LogCaptureFixture
) -> None:
    settings.EMAIL_BACKEND = "django.core.mail.backends.console.EmailBackend"
    assert "Look into your mail" in ask(client, "vera@example.org")
    time.sleep(0.3)  # a mail would leave beside the answer
    written = "".join(capfd.readouterr())
    assert "new-password/" not in written + caplog.text
    assert "SPANWISE_EMAIL_URL names no way for mail" in caplog.text
