"""Who may do what, for every operation that the OpenAPI document has."""

import re
from typing import Any

import pytest
from django.contrib.auth import get_user_model
from django.test import Client
from drf_spectacular.generators import SchemaGenerator

from tests.accounts.users import a_user, client_of
from workspace.models import Role

pytestmark = pytest.mark.django_db

SAFE = {"get", "head", "options"}
ALSO_CURATORS = {"cancel_job"}
CURATED = re.compile(
    r"/api/v1/(assets|zones|zone-sets|zone-subscriptions|history|data-issues|geometry-checks|uploads|imports|terrain|regions)(/|$)"
)
# a POST because the question is long; nothing is stored
ASKED_BY_ALL = {
    "terrain_profile", "convert_heights", "lookup_assets", "list_assets_within", "list_parts_of_lines", "report_presence",
    "explain_unreached_target", "explain_route", "plan_legal_windows", "find_later_departure", "reachable_assets", "check_legs",
    "plan_views", "lookup_media", "start_asset_export", "start_zone_export", "delete_export",
}  # fmt: skip
SEEN_BY_CURATORS_ALONE = re.compile(r"/api/v1/(uploads|imports)(/|$)")
SEEN_BY_ADMINISTRATORS_ALONE = re.compile(r"/api/v1/(users|invitations|service-accounts|sign-ins|unknown-vehicles)(/|$)")
SET_BY_ADMINISTRATORS_ALONE = re.compile(r"/api/v1/(demo-data|organisation|rehearsal-rule|second-factor-rule)$")  # read by everybody
FOR_UAVS_ALONE = re.compile(r"/api/v1/uav-link(/|$)")
ONES_OWN = re.compile(r"/api/v1/account(/|$)")


def operations() -> list[tuple[str, str, str]]:
    """(method, address with stand-ins for its parameters, name) of everything under /api/v1/."""
    found = []
    for path, methods in SchemaGenerator().get_schema(public=True)["paths"].items():
        if path.startswith("/api/v1/"):
            for method, operation in methods.items():
                kinds = {parameter["name"]: parameter["schema"] for parameter in operation.get("parameters", [])}
                address = re.sub(r"\{(\w+)\}", lambda match: stand_in(kinds[match[1]]), path)  # noqa: B023 - used at once
                found.append((method, address, operation["operationId"]))
    return found


def operations_of_users() -> list[tuple[str, str, str]]:
    return [(method, address, name) for method, address, name in operations() if not FOR_UAVS_ALONE.match(address)]


def stand_in(schema: dict[str, Any]) -> str:
    if "enum" in schema:
        return str(schema["enum"][0])
    return "0" if schema["type"] == "integer" else "00000000-0000-4000-8000-000000000000"


def status(client: Client, method: str, address: str) -> int:
    return getattr(client, method)(address, **({} if method in SAFE else {"data": "{}", "content_type": "application/json"})).status_code


def test_strangers_are_refused_everywhere() -> None:
    assert {status(Client(), method, address) for method, address, _ in operations()} == {401}


def test_what_is_for_uavs_is_for_no_user() -> None:
    asked = [(method, address) for method, address, _ in operations() if FOR_UAVS_ALONE.match(address)]
    assert len(asked) == 5
    for role in Role:
        assert {status(client_of(a_user(role)), method, address) for method, address in asked} == {401}


def test_whoever_is_signed_in_may_read_everything_but_what_has_not_been_decided() -> None:
    for role in Role:
        client = client_of(a_user(role))
        read = [(method, address) for method, address, _ in operations_of_users() if method in SAFE]
        refused = {address for method, address in read if status(client, method, address) in {401, 403}}
        hidden_from = [(SEEN_BY_CURATORS_ALONE, {Role.CURATOR, Role.ADMINISTRATOR}), (SEEN_BY_ADMINISTRATORS_ALONE, {Role.ADMINISTRATOR})]
        hidden = {
            address
            for method, address, _ in operations_of_users()
            for what, roles in hidden_from
            if method in SAFE and what.match(address) and role not in roles
        }
        assert refused == hidden, role


@pytest.mark.parametrize("role", Role)
def test_operators_change_what_is_flown_curators_the_ground_administrators_people_and_everybody_their_own(role: Role) -> None:
    client = client_of(a_user(role))
    for method, address, name in operations_of_users():
        if method in SAFE or name in ASKED_BY_ALL:
            continue
        allowed = {Role.ADMINISTRATOR, Role.CURATOR if CURATED.match(address) else Role.OPERATOR}
        allowed |= {Role.CURATOR} if name in ALSO_CURATORS else set()
        if SEEN_BY_ADMINISTRATORS_ALONE.match(address) or SET_BY_ADMINISTRATORS_ALONE.match(address):
            allowed = {Role.ADMINISTRATOR}
        if ONES_OWN.match(address):
            allowed = set(Role)
        answered = status(client, method, address)
        if role in allowed:
            assert answered not in {401, 403, 500}, (method, address)
        else:
            assert answered == 403, (method, address)


def test_a_refusal_names_the_role_that_is_needed() -> None:
    answer = client_of(a_user(Role.VIEWER)).post("/api/v1/jobs/00000000-0000-4000-8000-000000000000/cancel")
    assert answer.json()["error"] == {
        "code": "permission_denied",
        "message": "Viewers cannot do this. Ask an administrator for the operator or curator role.",
        "details": None,
    }


@pytest.mark.parametrize(
    ("role", "is_staff", "is_superuser"),
    [(Role.VIEWER, False, False), (Role.OPERATOR, False, False), (Role.CURATOR, True, False), (Role.ADMINISTRATOR, True, True)],
)
def test_what_django_calls_staff_follows_the_role(role: Role, is_staff: bool, is_superuser: bool) -> None:
    user = a_user(role)
    assert (user.is_staff, user.is_superuser) == (is_staff, is_superuser)


def test_a_superuser_is_an_administrator() -> None:
    assert get_user_model().objects.create_superuser("root", password="x").role == Role.ADMINISTRATOR


@pytest.mark.parametrize(
    ("role", "ground", "people"),
    [(Role.VIEWER, False, False), (Role.OPERATOR, False, False), (Role.CURATOR, True, False), (Role.ADMINISTRATOR, True, True)],
)
def test_permissions_in_the_admin_follow_the_role(role: Role, ground: bool, people: bool) -> None:
    user = a_user(role)
    assert user.has_perm("inspection.change_asset") == user.has_module_perms("inspection") == ground
    assert user.has_perm("workspace.change_user") == user.has_perm("missions.view_mission") == people


def test_somebody_who_was_locked_out_has_no_permission() -> None:
    user = a_user(Role.ADMINISTRATOR)
    user.is_active = False
    assert not user.has_perm("inspection.change_asset")
