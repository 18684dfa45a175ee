"""A link makes one account with the role that an administrator has chosen, once, in its time."""

from datetime import timedelta
from typing import Any

import pytest
from django.core import mail
from django.core.cache import cache
from django.http import HttpResponse
from django.test import Client
from django.utils import timezone

from tests.accounts.users import a_user, client_of
from workspace.models import AuditEntry, Invitation, Organisation, Role, SignInEntry, User

pytestmark = pytest.mark.django_db
ON_THE_CONSOLE = "django.core.mail.backends.console.EmailBackend"
PASSWORD = "walk-the-corridor"
FORM = {
    "username": "newcomer",
    "first_name": "Nora",
    "last_name": "Lund",
    "email": "nora@example.org",
    "password1": PASSWORD,
    "password2": PASSWORD,
}


@pytest.fixture(autouse=True)
def _no_tries_yet(settings: Any) -> None:
    cache.clear()
    settings.PASSWORD_HASHERS = ["django.contrib.auth.hashers.MD5PasswordHasher"]  # nothing here is about how slow a hash is


@pytest.fixture
def administrator() -> User:
    return a_user(Role.ADMINISTRATOR)


@pytest.fixture
def client(administrator: User) -> Client:
    return client_of(administrator)


def invite(client: Client, **body: Any) -> HttpResponse:
    return client.post("/api/v1/invitations", {"role": "operator", **body}, content_type="application/json")


def link_of(answer: HttpResponse) -> str:
    return str(answer.json()["link"]).removeprefix("http://testserver")


def accept(link: str, **changes: str) -> HttpResponse:
    return Client().post(link, {**FORM, **changes})


def states(client: Client, query: str = "") -> list[str]:
    return [row["state"] for row in client.get(f"/api/v1/invitations?{query}").json()["results"]]


def test_the_link_makes_an_account_with_the_role_and_signs_in(client: Client, administrator: User) -> None:
    link = link_of(invite(client, role="curator"))
    newcomer = Client()
    assert "invites you as Curator" in newcomer.get(link).content.decode()
    answer = newcomer.post(link, FORM)
    assert (answer.status_code, answer["Location"]) == (302, "/")
    user = User.objects.get(username="newcomer")
    assert (user.role, user.organisation, user.get_full_name()) == (Role.CURATOR, administrator.organisation, "Nora Lund")
    assert user.check_password(PASSWORD)
    assert newcomer.get("/api/v1/account").json()["username"] == "newcomer"
    assert SignInEntry.objects.get().user == user
    assert states(client) == ["accepted"]
    assert client.get("/api/v1/invitations").json()["results"][0]["accepted_by"] == "newcomer"


def test_a_link_works_once(client: Client) -> None:
    link = link_of(invite(client))
    assert accept(link).status_code == 302
    again = accept(link, username="second")
    assert again.status_code == 410
    assert "does not work any more" in again.content.decode()
    assert not User.objects.filter(username="second").exists()


def test_a_link_that_was_taken_back_is_too_old_or_never_was_makes_nothing(client: Client) -> None:
    revoked, old = invite(client), invite(client)
    assert client.delete(f"/api/v1/invitations/{revoked.json()['id']}").json()["state"] == "revoked"
    Invitation.objects.filter(pk=old.json()["id"]).update(expires_at=timezone.now() - timedelta(seconds=1))
    for link in (link_of(revoked), link_of(old), "/invitation/unknown", "/invitation/%C3%A4", "/invitation/" + "x" * 500):
        assert Client().get(link).status_code == 410
        assert accept(link).status_code == 410
    assert not User.objects.filter(username="newcomer").exists()
    assert set(states(client)) == {"revoked", "expired"}
    assert states(client, "state=expired") == ["expired"]
    assert states(client, "state=open") == []


def test_a_used_invitation_cannot_be_taken_back(client: Client) -> None:
    answer = invite(client)
    accept(link_of(answer))
    assert client.delete(f"/api/v1/invitations/{answer.json()['id']}").json()["state"] == "accepted"


def test_the_link_is_shown_once_and_only_its_hash_is_kept(client: Client) -> None:
    token = link_of(invite(client)).removeprefix("/invitation/")
    assert token not in client.get("/api/v1/invitations").content.decode()
    assert token not in str(list(Invitation.objects.values())) + str(list(AuditEntry.objects.values()))


@pytest.mark.parametrize(
    ("changes", "fault"),
    [
        ({"password2": "another"}, "two password fields"),
        ({"password1": "12345678", "password2": "12345678"}, "too common"),
        ({"username": ""}, "required"),
        ({"username": "a b"}, "valid username"),
        ({"email": "no address"}, "valid email"),
    ],
)
def test_a_faulty_form_says_why_and_the_link_goes_on_working(client: Client, changes: dict[str, str], fault: str) -> None:
    link = link_of(invite(client))
    assert fault in accept(link, **changes).content.decode()
    assert accept(link).status_code == 302


def test_a_name_that_somebody_has_is_refused_whatever_its_case(client: Client, administrator: User) -> None:
    link = link_of(invite(client))
    assert "already exists" in accept(link, username=administrator.username.upper()).content.decode()


def test_a_newcomer_cannot_choose_role_or_organisation(client: Client) -> None:
    Organisation.objects.create(pk=99, name="Others")
    accept(link_of(invite(client, role="viewer")), role="administrator", organisation="99", is_active="")
    user = User.objects.get(username="newcomer")
    assert (user.role, user.organisation_id, user.is_active) == (Role.VIEWER, 1, True)


def test_whoever_is_signed_in_does_not_use_up_the_link(client: Client) -> None:
    link = link_of(invite(client))
    assert "You have an account" in client.get(link).content.decode()
    assert "You have an account" in client.post(link, FORM).content.decode()
    assert accept(link).status_code == 302


def test_the_link_is_mailed_where_mail_leaves(client: Client) -> None:
    answer = invite(client, email="nora@example.org")
    assert answer.json()["was_mailed"] is True
    assert mail.outbox[0].to == ["nora@example.org"]
    assert answer.json()["link"] in mail.outbox[0].body


def test_a_link_is_never_written_to_the_console(client: Client, settings: Any, capsys: pytest.CaptureFixture[str]) -> None:
    settings.EMAIL_BACKEND = ON_THE_CONSOLE
    answer = invite(client, email="nora@example.org")
    assert answer.json()["was_mailed"] is False
    assert answer.json()["link"] not in "".join(capsys.readouterr())


def test_a_mail_server_that_is_away_leaves_the_link_to_be_handed_over(client: Client, monkeypatch: pytest.MonkeyPatch) -> None:
    def away(*_: Any, **__: Any) -> int:
        raise ConnectionRefusedError

    monkeypatch.setattr("accounts.invitations.send_mail", away)
    answer = invite(client, email="nora@example.org")
    assert (answer.status_code, answer.json()["was_mailed"]) == (201, False)
    assert accept(link_of(answer)).status_code == 302


def test_invitations_of_another_organisation_are_not_there(client: Client) -> None:
    other = a_user(Role.ADMINISTRATOR, Organisation.objects.create(name="Others"))
    theirs = invite(client_of(other)).json()["id"]
    assert states(client) == []
    assert client.delete(f"/api/v1/invitations/{theirs}").status_code == 404


@pytest.mark.parametrize("body", [{"role": "king"}, {"role": None}, {"days": 0}, {"days": 31}, {"email": "nobody"}])
def test_an_invitation_that_is_none_is_refused(client: Client, body: dict[str, Any]) -> None:
    assert invite(client, **body).status_code == 400


def test_the_admin_has_the_rows_and_takes_invitations_back(client: Client) -> None:
    link, used = link_of(invite(client, email="nora@example.org")), link_of(invite(client))
    accept(used)
    page = client.get("/admin/workspace/invitation/").content.decode()
    assert "nora@example.org" in page
    assert link.removeprefix("/invitation/") not in page
    chosen = list(Invitation.objects.values_list("pk", flat=True))
    answer = client.post("/admin/workspace/invitation/", {"action": "take_back", "_selected_action": chosen}, follow=True)
    assert "1 taken back." in answer.content.decode()
    assert Client().get(link).status_code == 410
    assert "newcomer" in client.get("/admin/workspace/signinentry/").content.decode()
    assert client.get("/admin/workspace/signinentry/add/").status_code == 403
