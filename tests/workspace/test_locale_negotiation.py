"""Who has chosen no language is spoken to in the browser's, by websocket as by HTTP."""

from typing import Any

import pytest
from django.test import RequestFactory

from workspace.locale_negotiation import language_of_request, language_of_socket
from workspace.models import User

GERMAN: dict[str, Any] = {"headers": [(b"host", b"here"), (b"accept-language", b"de-AT,de;q=0.9,en;q=0.5")], "cookies": {}}


@pytest.mark.parametrize(("own", "scope", "language"), [("", GERMAN, "de"), ("en", GERMAN, "en"), ("", {}, "en"), ("it", GERMAN, "de")])
def test_a_websocket_is_spoken_to_in_ones_own_language_else_the_browsers(own: str, scope: dict[str, Any], language: str) -> None:
    assert language_of_socket(User(language=own), scope) == language


def test_a_language_that_the_program_does_not_speak_is_answered_in_the_usual_one() -> None:
    request = RequestFactory().get("/", headers={"Accept-Language": "tlh"})
    assert language_of_request(User(), request) == "en"
    assert language_of_request(User(), RequestFactory().get("/", headers={"Accept-Language": "de"})) == "de"
