"""The pages' shells: who gets in, and the limit on wrong sign-ins."""

import uuid

import pytest
from django.contrib.gis.geos import Point
from django.core.cache import cache
from django.test import Client
from django.urls import reverse
from redis.exceptions import ConnectionError as RedisConnectionError

from inspection.services import mark_ground_changed
from missions.models import InspectionTarget, Mission, MissionUav, Uav
from tests.inspection.ground import tower
from workspace.models import Organisation, Role, User

pytestmark = pytest.mark.django_db
WRONG = "User name or password is wrong."


@pytest.fixture
def operator() -> User:
    return User.objects.create_user(f"operator-{uuid.uuid4().hex[:8]}", password="inspect-the-lines", role=Role.OPERATOR)


def sign_in(client: Client, name: str, password: str) -> str:
    return client.post(reverse("account_login"), {"login": name, "password": password}).content.decode()


@pytest.mark.parametrize("path", ["/", "/missions/new", f"/missions/{uuid.UUID(int=1)}"])
def test_pages_ask_strangers_to_sign_in(client: Client, path: str) -> None:
    response = client.get(path)
    assert response.status_code == 302
    assert response.headers["Location"] == f"/sign-in?next={path}"


def test_tries_are_counted_down_and_then_even_the_right_password_waits(client: Client, operator: User) -> None:
    for left in ("4 tries", "3 tries", "2 tries", "1 try", "No tries"):
        assert f"{WRONG} {left} left for 15 min." in sign_in(client, operator.username, "wrong")
    assert "Too many wrong tries. Wait 15 min, then try again." in sign_in(client, operator.username, "inspect-the-lines")
    assert client.get("/").status_code == 302


def test_a_right_password_forgets_wrong_tries(client: Client, operator: User) -> None:
    sign_in(client, operator.username, "wrong")
    sign_in(client, operator.username, "inspect-the-lines")
    client.post(reverse("sign-out"))
    assert f"{WRONG} 4 tries left" in sign_in(client, operator.username, "wrong")


def test_the_limit_of_one_name_leaves_the_others_alone(client: Client, operator: User) -> None:
    for _ in range(5):
        sign_in(client, f"nobody-{operator.username}", "wrong")
    sign_in(client, operator.username, "inspect-the-lines")
    assert client.get("/").status_code == 200


def test_sign_in_works_without_the_cache(client: Client, operator: User, monkeypatch: pytest.MonkeyPatch) -> None:
    def away(*_: object, **__: object) -> None:
        raise RedisConnectionError

    for name in ("get", "add", "incr", "delete"):
        monkeypatch.setattr(cache, name, away)
    assert WRONG in sign_in(client, operator.username, "wrong")
    sign_in(client, operator.username, "inspect-the-lines")
    assert client.get("/").status_code == 200


@pytest.mark.parametrize(("typed", "shown"), [("/missions", "/"), ("/map?tool=box", "/missions/new?tool=box")])
def test_addresses_that_users_type_lead_to_their_pages(client: Client, operator: User, typed: str, shown: str) -> None:
    client.force_login(operator)
    response = client.get(typed)
    assert (response.status_code, response["Location"]) == (302, shown)


def test_a_mission_of_another_organisation_is_not_found(client: Client, operator: User) -> None:
    own = Mission.objects.create(name="Ours", organisation=operator.organisation)
    other = Mission.objects.create(name="Theirs", organisation=Organisation.objects.create(name="Others"))
    client.force_login(operator)
    assert client.get(f"/missions/{own.pk}").status_code == 200
    assert client.get(f"/missions/{other.pk}").status_code == 404
    assert client.get(f"/missions/{uuid.uuid4()}").status_code == 404


def test_nothing_of_the_organisation_is_written_into_the_page(client: Client, operator: User) -> None:
    """All data comes from the API: a shell may be cached or read over a shoulder."""
    Uav.objects.create(name="Secret Heron", location=Point(10, 50, srid=4326), organisation=operator.organisation)
    client.force_login(operator)
    assert "Secret Heron" not in client.get("/missions/new").content.decode()


def test_the_map_knows_where_to_open_before_its_first_request(client: Client, operator: User) -> None:
    asset, far = tower((10.0, 56.0)), tower((10.5, 56.5))
    mark_ground_changed()
    mission = Mission.objects.create(name="Ours", organisation=operator.organisation)
    client.force_login(operator)
    page = client.get(f"/missions/{mission.pk}").context["page"]
    assert (page["extent"], page["bounds"]) == ((10.0, 56.0, 10.5, 56.5), None)
    MissionUav.objects.create(mission=mission, sequence=0, name="Heron", start=Point(10.2, 56.3, srid=4326), cruise_speed_mps=12)
    InspectionTarget.objects.create(mission=mission, sequence=0, asset=asset, label="1")
    InspectionTarget.objects.create(mission=mission, sequence=1, asset=far, label="2", position=Point(10.1, 56.1, srid=4326))
    assert client.get(f"/missions/{mission.pk}").context["page"]["bounds"] == (10.0, 56.0, 10.2, 56.3)
    assert client.get("/missions/new").context["page"]["bounds"] is None


def test_a_name_with_markup_is_text(client: Client) -> None:
    page = sign_in(client, '"><script>alert(1)</script>', "wrong")
    assert "<script>alert" not in page
