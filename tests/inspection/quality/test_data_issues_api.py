"""Data issues over HTTP: the list, who may repair, and undo."""

import pytest

from inspection.models import Asset, DataIssue
from inspection.services import find_issues
from tests.accounts.users import a_user, client_of
from tests.inspection.ground import line, tower
from workspace.models import Role

pytestmark = pytest.mark.django_db


@pytest.fixture
def client():
    return client_of(a_user(Role.CURATOR))


@pytest.fixture
def issue():
    places = [(10.0, 56.0 + 0.0027 * step) for step in range(11)] + [(10.0, 56.0 + 0.0027 * 18)]
    for place in places:
        tower(place)
    line(*places, voltages_v=[110_000], name="Long line")
    tower((10.5, 56.5))
    find_issues(force=True)
    return DataIssue.objects.get(kind="long_span")


def post(client, issue, endpoint, body=None):
    return client.post(f"/api/v1/data-issues/{issue.pk}/{endpoint}", body or {}, content_type="application/json")


def kinds(client, query=""):
    answer = client.get(f"/api/v1/data-issues?{query}")
    assert answer.status_code == 200, answer.content
    return [feature["properties"]["kind"] for feature in answer.json()["features"]]


def test_the_list_is_worst_first_and_says_what_is_wrong(client, issue):
    features = client.get("/api/v1/data-issues?state=open").json()["features"]
    worst = features[0]["properties"]
    assert (worst["kind"], worst["title"], worst["asset"]["label"]) == ("long_span", "Span of 2.4\N{NO-BREAK SPACE}km", "Long line")
    assert worst["sentence"].startswith("Span of 2.4\N{NO-BREAK SPACE}km; the usual one here is 0.30\N{NO-BREAK SPACE}km. About 7 towers")
    assert [offer["action"] for offer in worst["repairs"]] == ["place_towers"]
    assert features[0]["geometry"]["type"] == "LineString"
    cut_off = [feature["properties"]["cut_off_m"] for feature in features]
    assert cut_off == sorted(cut_off, reverse=True)


def test_kind_state_box_and_text_narrow_the_list(client, issue):
    assert kinds(client, "kind=tower_on_no_line") == ["tower_on_no_line"]
    assert kinds(client, "state=dismissed") == []
    assert kinds(client, "bbox=10.4,56.4,10.6,56.6") == ["tower_on_no_line"]
    assert "tower_on_no_line" not in kinds(client, "text=long")
    assert kinds(client, "text=long&kind=long_span") == ["long_span"]


@pytest.mark.parametrize("query", ["kind=nothing", "state=lost", "bbox=1,2,3", "limit=x", "cursor=x"])
def test_a_query_that_says_nothing_is_refused(client, issue, query):
    assert client.get(f"/api/v1/data-issues?{query}").status_code == 400


def test_pages_follow_each_other_without_an_issue(client, issue):
    whole = [feature["id"] for feature in client.get("/api/v1/data-issues").json()["features"]]
    seen, address = [], "/api/v1/data-issues?limit=1"
    while address:
        page = client.get(address).json()
        seen += [feature["id"] for feature in page["features"]]
        address = page["next"]
    assert seen == whole


def test_the_summary_counts_by_kind_and_state(client, issue):
    summary = client.get("/api/v1/data-issues/summary").json()
    assert summary["kinds"]["long_span"] == {"open": 1, "repaired": 0, "dismissed": 0}
    assert summary["is_current"]
    assert summary["searched_at"]


def test_before_the_first_search_the_summary_says_so(client):
    assert client.get("/api/v1/data-issues/summary").json()["searched_at"] is None


def test_one_issue_comes_with_a_preview_of_each_repair(client, issue):
    (offer,) = client.get(f"/api/v1/data-issues/{issue.pk}").json()["properties"]["repairs"]
    assert len(offer["preview"]["features"]) == 8
    assert client.get("/api/v1/data-issues/999999").status_code == 404


def test_a_repair_answers_with_its_entries_and_undo_takes_all_back(client, issue):
    answer = post(client, issue, "repair", {"action": "place_towers"})
    assert answer.status_code == 200, answer.content
    body = answer.json()
    assert body["issue"]["properties"]["state"] == "repaired"
    assert (len(body["entries"]), body["said"], body["is_current"]) == (8, "7 towers placed, 1 line changed.", True)
    assert Asset.objects.filter(tags__has_key="spanwise:placed").count() == 7
    undone = post(client, issue, "undo", {"entries": body["entries"]})
    assert undone.json()["properties"]["state"] == "open"
    assert not Asset.objects.filter(tags__has_key="spanwise:placed").exists()


def test_an_undo_that_comes_too_late_changes_nothing(client, issue):
    entries = post(client, issue, "repair", {"action": "place_towers"}).json()["entries"]
    row = Asset.objects.get(pk=issue.asset_id)
    client.patch(f"/api/v1/assets/{row.pk}", {"name": "Other"}, content_type="application/json", headers={"If-Match": f'"{row.revision}"'})
    assert post(client, issue, "undo", {"entries": entries}).status_code == 409
    assert Asset.objects.filter(tags__has_key="spanwise:placed").count() == 7


def test_undo_takes_no_entries_of_others(client, issue):
    post(client, issue, "dismiss", {"note": "no"})
    assert post(client, issue, "undo", {"entries": [987_654]}).status_code == 409
    assert post(client, issue, "undo", {"entries": []}).status_code == 400


def test_an_issue_is_dismissed_with_a_note_and_opened_again(client, issue):
    said = post(client, issue, "dismiss", {"note": "A lake."}).json()["properties"]
    assert (said["state"], said["note"], said["repairs"]) == ("dismissed", "A lake.", [])
    assert said["decided_by"]
    assert post(client, issue, "reopen").json()["properties"]["state"] == "open"
    assert post(client, issue, "dismiss", {"note": "x" * 501}).status_code == 400


@pytest.mark.parametrize(("body", "status"), [({}, 400), ({"action": "fly"}, 409), ({"action": "join"}, 409)])
def test_a_repair_that_does_not_fit_is_refused(client, issue, body, status):
    assert post(client, issue, "repair", body).status_code == status


@pytest.mark.parametrize("role", [Role.VIEWER, Role.OPERATOR])
@pytest.mark.parametrize("endpoint", ["repair", "dismiss", "reopen", "undo"])
def test_who_is_no_curator_may_only_read(issue, role, endpoint):
    client = client_of(a_user(role))
    assert kinds(client)
    assert post(client, issue, endpoint, {"action": "place_towers", "entries": [1]}).status_code == 403
    assert DataIssue.objects.get(pk=issue.pk).state == "open"


def test_nobody_sees_gaps_without_signing_in(db, client, issue):
    client.logout()
    assert client.get("/api/v1/data-issues").status_code in {401, 403}
