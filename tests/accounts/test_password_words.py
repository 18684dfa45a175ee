"""Words of the context are no passwords."""

from typing import Any

import pytest
from django.contrib.auth.password_validation import validate_password
from django.core.exceptions import ValidationError

from accounts.invitations import invite
from tests.accounts.users import a_user
from workspace.models import Organisation, Role, User

pytestmark = pytest.mark.django_db
REFUSED = [
    "Spanwise2026!",
    "5p4nw153-99",
    "spanwise-inspection-uav",
    "Havel-Netz-2026",
    "h4velnetz!!x",
    "BridgeTower#1",
    "operator operator 12",
    "Stromleitung2026!",
    "Freileitung-123",
    "Drohne2026",
    "Geheim-1234",
    "Willkommen1",
    "Br\u00fccke-2026",
]


def is_taken(password: str, organisation: str = "Havel Netz") -> bool:
    user = a_user(organisation=Organisation.objects.get_or_create(name=organisation)[0])
    try:
        validate_password(password, user)
    except ValidationError as error:
        assert [fault.code for fault in error.error_list] == ["password_of_context_words"], password
        return False
    return True


@pytest.mark.parametrize("password", REFUSED)
def test_what_is_such_a_word_with_little_beside_it_is_refused(password: str) -> None:
    assert not is_taken(password)


@pytest.mark.parametrize("password", ["plum-cake-on-thursdays", "spanwise and 3 lazy otters", "grey owl over Havel at 5"])
def test_a_sentence_may_have_such_a_word_in_it(password: str) -> None:
    assert is_taken(password)


def test_another_organisations_name_is_no_word_of_ones_own() -> None:
    assert is_taken("havel-netz-77", organisation="Rhein Strom")


def test_a_site_names_words_of_its_own(settings: Any) -> None:
    settings.PASSWORD_WORDS = ["kranich"]
    settings.ALLOWED_HOSTS = ["fliegen.example.org", "127.0.0.1"]
    assert not is_taken("Kranich-2026")
    assert not is_taken("fliegen-2026")


def test_an_invitation_counts_the_words_of_the_organisation_that_invites(client: Any) -> None:
    boss = a_user(Role.ADMINISTRATOR, Organisation.objects.create(name="Havel Netz"))
    _, token = invite(organisation=boss.organisation, actor=boss, role=Role.VIEWER, email="", days=1)
    answers = {"username": "newcomer", "password1": "Havel-Netz-2026", "password2": "Havel-Netz-2026"}
    assert client.post(f"/invitation/{token}", answers).status_code == 200
    assert not User.objects.filter(username="newcomer").exists()
