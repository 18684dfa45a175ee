"""Who is no administrator any more: their links die with the role, and no organisation is left without one."""

import pytest
from django.test import Client

from accounts.users import NoAdministratorLeft, change_users, delete_user
from tests.accounts.users import a_user, client_of
from workspace.models import AuditEntry, Invitation, Organisation, Role, User

pytestmark = pytest.mark.django_db


@pytest.fixture
def keeper() -> User:
    return a_user(Role.ADMINISTRATOR)


@pytest.fixture
def leaver() -> User:
    return a_user(Role.ADMINISTRATOR)


def link_of(user: User) -> str:
    answer = client_of(user).post("/api/v1/invitations", {"role": "administrator"}, content_type="application/json")
    return str(answer.json()["link"]).removeprefix("http://testserver")


@pytest.mark.parametrize("change", [{"role": Role.OPERATOR}, {"is_active": False}])
def test_a_link_dies_with_its_makers_role_or_access(keeper: User, leaver: User, change: dict[str, Role | bool]) -> None:
    link, other = link_of(leaver), link_of(keeper)
    change_users(users=[leaver], actor=keeper, **change)
    assert [Client().get(address).status_code for address in (link, other)] == [410, 200]
    assert AuditEntry.objects.get(subject_type="invitation", action="revoked").actor == keeper


def test_a_link_dies_with_its_maker(keeper: User, leaver: User) -> None:
    link = link_of(leaver)
    delete_user(user=leaver, actor=keeper)
    assert Client().get(link).status_code == 410


def test_a_link_outlives_a_change_that_leaves_the_role(keeper: User, leaver: User) -> None:
    link = link_of(leaver)
    change_users(users=[leaver], actor=keeper, role=Role.ADMINISTRATOR, is_active=True)
    assert Client().get(link).status_code == 200
    assert Invitation.objects.get().revoked_at is None


def test_an_organisation_with_people_keeps_an_administrator_of_its_own(keeper: User) -> None:
    elsewhere = Organisation.objects.create(name="Elsewhere")
    only, colleague = a_user(Role.ADMINISTRATOR, elsewhere), a_user(Role.VIEWER, elsewhere)
    with pytest.raises(NoAdministratorLeft):
        change_users(users=[only], actor=only, role=Role.VIEWER)
    with pytest.raises(NoAdministratorLeft):
        delete_user(user=User.objects.get(pk=only.pk), actor=keeper)
    delete_user(user=colleague, actor=keeper)
    delete_user(user=User.objects.get(pk=only.pk), actor=keeper)
    assert not elsewhere.users.exists()
