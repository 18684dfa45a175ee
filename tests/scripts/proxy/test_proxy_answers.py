"""A real nginx with the written configuration, in front of a small application: what arrives at the browser."""

import gzip
import json
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from scripts.places import WEB_PROGRAMS
from tests.scripts.proxy.served_site import ANSWER, application_at, fetch, served_site


@pytest.fixture(scope="module")
def site() -> Iterator[tuple[str, Path]]:
    """The proxy's address, and the folder where the application's socket belongs."""
    with served_site() as served:
        yield served


@pytest.fixture(params=WEB_PROGRAMS)
def application(site: tuple[str, Path], request: pytest.FixtureRequest) -> Iterator[None]:
    """One of the web programs; the others are away."""
    with application_at(site[1] / f"{request.param}.sock"):
        yield


def test_a_module_is_sent_as_javascript_with_the_policy(site: tuple[str, Path]) -> None:
    status, headers, body = fetch(f"{site[0]}/static/main.mjs")
    assert (status, headers["Content-Type"], body) == (200, "text/javascript; charset=utf-8", b"export const answer = 42;\n")
    assert "script-src 'self';" in headers["Content-Security-Policy"]


def test_no_static_path_leads_out_of_the_folder(site: tuple[str, Path]) -> None:
    for path in ("/static/../nginx.conf", "/static/%2e%2e/nginx.conf", "/static../nginx.conf"):
        assert fetch(f"{site[0]}{path}")[0] in {400, 404, 503}


def test_while_the_application_is_away_programs_get_the_common_error_and_when_to_try_again(site: tuple[str, Path]) -> None:
    status, headers, body = fetch(f"{site[0]}/api/v1/missions")
    assert (status, headers["Retry-After"]) == (503, "5")
    assert json.loads(body)["error"]["code"] == "unavailable"


def test_while_the_application_is_away_people_get_a_sentence(site: tuple[str, Path]) -> None:
    status, headers, body = fetch(f"{site[0]}/missions")
    assert (status, headers["Content-Type"]) == (503, "text/plain; charset=utf-8")
    assert body.startswith(b"Spanwise is starting")


@pytest.mark.usefixtures("application")
def test_a_body_that_is_too_large_is_refused_in_the_common_shape(site: tuple[str, Path]) -> None:
    status, _, body = fetch(f"{site[0]}/api/v1/plans", body=b"0" * (8 * 1024 * 1024 + 1))
    assert status == 413
    assert json.loads(body)["error"]["code"] == "too_large"


@pytest.mark.usefixtures("application")
def test_answers_are_compressed(site: tuple[str, Path]) -> None:
    _, headers, body = fetch(f"{site[0]}/api/v1/assets")
    assert headers["Content-Encoding"] == "gzip"
    assert gzip.decompress(body) == ANSWER


@pytest.mark.usefixtures("application")
def test_a_missions_etag_stays_strong_so_that_if_match_can_match(site: tuple[str, Path]) -> None:
    _, headers, body = fetch(f"{site[0]}/api/v1/missions/1")
    assert (headers["ETag"], body) == ('"7"', ANSWER)


def test_no_log_has_the_link_to_a_new_password(site: tuple[str, Path]) -> None:
    """Neither the line of the request nor, as the application is away, that of its fault."""
    assert fetch(f"{site[0]}/new-password/MQ/c1x-secret")[0] == 503
    assert fetch(f"{site[0]}/invitation/c1x-secret")[0] == 503
    assert fetch(f"{site[0]}/email-address/c1x-secret")[0] == 503
    assert fetch(f"{site[0]}/single-sign-on/callback?code=c1x-secret")[0] == 503
    assert fetch(f"{site[0]}/lost-password?next=unseen")[0] == 503
    log = site[1] / "proxy.log"
    deadline = time.monotonic() + 10
    while '/lost-password?..." 503' not in log.read_text():
        assert time.monotonic() < deadline
        time.sleep(0.02)
    assert '"GET /new-password/..." 503' in log.read_text()
    assert '"GET /invitation/..." 503' in log.read_text()
    assert '"GET /email-address/..." 503' in log.read_text()
    assert "secret" not in log.read_text()
