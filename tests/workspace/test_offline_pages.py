"""The service worker and the page without a connection: for everybody, and with nothing of anybody."""

import re

import pytest
from django.test import Client

from tests.accounts.users import a_user, client_of
from workspace.models import Role

pytestmark = pytest.mark.django_db


def test_the_service_worker_is_a_script_at_the_root_that_browsers_ask_for_each_time() -> None:
    answer = Client().get("/service-worker.js")
    assert answer.status_code == 200
    assert answer["Content-Type"].startswith("text/javascript")
    assert answer["Cache-Control"] == "no-cache"
    assert re.match(r'globalThis\.VERSION = "[0-9a-f]*";\n', answer.content.decode())


def test_the_page_without_a_connection_is_the_same_for_a_stranger_and_a_user() -> None:
    pages = [client.get("/offline").content.decode() for client in (Client(), client_of(a_user(Role.VIEWER)))]
    assert pages[0] == pages[1]
    assert 'id="page"' not in pages[0]


def test_a_page_says_whose_it_is() -> None:
    user = a_user(Role.VIEWER)
    page = client_of(user).get("/live").content.decode()
    assert f'"userId": {user.pk}, "organisationId": {user.organisation_id}' in page
