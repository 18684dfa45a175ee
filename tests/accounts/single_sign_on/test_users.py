"""Users of single sign-on: how they are made and linked, and which role and organisation they have at each sign-in."""

from dataclasses import replace
from typing import Any

import pytest
from allauth.account.models import EmailAddress
from allauth.socialaccount.models import SocialAccount
from django.test import Client

from accounts.identity_claims import IdentityProvider, free_user_name, merged, organisations_of, role_of, wanted_user_name
from accounts.pages.password import LostPasswordForm
from tests.accounts.authenticator_app import is_in
from tests.accounts.single_sign_on.openid_provider import OpenIdProvider, comes_back, heading, signs_in, user_of
from tests.accounts.users import a_user
from workspace.models import DEFAULT_ORGANISATION_ID, AuditEntry, Organisation, Role, SignInEntry, SignInOutcome, User

pytestmark = pytest.mark.django_db
ADDRESS = "anna@grid.example"


def refused(provider: OpenIdProvider, **claims: Any) -> str:
    """What the page says to somebody who is not let in."""
    provider.claims = {"sub": "anna", "groups": ["pilots"]} | claims
    client = Client()
    answer = comes_back(client, provider)
    assert (answer.status_code, heading(answer)) == (403, "You have no access to Spanwise")
    assert not is_in(client)
    return str(answer.content.decode())


def history(user: User) -> list[tuple[Any, ...]]:
    rows = AuditEntry.objects.filter(subject_type="user", subject_id=str(user.pk)).order_by("pk")
    return [(row.action, row.actor_id, row.organisation_id) for row in rows]


# Claims


PROVIDER = IdentityProvider(
    issuer="https://id.example", client_id="spanwise", client_secret="any", name="Grid ID", role_claim="realm_access.roles",
    roles={"a": "administrator", "o": "operator", "c": "curator"}, organisation_claim="tenant", organisations={"n": "North", "s": "South"},
)  # fmt: skip


@pytest.mark.parametrize(
    ("claims", "role"),
    [
        ({"realm_access": {"roles": ["o"]}}, "operator"),
        ({"realm_access": {"roles": ["o", "a", "unknown"]}}, "administrator"),
        ({"realm_access": {"roles": ["o", "c"]}}, "curator"),
        ({"realm_access": {"roles": "o"}}, "operator"),
        ({"realm_access.roles": ["o"]}, "operator"),
        ({"realm_access": {"roles": ["A", "operator", None, 1, {}]}}, ""),
        ({"realm_access": "roles"}, ""),
        ({"realm_access": {"roles": {"o": 1}}}, ""),
        ({}, ""),
    ],
)
def test_the_role_is_the_highest_of_the_claim(claims: dict[str, Any], role: str) -> None:
    assert role_of(claims, PROVIDER) == role
    assert role_of(claims, replace(PROVIDER, default_role="viewer")) == (role or "viewer")


def test_organisations_are_those_of_the_claim() -> None:
    assert organisations_of({"tenant": "n"}, PROVIDER) == {"North"}
    assert organisations_of({"tenant": ["n", "s"]}, PROVIDER) == {"North", "South"}
    assert organisations_of({"tenant": "North"}, PROVIDER) == set()


@pytest.mark.parametrize(
    ("claims", "name"),
    [
        ({"preferred_username": "anna"}, "anna"),
        ({"preferred_username": "anna.keller@grid.example"}, "anna.keller"),
        ({"email": "Anna+UAV@grid.example"}, "Anna+UAV"),
        ({"preferred_username": "GRID\\anna keller"}, "GRID-anna-keller"),
        ({"preferred_username": "service:grid:sync"}, "service-grid-sync"),
        ({"preferred_username": "@", "email": "anna@grid.example"}, "anna"),
        ({"preferred_username": "Jürgen"}, "Jürgen"),
        ({"preferred_username": "a" * 300}, "a" * 150),
        ({"preferred_username": 7, "email": None}, "user"),
        ({}, "user"),
    ],
)
def test_user_names_are_valid_and_no_addresses(claims: dict[str, Any], name: str) -> None:
    assert wanted_user_name(claims) == name
    User(username=name).clean_fields(exclude=["password"])


def test_a_taken_name_gets_a_number() -> None:
    assert free_user_name("Anna", {"anna", "anna-2"}) == "Anna-3"
    assert len(free_user_name("a" * 150, {"a" * 150})) <= 150


@pytest.mark.parametrize(
    ("id_token", "userinfo", "is_verified"),
    [
        ({"email": "a@x", "email_verified": True}, {}, True),
        ({"email": "a@x", "email_verified": "true"}, {}, True),
        ({"email": "a@x"}, {"email": "a@x", "email_verified": True}, True),
        ({"email": "a@x"}, {"email": "b@x", "email_verified": True}, False),
        ({"email": "a@x"}, {"email_verified": True}, False),
        ({"email": "a@x", "email_verified": "false"}, {}, False),
        ({"email": "a@x", "email_verified": 1}, {}, False),
        ({"email_verified": True}, {}, False),
        ({"email": ["a@x"], "email_verified": False}, {}, False),
    ],
)
def test_an_address_is_verified_by_the_source_that_names_it(id_token: dict[str, Any], userinfo: dict[str, Any], is_verified: bool) -> None:
    assert merged(id_token, userinfo)["email_verified"] is is_verified


# New users


def test_the_first_sign_in_makes_the_account(provider: OpenIdProvider) -> None:
    provider.userinfo = {"given_name": "Anna", "family_name": "Keller"}
    user = user_of(signs_in(provider, preferred_username="anna@grid.example", email=ADDRESS, email_verified=True))
    assert (user.username, user.first_name, user.last_name, user.email, user.role) == ("anna", "Anna", "Keller", ADDRESS, "operator")
    assert not (user.has_usable_password() or user.is_installation_operator or user.is_service)
    assert history(user) == [("created", None, DEFAULT_ORGANISATION_ID), ("single sign-on linked", None, DEFAULT_ORGANISATION_ID)]
    assert list(SocialAccount.objects.values_list("provider", "uid", "user", "extra_data")) == [(provider.issuer, "anna", user.pk, {})]
    assert EmailAddress.objects.filter(user=user, email=ADDRESS, verified=True).exists()


@pytest.mark.parametrize(
    ("claims", "names"),
    [
        ({"name": "Anna Maria Keller"}, ("Anna Maria", "Keller")),
        ({"name": "Anna"}, ("", "Anna")),
        ({"given_name": "Anna", "family_name": "Keller", "name": "A. K."}, ("Anna", "Keller")),
        ({"given_name": 7, "family_name": "x" * 400}, ("", "x" * 150)),
        ({}, ("", "")),
    ],
)
def test_names_are_taken_from_what_there_is(provider: OpenIdProvider, claims: dict[str, Any], names: tuple[str, str]) -> None:
    user = user_of(signs_in(provider, **claims))
    assert (user.first_name, user.last_name) == names


def test_the_second_sign_in_finds_it_by_the_subject_alone(provider: OpenIdProvider) -> None:
    user = user_of(signs_in(provider, preferred_username="anna", email=ADDRESS))
    again = user_of(signs_in(provider, preferred_username="renamed", email="other@grid.example"))
    other = user_of(signs_in(provider, sub="berta", preferred_username="anna", email=ADDRESS))
    assert again == user
    assert other != user
    assert (user.username, other.username) == ("anna", "anna-2")


def test_the_subject_counts_with_its_issuer(provider: OpenIdProvider) -> None:
    SocialAccount.objects.create(provider="https://other.example", uid="anna", user=a_user(Role.ADMINISTRATOR))
    assert user_of(signs_in(provider)).role == Role.OPERATOR


@pytest.mark.parametrize("email", ["no address", "x" * 300 + "@grid.example", 7, None])
def test_a_wrong_address_is_left_out(provider: OpenIdProvider, email: Any) -> None:
    assert user_of(signs_in(provider, email=email, email_verified=True)).email == ""


def test_no_mail_gives_a_password_to_a_user_of_the_provider(provider: OpenIdProvider) -> None:
    signs_in(provider, email=ADDRESS, email_verified=True)
    assert list(LostPasswordForm().get_users(ADDRESS)) == []


# Roles and organisations


def test_role_and_organisation_follow_the_claims_at_each_sign_in(provider: OpenIdProvider, settings: Any) -> None:
    a_user(Role.ADMINISTRATOR)
    north = Organisation.objects.create(name="North")
    user = user_of(signs_in(provider))
    settings.IDENTITY_PROVIDER = replace(settings.IDENTITY_PROVIDER, organisation_claim="tenant", organisations={"n": "North"})
    changed = user_of(signs_in(provider, groups=["curators"], tenant="n"))
    assert (changed, changed.role, changed.organisation) == (user, Role.CURATOR, north)
    assert history(user)[2:] == [("changed", None, DEFAULT_ORGANISATION_ID), ("changed", None, north.pk)]
    assert len(history(user_of(signs_in(provider, groups=["curators"], tenant="n")))) == 4


def test_the_last_administrator_keeps_the_role(provider: OpenIdProvider) -> None:
    user = user_of(signs_in(provider, groups=["admins"]))
    assert user_of(signs_in(provider, groups=["pilots"])).role == Role.ADMINISTRATOR
    a_user(Role.ADMINISTRATOR)
    assert user_of(signs_in(provider, groups=["pilots"])) == user
    user.refresh_from_db()
    assert user.role == Role.OPERATOR


def test_without_a_role_one_is_refused(provider: OpenIdProvider, settings: Any) -> None:
    page = refused(provider, groups=["visitors"])
    assert "no role" in page
    assert not User.objects.exists()
    user = user_of(signs_in(provider))
    refused(provider, groups=[])
    assert list(SignInEntry.objects.order_by("pk").values_list("outcome", "user")) == [
        (SignInOutcome.REFUSED, None), (SignInOutcome.SIGNED_IN, user.pk), (SignInOutcome.REFUSED, user.pk),
    ]  # fmt: skip
    settings.IDENTITY_PROVIDER = replace(settings.IDENTITY_PROVIDER, default_role="viewer")
    assert user_of(signs_in(provider, sub="berta", groups=[])).role == Role.VIEWER


@pytest.mark.parametrize("tenant", ["foreign", None, ["n", "s"], "missing", {"n": 1}])
def test_a_foreign_organisation_is_refused(provider: OpenIdProvider, settings: Any, tenant: Any) -> None:
    """Also an ambiguous one, and one that the settings name but nobody has made."""
    Organisation.objects.create(name="North")
    Organisation.objects.create(name="South")
    organisations = {"n": "North", "s": "South", "missing": "Nowhere"}
    settings.IDENTITY_PROVIDER = replace(settings.IDENTITY_PROVIDER, organisation_claim="tenant", organisations=organisations)
    assert "no organisation" in refused(provider, tenant=tenant)
    assert not User.objects.exists()


def test_an_inactive_user_is_refused(provider: OpenIdProvider) -> None:
    user = user_of(signs_in(provider))
    User.objects.filter(pk=user.pk).update(is_active=False)
    assert "disabled" in refused(provider)


# Linking


def a_local_user(**changes: Any) -> User:
    user = a_user()
    user.email = ADDRESS
    user.set_password("inspect-the-lines")
    for name, value in changes.items():
        setattr(user, name, value)
    user.save()
    return user


@pytest.mark.parametrize("is_verified_there", [True, False, None])
@pytest.mark.parametrize("is_verified_here", [True, False])
@pytest.mark.parametrize("same_organisation", [True, False])
def test_an_existing_user_is_linked_if_both_sides_have_verified_the_address(
    provider: OpenIdProvider, is_verified_there: bool | None, is_verified_here: bool, same_organisation: bool
) -> None:
    organisation = Organisation.objects.get(pk=1) if same_organisation else Organisation.objects.create(name="North")
    local = a_local_user(organisation=organisation, role=Role.VIEWER)
    EmailAddress.objects.create(user=local, email=ADDRESS, verified=is_verified_here, primary=True)
    found = user_of(signs_in(provider, email=ADDRESS.capitalize(), email_verified=is_verified_there))
    is_linked = is_verified_there is True and is_verified_here and same_organisation
    assert (found == local) == is_linked
    local.refresh_from_db()
    assert local.role == (Role.OPERATOR if is_linked else Role.VIEWER)
    assert local.has_usable_password()


@pytest.mark.parametrize(
    "changes", [{"is_installation_operator": True, "role": Role.ADMINISTRATOR}, {"is_active": False}, {"email": "new@x.example"}]
)
def test_these_users_are_never_linked(provider: OpenIdProvider, changes: dict[str, Any]) -> None:
    """Power over the installation is given on the machine alone; an address that is no longer the user's counts for nothing."""
    a_user(Role.ADMINISTRATOR)
    local = a_local_user(**changes)
    EmailAddress.objects.create(user=local, email=ADDRESS, verified=True, primary=True)
    found = user_of(signs_in(provider, email=ADDRESS, email_verified=True))
    assert found != local
    assert not found.is_installation_operator


def test_an_address_that_the_provider_gives_to_somebody_else_links_nothing(provider: OpenIdProvider) -> None:
    first = user_of(signs_in(provider, email=ADDRESS, email_verified=True))
    assert user_of(signs_in(provider, sub="berta", email=ADDRESS, email_verified=True)) != first


def test_a_linked_user_may_still_use_the_password(provider: OpenIdProvider) -> None:
    local = a_local_user()
    EmailAddress.objects.create(user=local, email=ADDRESS, verified=True, primary=True)
    signs_in(provider, email=ADDRESS, email_verified=True)
    client = Client()
    client.post("/sign-in", {"login": local.username, "password": "inspect-the-lines"})
    assert is_in(client)
