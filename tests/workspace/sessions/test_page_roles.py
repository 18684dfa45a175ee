"""Who may open which page, for every address that the program has."""

import re
from collections.abc import Iterator

import pytest
from django.test import Client
from django.urls import URLPattern, URLResolver, get_resolver

from tests.accounts.users import a_user, client_of
from workspace.models import Role

pytestmark = pytest.mark.django_db

STAND_INS = {
    "uuid": "00000000-0000-4000-8000-000000000000", "int": "0", "str": "x", "path": "x", "file_kind": "csv", "result_kind": "csv",
    "capture_kind": "csv", "finding_kind": "csv",
}  # fmt: skip
OPEN_TO_ALL = {
    "api/schema", "api/docs", "service-worker.js", "offline", "sign-in", "lost-password", "lost-password/sent", "new-password/x/x",
    "new-password/set", "invitation/x", "email-address/x", "sign-in/passkey", "single-sign-on",
    "single-sign-on/callback",
}  # fmt: skip
SHORT_NAMES = {"missions", "map"}  # of pages that have another address, to which they lead
SENDS_BACK_TO_THE_DOOR = {"sign-out", "sign-in/code"}  # the code is asked of whoever has just typed the password
FOR_ADMINISTRATORS = {"administration"}
OF_THE_API = "api/v1/"  # see test_roles.py
OF_THE_ADMIN = "admin/"  # Django's own; see test_user_admin.py


def addresses(patterns: list[URLPattern | URLResolver], before: str = "") -> Iterator[str]:
    for pattern in patterns:
        address = before + re.sub(r"<(?:(\w+):)?\w+>", lambda match: STAND_INS[match[1] or "str"], str(pattern.pattern))
        if isinstance(pattern, URLResolver):
            yield from addresses(pattern.url_patterns, address)
        else:
            yield address


PAGES = sorted(address for address in addresses(get_resolver().url_patterns) if not address.startswith((OF_THE_API, OF_THE_ADMIN)))


def status(client: Client, page: str) -> int:
    return client.get(f"/{page}").status_code


def test_every_kind_of_page_is_among_them() -> None:
    known = {"", "missions/new", "uavs", "assets", "assets/data-issues", "imports", "terrain", "zones", "account", "administration"}
    assert known | OPEN_TO_ALL - {"invitation/x"} <= set(PAGES)


@pytest.mark.parametrize("page", [page for page in PAGES if page not in OPEN_TO_ALL | SENDS_BACK_TO_THE_DOOR | SHORT_NAMES])
def test_strangers_are_led_to_the_door(page: str) -> None:
    answer = Client().get(f"/{page}")
    assert (answer.status_code, answer.headers.get("Location", "").partition("?")[0]) == (302, "/sign-in")


@pytest.mark.parametrize("page", sorted(OPEN_TO_ALL & set(PAGES)))
def test_what_is_open_to_all_is_open_to_strangers(page: str) -> None:
    assert status(Client(), page) in {200, 404, 410, 503}  # 404, 410: a link that is not valid says so; 503: no worker answers /readyz


@pytest.mark.parametrize("role", Role)
def test_a_role_opens_its_pages_and_no_others(role: Role) -> None:
    client = client_of(a_user(role))
    answered = {page: status(client, page) for page in PAGES if page not in OPEN_TO_ALL | SENDS_BACK_TO_THE_DOOR | SHORT_NAMES}
    refused = {page for page, code in answered.items() if code == 403}
    assert refused == (set() if role == Role.ADMINISTRATOR else FOR_ADMINISTRATORS)
    odd = {page: code for page, code in answered.items() if code not in {200, 403, 404}}
    assert odd == {}
