"""Lines of log: readable or JSON, with what the work is about, and without anything that lets its holder in."""

import io
import json
import logging
import logging.config
import re
import time
from collections.abc import Iterator
from datetime import timedelta

import pytest
from django.conf import settings
from django.core import mail
from django.core.cache import cache
from django.test import Client, override_settings
from django.utils import timezone

from config.environment import log_settings
from operation.json_lines import JsonFormatter, LineFormatter
from operation.log_context import about
from operation.redaction import without_secrets
from tests.accounts.users import a_user, client_of
from tests.telemetry.links.uav_clients import LINK, linked_uav, report
from workspace.api_tokens import create_api_token
from workspace.models import Role, User

PASSWORD = "inspect-the-lines-8"
TIMEOUT_S = 60


@pytest.fixture
def logs() -> Iterator[dict[str, io.StringIO]]:
    """What both ways of writing give of everything that any logger says, however small."""
    streams = {"line": io.StringIO(), "json": io.StringIO()}
    root, handlers = logging.getLogger(), []
    for name, formatter in {"line": LineFormatter(), "json": JsonFormatter("web")}.items():
        handler = logging.StreamHandler(streams[name])
        handler.setFormatter(formatter)
        root.addHandler(handler)
        handlers.append(handler)
    level = root.level
    root.setLevel(logging.DEBUG)
    yield streams
    root.setLevel(level)
    for handler in handlers:
        root.removeHandler(handler)


def lines(logs: dict[str, io.StringIO]) -> list[dict[str, str]]:
    return [json.loads(line) for line in logs["json"].getvalue().splitlines()]


@pytest.mark.django_db
@pytest.mark.parametrize(("page", "begin"), [("invitation", ""), ("new-password", "MQ/"), ("email-address", "")])
def test_a_refused_request_at_a_link_is_told_without_it(logs: dict[str, io.StringIO], page: str, begin: str) -> None:
    assert Client(enforce_csrf_checks=True).post(f"/{page}/{begin}holder-of-the-link").status_code == 403
    for log in logs.values():
        assert f"/{page}/..." in log.getvalue()
        assert "holder-of-the-link" not in log.getvalue()


@pytest.mark.django_db
def test_other_addresses_are_told_whole(logs: dict[str, io.StringIO]) -> None:
    Client().get("/missions/nowhere-at-all")
    assert "/missions/nowhere-at-all" in logs["line"].getvalue()


@pytest.mark.django_db
@override_settings(LOG_REQUESTS=True)
def test_no_secret_of_a_whole_day_is_in_the_log(logs: dict[str, io.StringIO]) -> None:
    """Signing in, wrongly too, inviting, tokens, UAVs' tokens and keys, a new password by mail."""
    cache.clear()
    secrets = _a_day()
    assert len(secrets) >= 10
    for log in logs.values():
        written = log.getvalue()
        assert written.count("spanwise.request") >= 15
        assert [name for name, secret in secrets.items() if secret in written] == []


def _a_day() -> dict[str, str]:
    """Everything that lets its holder in and came up in it, by a name for it."""
    secrets = {"password": PASSWORD, "wrong password": "not-my-word-77", "secret key": settings.SECRET_KEY}
    User.objects.create_user("vera", "vera@example.org", PASSWORD, role=Role.ADMINISTRATOR)
    client = Client(raise_request_exception=False)
    client.post("/sign-in", {"login": "vera", "password": secrets["wrong password"]})
    client.post("/sign-in", {"login": "vera", "password": PASSWORD})
    secrets["session"] = client.cookies[settings.SESSION_COOKIE_NAME].value
    secrets["csrf cookie"] = client.cookies["csrftoken"].value if "csrftoken" in client.cookies else "no-cookie-for-forms"

    token = client.post("/api/v1/account/tokens", {"name": "ci", "expires_at": _tomorrow()}, content_type="application/json").json()
    secrets["token of a person"] = token["token"]
    program = Client(raise_request_exception=False, headers={"Authorization": f"Bearer {token['token']}"})
    assert program.get("/api/v1/missions").status_code == 200
    assert program.get("/api/v1/missions/nothing").status_code == 404
    program.post("/api/v1/plans", "{", content_type="application/json")
    Client().get("/api/v1/missions", headers={"Authorization": "Bearer spw_guessed-by-somebody-in-vain"})
    secrets["guessed token"] = "spw_guessed-by-somebody-in-vain"

    invitation = client.post("/api/v1/invitations", {"role": "viewer"}, content_type="application/json").json()
    secrets["invitation"] = re.search(r"/invitation/([^/\s\"]+)", json.dumps(invitation))[1]  # type: ignore[index]
    Client().get(f"/invitation/{secrets['invitation']}")
    Client(enforce_csrf_checks=True).post(f"/invitation/{secrets['invitation']}", {"username": "x"})

    Client().post("/lost-password", {"email": "vera@example.org"})
    deadline_s = time.monotonic() + TIMEOUT_S  # mails go out beside the answer
    while not mail.outbox and time.monotonic() < deadline_s:
        time.sleep(0.01)
    link = re.search(r"/new-password/(\S+)", mail.outbox[-1].body)
    assert link
    secrets["link of the mail"] = link[1]
    Client().get(f"/new-password/{link[1]}", follow=True)
    Client(enforce_csrf_checks=True).post(f"/new-password/{link[1]}")

    kite = linked_uav("Kite")
    secrets["token of a UAV"] = kite.token
    assert kite.report(report()).status_code == 200
    Client().post(f"{LINK}/telemetry", "{}", content_type="application/json", headers={"Authorization": "Bearer spu_wrong-but-secret"})
    secrets["wrong token of a UAV"] = "spu_wrong-but-secret"
    operator = client_of(a_user(Role.OPERATOR))
    made = operator.post(f"/api/v1/uavs/{kite.uav.pk}/credentials", {"kind": "mavlink-key"}, content_type="application/json")
    secrets["signing key"] = made.json()["secret"]
    return secrets


def _tomorrow() -> str:
    return (timezone.now() + timedelta(days=1)).isoformat()


@pytest.mark.parametrize(
    ("reported", "written"),
    [
        ("Authorization: Bearer spw_abcdefghijk", "Authorization: Bearer ..."),
        ("postgis://spanwise:hunter22@db/spanwise is away", "postgis://spanwise:...@db/spanwise is away"),
        ("{'password': 'a b c', 'name': 'vera'}", "{'password': ..., 'name': 'vera'}"),
        ("Cookie: sessionid=abc123; theme=dark", "Cookie: sessionid=...; theme=dark"),
        ("token=abc&next=/missions", "token=...&next=/missions"),
        ("GET /single-sign-on/callback?code=abc&state=def 302", "GET /single-sign-on/callback?... 302"),
        ("GET /missions?page=2 200", "GET /missions?page=2 200"),
        ("the key of zone 7", "the key of zone 7"),
    ],
)
def test_secrets_are_left_out_wherever_they_stand(reported: str, written: str) -> None:
    assert without_secrets(reported) == written


def test_a_traceback_is_told_without_them(logs: dict[str, io.StringIO]) -> None:
    try:
        raise ValueError("postgis://spanwise:hunter22@db refuses")
    except ValueError:
        logging.getLogger("spanwise.test").exception("away")
    for log in logs.values():
        assert "refuses" in log.getvalue()
        assert "hunter22" not in log.getvalue()


def test_nothing_that_is_told_begins_a_line_of_its_own(logs: dict[str, io.StringIO]) -> None:
    logging.getLogger("spanwise.test").warning("no UAV %s", "Kite\n2026-01-01 INFO forged\r\x1b[2J\u2028more")
    assert len(logs["json"].getvalue().splitlines()) == len(logs["line"].getvalue().splitlines()) == 1
    assert r"Kite\n2026-01-01 INFO forged\r\x1b[2J" in logs["line"].getvalue()


def test_a_line_names_what_the_work_is_about(logs: dict[str, io.StringIO]) -> None:
    with about(request="abc", mission="m-1"):
        logging.getLogger("spanwise.test").warning("hot", extra={"uav": 7})
    logging.getLogger("spanwise.test").warning("cold")
    hot, cold = lines(logs)
    assert {name: hot[name] for name in ("request", "mission", "uav", "program", "level", "message")} == {
        "request": "abc", "mission": "m-1", "uav": "7", "program": "web", "level": "WARNING", "message": "hot",
    }  # fmt: skip
    assert not {"request", "mission", "uav"} & cold.keys()
    assert logs["line"].getvalue().splitlines()[0].endswith("hot [request=abc mission=m-1 uav=7]")


@pytest.mark.django_db
@override_settings(LOG_REQUESTS=True)
def test_a_request_has_an_id_that_its_lines_and_its_answer_name(logs: dict[str, io.StringIO]) -> None:
    mission = "00000000-0000-4000-8000-000000000000"
    answer = client_of(a_user()).get(f"/api/v1/missions/{mission}", headers={"X-Request-ID": "from-the-proxy-1"})
    assert answer["X-Request-ID"] == "from-the-proxy-1"
    reported = [line for line in lines(logs) if line["logger"] == "spanwise.request"]
    assert [(line["request"], line["mission"]) for line in reported] == [("from-the-proxy-1", mission)]
    afterwards = [line for line in lines(logs) if line["logger"] == "django.request"]
    assert [(line["request"], line["mission"]) for line in afterwards] == [("from-the-proxy-1", mission)]


@pytest.mark.django_db
def test_who_is_refused_is_told_by_number_whatever_they_came_with(logs: dict[str, io.StringIO]) -> None:
    viewer = a_user(Role.VIEWER)
    token = create_api_token(user=viewer, name="ci", expires_at=timezone.now() + timedelta(days=1))
    assert client_of(viewer).post("/api/v1/missions", {}, content_type="application/json").status_code == 403
    answer = Client().post("/api/v1/missions", {}, content_type="application/json", headers={"Authorization": f"Bearer {token}"})
    assert answer.status_code == 403
    assert Client().get("/api/v1/missions").status_code == 401
    refused = [line for line in lines(logs) if line["logger"] == "django.request"]
    assert [line.get("user") for line in refused] == [str(viewer.pk), str(viewer.pk), None]
    assert all(line["request"] for line in refused)


@pytest.mark.django_db
@pytest.mark.parametrize("reported", ["", "short", "a" * 65, "with blanks in it", "new\tline-and-more", "<script>alert(1)</script>"])
def test_an_id_that_is_not_fit_to_be_written_down_is_replaced(reported: str) -> None:
    given = Client().get("/sign-in", headers={"X-Request-ID": reported})["X-Request-ID"]
    assert re.fullmatch(r"[0-9a-f]{32}", given)


@pytest.mark.parametrize(("stated", "made"), [("json", JsonFormatter), ("line", LineFormatter), ("", LineFormatter)])
def test_the_environment_chooses_the_way_of_writing(stated: str, made: type[logging.Formatter]) -> None:
    chosen = log_settings({"SPANWISE_LOG_FORMAT": stated, "SPANWISE_PROGRAM": "gateway"})
    formatter = chosen["formatters"][chosen["handlers"]["console"]["formatter"]]
    assert type(logging.config.DictConfigurator(chosen).configure_formatter(dict(formatter))) is made
