"""E-mail addresses: verified by a mailed link, and good for signing in where they lead to one user."""

import re
from concurrent.futures import ThreadPoolExecutor, wait
from typing import Any

import pytest
from allauth.account.models import EmailAddress
from django.core import mail
from django.core.cache import cache
from django.db import connection, transaction
from django.test import Client

from accounts.email_addresses import is_verified, user_name_of
from accounts.services import change_user
from accounts.users import save_user
from tests.accounts.authenticator_app import is_in
from tests.accounts.users import a_user, client_of
from workspace.models import AuditEntry, Role, User
from workspace.sessions.sign_in_attempts import TRIES

pytestmark = pytest.mark.django_db
PASSWORD = "inspect-the-lines"
ADDRESS = "Ida.Grid@example.org"


@pytest.fixture(autouse=True)
def _no_tries_yet() -> None:
    cache.clear()


def person(name: str, email: str = ADDRESS, **facts: Any) -> User:
    return User.objects.create_user(name, email, PASSWORD, **facts)


def signs_in(typed: str, password: str = PASSWORD, client: Client | None = None) -> bool:
    client = client or Client()
    client.post("/sign-in", {"login": typed, "password": password})
    return is_in(client)


def link_for(user: User) -> str:
    mail.outbox.clear()
    answer = client_of(user).post("/api/v1/account/email-address/verification")
    assert answer.json() == {"was_mailed": True}
    assert mail.outbox[0].to == [user.email]
    found = re.search(r"https?://[^/]+(/email-address/\S+)", mail.outbox[0].body)
    assert found is not None
    return found[1]


def verified(user: User) -> User:
    assert Client().post(link_for(user)).status_code == 200
    return user


@pytest.mark.parametrize("typed", ["ida", ADDRESS, ADDRESS.lower(), f"  {ADDRESS.upper()} "])
def test_somebody_signs_in_by_name_or_by_the_address_that_nobody_else_has(typed: str) -> None:
    person("ida")
    assert signs_in(typed)


def test_an_address_of_two_people_signs_nobody_in_until_one_has_verified_it() -> None:
    ida = person("ida")
    person("otto")
    assert not signs_in(ADDRESS)
    verified(ida)
    assert user_name_of(ADDRESS) == "ida"
    assert signs_in(ADDRESS)


def test_a_name_that_looks_like_an_address_is_a_name() -> None:
    person("grid@example.org", email="")
    verified(person("thief", email="grid@example.org"))
    assert user_name_of("grid@example.org") == "grid@example.org"


@pytest.mark.parametrize("facts", [{"is_active": False}, {"is_service": True}])
def test_addresses_of_disabled_users_and_programs_lead_nowhere(facts: dict[str, Any]) -> None:
    user = person("ida")
    if "is_service" in facts:
        user.set_unusable_password()
    User.objects.filter(pk=user.pk).update(password=user.password, **facts)
    assert user_name_of(ADDRESS) == ADDRESS


def test_tries_by_name_and_by_address_are_counted_together() -> None:
    person("ida")
    client = Client()
    for turn in range(TRIES):
        assert not signs_in(ADDRESS if turn % 2 else "ida", "wrong", client)
    assert "Too many wrong tries" in client.post("/sign-in", {"login": ADDRESS, "password": PASSWORD}).content.decode()


def test_opening_the_link_changes_nothing_and_its_button_verifies_once() -> None:
    user = person("ida")
    link = link_for(user)
    page = Client().get(link).content.decode()
    assert f"Is {ADDRESS} the address of the account ida?" in page
    assert not is_verified(user)
    assert "The address is confirmed" in Client().post(link).content.decode()
    assert is_verified(user)
    user.refresh_from_db()
    assert user.email == ADDRESS
    assert "does not work any more" in Client().post(link).content.decode()
    assert AuditEntry.objects.filter(action="address verified", subject_id=str(user.pk)).count() == 1


def test_the_link_of_an_address_that_was_changed_meanwhile_does_nothing() -> None:
    user = person("ida")
    link = link_for(user)
    change_user(user_id=user.pk, actor=a_user(Role.ADMINISTRATOR), seen_revision=None, email="new@example.org")
    assert "does not work any more" in Client().post(link).content.decode()
    assert not EmailAddress.objects.filter(verified=True).exists()


def test_a_new_address_is_not_verified_and_the_old_one_is_free() -> None:
    user = verified(person("ida"))
    change_user(user_id=user.pk, actor=a_user(Role.ADMINISTRATOR), seen_revision=None, email="new@example.org")
    user.refresh_from_db()
    assert not is_verified(user)
    assert not signs_in(ADDRESS)
    assert is_verified(verified(person("otto")))


def test_one_address_is_verified_for_one_user() -> None:
    verified(person("ida"))
    other = person("otto")
    assert "Another account has confirmed this address already" in Client().post(link_for(other)).content.decode()
    assert not is_verified(other)


@pytest.mark.parametrize("key", ["x", "a:b:c", "%00", "🛰"])
def test_damaged_links_are_reported_as_such(key: str) -> None:
    assert "does not work any more" in Client().get(f"/email-address/{key}").content.decode()


def test_mails_are_limited_and_need_a_way_for_mail(settings: Any) -> None:
    client = client_of(person("ida"))
    answers = [client.post("/api/v1/account/email-address/verification").status_code for _ in range(TRIES + 1)]
    assert answers == [200] * TRIES + [429]
    settings.EMAIL_BACKEND = "django.core.mail.backends.console.EmailBackend"
    assert client_of(person("otto")).post("/api/v1/account/email-address/verification").json() == {"was_mailed": False}


def test_a_verified_address_that_the_version_before_has_changed_is_no_longer_the_users() -> None:
    user = verified(person("ida"))
    User.objects.filter(pk=user.pk).update(email="new@example.org")
    assert user_name_of(ADDRESS) == ADDRESS


@pytest.mark.django_db(transaction=True)
def test_of_two_users_who_verify_one_address_at_once_one_gets_it() -> None:
    links = [link_for(person(name)) for name in ("ida", "otto")]

    def press(link: str) -> int:
        try:
            return Client().post(link).status_code
        finally:
            connection.close()

    with ThreadPoolExecutor(2) as both:
        assert list(both.map(press, links)) == [200, 200]
    assert EmailAddress.objects.filter(verified=True).count() == 1


@pytest.mark.django_db(transaction=True)
def test_an_address_that_is_changed_at_the_same_time_stays_changed() -> None:
    user = person("ida")
    link = link_for(user)

    def press() -> str:
        try:
            return Client().post(link).content.decode()
        finally:
            connection.close()

    with ThreadPoolExecutor(1) as other, transaction.atomic():
        user.email = "new@example.org"
        save_user(user=user, actor=a_user(Role.ADMINISTRATOR))
        pressed = other.submit(press)
        wait([pressed], timeout=0.5)
        assert not pressed.done()
    assert "does not work any more" in pressed.result()
    user.refresh_from_db()
    assert user.email == "new@example.org"
