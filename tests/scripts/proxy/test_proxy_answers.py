"""A real nginx with the written configuration, in front of a small application: what arrives at the browser."""

import gzip
import json
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from scripts.places import WEB_PROGRAMS
from tests.scripts.proxy.served_site import ANSWER, BUNDLES, application_at, fetch, served_site


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
def test_a_mission_is_compressed_and_its_etag_weak(site: tuple[str, Path]) -> None:
    """The application compares what If-Match names without regard to that: workspace/api/preconditions.py."""
    _, headers, body = fetch(f"{site[0]}/api/v1/missions/1")
    assert (headers["ETag"], headers["Content-Encoding"], gzip.decompress(body)) == ('W/"7"', "gzip", ANSWER)


@pytest.mark.parametrize("name", ["main-ABCDEFGH.js", "page-ABCDEFGH.css"])
def test_a_bundle_is_sent_in_brotli_to_browsers_that_accept_it(site: tuple[str, Path], name: str) -> None:
    _, plain, _ = fetch(f"{site[0]}/static/bundles/{name}", accept_encoding="identity")
    for accepted in ("gzip, deflate, br, zstd", "br"):
        status, headers, body = fetch(f"{site[0]}/static/bundles/{name}", accept_encoding=accepted)
        stem, _, ending = name.partition(".")
        assert (status, headers["Content-Encoding"], body) == (200, "br", BUNDLES[f"{stem}.br.{ending}"])
        assert headers["Vary"] == "Accept-Encoding"
        same = ("Content-Type", "Cache-Control", "Content-Security-Policy", "X-Content-Type-Options")
        assert [headers[header] for header in same] == [plain[header] for header in same]


def test_a_browser_without_brotli_gets_a_bundle_in_gzip_or_as_it_is(site: tuple[str, Path]) -> None:
    address = f"{site[0]}/static/bundles/main-ABCDEFGH.js"
    _, headers, body = fetch(address)
    assert (headers["Content-Encoding"], gzip.decompress(body)) == ("gzip", BUNDLES["main-ABCDEFGH.js"])
    assert headers["Cache-Control"] == "public, max-age=31536000, immutable"
    _, headers, body = fetch(address, accept_encoding="identity, brx")
    assert (headers["Content-Encoding"], body) == (None, BUNDLES["main-ABCDEFGH.js"])


def test_a_source_map_is_sent_as_json(site: tuple[str, Path]) -> None:
    status, headers, body = fetch(f"{site[0]}/static/bundles/main-ABCDEFGH.js.map", accept_encoding="br")
    assert (status, headers["Content-Type"], headers["Content-Encoding"], body) == (200, "application/json", None, b"{}")


def test_the_folder_of_brotli_has_no_address_of_its_own(site: tuple[str, Path]) -> None:
    assert fetch(f"{site[0]}/.brotli/bundles/main-ABCDEFGH.br.js")[0] == 404


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
