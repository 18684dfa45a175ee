"""Accounts in the admin: found, changed one by one and many at once, and never without an administrator."""

from typing import Any

import pytest
from django.db import connection, transaction
from django.test import Client
from django.urls import reverse

from accounts.users import NoAdministratorLeft, change_users, delete_user
from tests.accounts.users import a_user, client_of
from workspace.models import AuditEntry, Organisation, Role, User

pytestmark = pytest.mark.django_db

LIST = "admin:workspace_user_changelist"


@pytest.fixture
def administrator() -> User:
    User.objects.filter(role=Role.ADMINISTRATOR).delete()
    return a_user(Role.ADMINISTRATOR)


@pytest.fixture
def client(administrator: User) -> Client:
    return client_of(administrator)


def act(client: Client, action: str, *people: User, **more: Any) -> str:
    form = {"action": action, "_selected_action": [person.pk for person in people], **more}
    return client.post(reverse(LIST), form, follow=True).content.decode()


def form_of(client: Client, person: User) -> dict[str, Any]:
    form = client.get(reverse("admin:workspace_user_change", args=[person.pk])).context["adminform"].form
    values = {name: form[name].value() for name in form.fields if name != "password"}
    return {name: "" if value in (None, False) else value for name, value in values.items()}


@pytest.mark.parametrize(
    ("action", "before", "after"),
    [
        ("make_curators", (Role.VIEWER, True), (Role.CURATOR, True)),
        ("make_viewers", (Role.CURATOR, True), (Role.VIEWER, True)),
        ("make_operators", (Role.VIEWER, True), (Role.OPERATOR, True)),
        ("make_administrators", (Role.VIEWER, True), (Role.ADMINISTRATOR, True)),
        ("keep_out", (Role.VIEWER, True), (Role.VIEWER, False)),
        ("let_in", (Role.VIEWER, False), (Role.VIEWER, True)),
    ],
)
def test_several_accounts_are_changed_at_once_and_each_is_in_the_history(
    client: Client, administrator: User, action: str, before: tuple[Role, bool], after: tuple[Role, bool]
) -> None:
    people = [a_user(before[0]) for _ in range(2)]
    User.objects.filter(pk__in=[person.pk for person in people]).update(is_active=before[1])
    assert "2 " in act(client, action, *people)
    assert set(User.objects.filter(pk__in=[person.pk for person in people]).values_list("role", "is_active")) == {after}
    entries = AuditEntry.objects.filter(subject_type="user")
    assert {entry.subject_id for entry in entries} == {str(person.pk) for person in people}
    assert all(entry.actor == administrator and (entry.after["role"], entry.after["is_active"]) == after for entry in entries)
    assert not any("password" in entry.after for entry in entries)


@pytest.mark.parametrize("action", ["make_viewers", "make_curators", "keep_out"])
def test_the_last_administrator_keeps_role_and_access(client: Client, administrator: User, action: str) -> None:
    other = a_user(Role.OPERATOR)
    assert "This would leave no administrator who can sign in" in act(client, action, other, administrator)
    administrator.refresh_from_db()
    other.refresh_from_db()
    assert (administrator.role, administrator.is_active, other.role, other.is_active) == (Role.ADMINISTRATOR, True, Role.OPERATOR, True)


@pytest.mark.parametrize("change", [{"role": "viewer"}, {"is_active": ""}])
def test_the_last_administrators_form_is_refused_too(client: Client, administrator: User, change: dict[str, str]) -> None:
    form = form_of(client, administrator) | change
    answer = client.post(reverse("admin:workspace_user_change", args=[administrator.pk]), form, follow=True)
    assert "This would leave no administrator who can sign in" in answer.content.decode()
    administrator.refresh_from_db()
    assert (administrator.role, administrator.is_active) == (Role.ADMINISTRATOR, True)


def test_the_last_administrator_cannot_be_deleted_alone_or_among_others(client: Client, administrator: User) -> None:
    a_user(Role.OPERATOR)
    assert "no administrator" in act(client, "delete_selected", *User.objects.all(), post="yes")
    answer = client.post(reverse("admin:workspace_user_delete", args=[administrator.pk]), {"post": "yes"}, follow=True)
    assert "no administrator" in answer.content.decode()
    assert User.objects.count() == 2


def test_an_administrator_who_is_kept_out_does_not_count(administrator: User) -> None:
    other = a_user(Role.ADMINISTRATOR)
    change_users(users=[other], actor=administrator, is_active=False)
    with pytest.raises(NoAdministratorLeft):
        delete_user(user=administrator, actor=other)


def test_with_another_administrator_the_role_can_be_given_up(client: Client, administrator: User) -> None:
    a_user(Role.ADMINISTRATOR)
    form = form_of(client, administrator) | {"role": "curator"}
    assert client.post(reverse("admin:workspace_user_change", args=[administrator.pk]), form).status_code == 302
    administrator.refresh_from_db()
    assert administrator.role == Role.CURATOR


@pytest.mark.django_db(transaction=True)
def test_who_takes_an_administrators_role_holds_others_up_until_it_is_done(administrator: User) -> None:
    """So that of two who demote each other the second sees what the first did."""
    other = a_user(Role.ADMINISTRATOR)
    with transaction.atomic():
        change_users(users=[other], actor=administrator, role=Role.VIEWER)
        with connection.cursor() as cursor:
            cursor.execute("SELECT count(*) FROM pg_locks WHERE locktype = 'advisory' AND pid = pg_backend_pid()")
            assert cursor.fetchone()[0] == 1
    with pytest.raises(NoAdministratorLeft):
        change_users(users=[administrator], actor=other, role=Role.VIEWER)


def test_people_are_found_by_mail_and_organisation() -> None:
    client = client_of(User.objects.create_superuser("root"))
    grid = Organisation.objects.create(name="Grid North")
    person = a_user(Role.OPERATOR, grid)
    User.objects.filter(pk=person.pk).update(email="ann@example.org")
    for question in ("?q=ann@example", "?q=Grid+North", f"?organisation__id__exact={grid.pk}", "?role__exact=operator"):
        assert person.username in client.get(reverse(LIST) + question).content.decode()


def test_an_organisation_that_has_anything_is_not_deleted() -> None:
    client = client_of(User.objects.create_superuser("root"))
    empty, full = Organisation.objects.create(name="Empty"), Organisation.objects.create(name="Full")
    a_user(Role.VIEWER, full)
    delete = "admin:workspace_organisation_delete"
    assert client.post(reverse(delete, args=[full.pk]), {"post": "yes"}).status_code == 403
    assert client.post(reverse(delete, args=[empty.pk]), {"post": "yes"}).status_code == 302
    assert client.post(reverse(delete, args=[1]), {"post": "yes"}).status_code == 403
    assert not Organisation.objects.filter(name="Empty").exists()


def test_the_whole_history_shows_what_changed(client: Client, administrator: User) -> None:
    person = a_user(Role.VIEWER)
    change_users(users=[person], actor=administrator, role=Role.CURATOR)
    entry = AuditEntry.objects.get()
    page = client.get(reverse("admin:workspace_auditentry_change", args=[entry.pk])).content.decode()
    assert "<th scope='row'>role</th><td>viewer</td><td>curator</td>" in page
