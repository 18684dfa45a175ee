"""Alerts over the API: found, acknowledged, noted, by whom may; and where they begin."""

from datetime import timedelta

import pytest
from django.db import connection
from django.utils import timezone
from django.utils.translation import override

from missions.models import Uav, UavType
from telemetry.models import Alert, AlertLevel
from telemetry.selectors.alert_words import TEMPLATES, alert_words
from telemetry.selectors.alerts import waiting_to_be_seen
from telemetry.services.alerts.alerts import close_alert, open_alert, raise_second_sender
from tests.accounts.users import a_user, client_of
from tests.missions.commands.outbox import a_uav
from tests.telemetry.records import at
from workspace.models import AuditEntry, Organisation, Role

pytestmark = pytest.mark.django_db
LATE = "%(uav)s: no telemetry for %(seconds)s s."


@pytest.fixture
def uav() -> Uav:
    return a_uav("Tern")


@pytest.fixture
def operator():
    return client_of(a_user(Role.OPERATOR))


def an_alert(uav: Uav, code: str = "link-lost", level: str = AlertLevel.WARNING, **facts) -> Alert:
    alert = open_alert(uav=uav, level=level, code=code, message=LATE, values={"uav": uav.name, "seconds": 12})
    Alert.objects.filter(pk=alert.pk).update(**facts)
    return alert


def post(client, path, **body):
    return client.post(f"/api/v1/alerts/{path}", body, content_type="application/json")


def found(client, query: str) -> list[str]:
    return [alert["code"] for alert in client.get(f"/api/v1/alerts?{query}").json()["results"]]


def test_alerts_are_filtered_and_paged_the_newest_first(uav, operator):
    other = a_uav("Kite")
    an_alert(uav, "gps", opened_at=at(0))
    an_alert(uav, "zone", AlertLevel.CRITICAL, opened_at=at(10))
    an_alert(other, "weather", opened_at=at(20), closed_at=at(30))
    assert found(operator, "") == ["weather", "zone", "gps"]
    assert found(operator, "state=open") == ["zone", "gps"]
    assert found(operator, "state=closed") == ["weather"]
    assert found(operator, "level=critical,advisory") == ["zone"]
    assert found(operator, "code=gps,weather") == ["weather", "gps"]
    assert found(operator, f"uav={other.pk}") == ["weather"]
    assert found(operator, "acknowledged=true") == []
    begin, end = at(5).isoformat().replace("+00:00", "Z"), at(20).isoformat().replace("+00:00", "Z")
    assert found(operator, f"opened_from={begin}&opened_before={end}") == ["zone"]
    first = operator.get("/api/v1/alerts?limit=2").json()
    assert [alert["code"] for alert in operator.get(first["next"]).json()["results"]] == ["gps"]


@pytest.mark.parametrize("query", ["state=shut", "level=bad", "uav=x", "mission=7", "opened_from=yesterday", "acknowledged=maybe"])
def test_what_cannot_be_asked_for_is_refused(query, operator):
    assert operator.get(f"/api/v1/alerts?{query}").status_code == 400


def test_acknowledged_it_goes_on_and_stays_with_who_was_first(uav, operator):
    alert = an_alert(uav)
    answer = post(operator, f"{alert.pk}/acknowledge", note="Called the pilot.").json()
    assert (answer["closed_at"], answer["notes"]) == (None, 1)
    again = post(client_of(a_user(Role.ADMINISTRATOR)), f"{alert.pk}/acknowledge").json()
    for name in ("acknowledged_at", "acknowledged_by", "notes"):
        assert again[name] == answer[name]
    assert [step["what"] for step in again["course"]] == ["opened", "acknowledged"]
    assert [entry.action for entry in AuditEntry.objects.filter(subject_type="alert").order_by("pk")] == ["acknowledge", "note"]


def test_a_raised_level_has_to_be_acknowledged_anew(uav, operator):
    alert = an_alert(uav)
    post(operator, f"{alert.pk}/acknowledge")
    an_alert(uav, level=AlertLevel.CRITICAL)
    answer = operator.get(f"/api/v1/alerts/{alert.pk}").json()
    assert (answer["level"], answer["acknowledged_at"]) == ("critical", None)
    assert [step["what"] for step in answer["course"]] == ["opened", "acknowledged", "rose"]


def test_a_note_that_is_sent_twice_with_one_key_is_written_once(uav, operator):
    alert = an_alert(uav)
    for _ in range(2):
        answer = operator.post(
            f"/api/v1/alerts/{alert.pk}/notes", {"text": "Seen."}, content_type="application/json", headers={"Idempotency-Key": "k"}
        )
        assert answer.status_code == 201
    assert [note["text"] for note in operator.get(f"/api/v1/alerts/{alert.pk}").json()["written"]] == ["Seen."]


def test_viewers_read_and_others_organisations_see_nothing(uav):
    alert = an_alert(uav)
    viewer = client_of(a_user(Role.VIEWER))
    assert viewer.get(f"/api/v1/alerts/{alert.pk}").status_code == 200
    assert post(viewer, f"{alert.pk}/acknowledge").status_code == 403
    stranger = client_of(a_user(Role.ADMINISTRATOR, organisation=Organisation.objects.create(name="Others")))
    assert found(stranger, "") == []
    assert [stranger.get(f"/api/v1/alerts/{alert.pk}").status_code, post(stranger, f"{alert.pk}/notes", text="x").status_code] == [404, 404]


def test_limits_are_stated_for_a_type_and_checked(operator):
    uav_type = UavType.objects.create(name="Quad", range_unlimited=True)
    address = f"/api/v1/uav-types/{uav_type.pk}/alert-limits"
    answer = operator.put(address, {"off_route_m": 40, "wind_mps": None}, content_type="application/json").json()
    assert answer["stated"] == {"off_route_m": 40.0}
    assert (answer["in_force"]["off_route_m"], answer["in_force"]["link_late_s"]) == (40.0, 5.0)
    for wrong in ({"off_route": 40}, {"off_route_m": "far"}, {"off_route_m": 1}, {"off_route_m": 200}, [1], {"link_late_s": True}):
        refused = operator.put(address, wrong, content_type="application/json")
        assert refused.status_code == 400 and refused.json()["error"]["details"]
    assert operator.get(address).json()["stated"] == {"off_route_m": 40.0}
    assert AuditEntry.objects.filter(action="state-alert-limits").count() == 1


def test_an_alert_is_read_in_german(uav):
    alert = an_alert(uav)
    with override("de"):
        assert alert_words(alert.message, alert.values) == "Tern: seit 12 s keine Telemetrie."
        same = [text for text in TEMPLATES if alert_words(text, _sevens(text)) == text % _sevens(text)]
    assert same == []


def _sevens(template: str) -> dict[str, str]:
    return {part.split(")")[0]: "7" for part in template.split("%(")[1:]}


def test_two_senders_are_told_and_over(uav):
    raise_second_sender(uav_id=uav.pk, believed="udp a", other="udp b")
    alert = Alert.objects.get()
    assert alert_words(alert.message, alert.values) == "Two senders say that they are Tern: udp a, which is believed, and udp b."
    raise_second_sender(uav_id=uav.pk)
    assert Alert.objects.get().close_reason == "cleared"
    assert not close_alert(uav=uav, code="second-sender")


def test_only_the_alert_of_a_uav_that_is_down_is_closed_by_people_and_with_a_reason(uav, operator):
    other, alert = an_alert(uav), an_alert(uav, "down-off-plan", AlertLevel.CRITICAL)
    answer = post(operator, f"{other.pk}/close", reason="Seen")
    assert (answer.status_code, answer.json()["error"]["code"]) == (409, "closed_by_itself")
    assert post(operator, f"{alert.pk}/close").status_code == 400
    assert post(client_of(a_user(Role.VIEWER)), f"{alert.pk}/close", reason="Seen").status_code == 403
    shown = post(operator, f"{alert.pk}/close", reason="Found in a field").json()
    assert (shown["close_reason"], shown["written"][0]["text"], shown["course"][-1]["reason"]) == (
        "by-person",
        "Found in a field",
        "by-person",
    )
    assert AuditEntry.objects.filter(subject_type="alert", action="close", subject_id=str(alert.pk)).count() == 1
    again = post(operator, f"{alert.pk}/close", reason="Again").json()
    assert (again["closed_at"], len(again["written"])) == (shown["closed_at"], 1)


def test_alerts_that_nobody_has_acknowledged_are_counted_ended_critical_ones_too(uav, operator):
    now = timezone.now()
    an_alert(uav, "gps", AlertLevel.CRITICAL)
    an_alert(uav, "zone", AlertLevel.CRITICAL, closed_at=now)
    an_alert(uav, "weather", AlertLevel.WARNING, closed_at=now)
    an_alert(uav, "off-route", AlertLevel.WARNING)
    an_alert(uav, "height-off", AlertLevel.WARNING, acknowledged_at=now)
    an_alert(uav, "converging", AlertLevel.CRITICAL, closed_at=now - timedelta(days=40))
    assert operator.get("/api/v1/alerts/counts").json() == {"critical": 3, "warning": 1, "advisory": 0}


def test_an_ended_critical_alert_stays_on_live_pages_until_it_is_acknowledged(uav, operator):
    ended = timezone.now() - timedelta(days=40)
    critical = an_alert(uav, "converging", AlertLevel.CRITICAL, closed_at=ended)
    again = an_alert(uav, "converging", AlertLevel.CRITICAL, closed_at=ended)
    an_alert(uav, "weather", AlertLevel.WARNING, closed_at=ended)

    def shown():
        return {alert["id"] for alert in operator.get("/api/v1/live").json()["live"]["alerts"]}

    assert shown() == {critical.pk, again.pk}
    post(operator, f"{again.pk}/acknowledge")
    assert shown() == set(), "with it those that ended before of the same cause"
    assert Alert.objects.get(pk=critical.pk).acknowledged_by is not None


def test_ended_critical_alerts_are_found_by_their_index(uav):
    with connection.cursor() as cursor:
        cursor.execute("SET LOCAL enable_seqscan = off")  # of a table that is as small
    waiting = Alert.objects.filter(waiting_to_be_seen(), organisation=uav.organisation_id)
    assert "alert_waits_to_be_seen_idx" in waiting.order_by("-closed_at")[:100].explain()


def test_acts_are_those_of_the_cause_or_of_the_alert_itself(uav, operator):
    hold = an_alert(uav, "zone")
    own = an_alert(uav, "gps", details={"acts": [{"kind": "land", "uav": uav.pk}], "hdop": 9.9})
    answers = {alert["id"]: alert for alert in operator.get("/api/v1/alerts").json()["results"]}
    assert answers[hold.pk]["acts"] == [{"kind": "hold", "uav": uav.pk}]
    assert (answers[own.pk]["acts"], answers[own.pk]["details"]) == ([{"kind": "land", "uav": uav.pk}], {"hdop": 9.9})


def test_an_alert_that_rose_since_it_was_seen_is_not_acknowledged(uav, operator):
    alert = an_alert(uav)
    an_alert(uav, level=AlertLevel.CRITICAL)
    answer = post(operator, f"{alert.pk}/acknowledge", seen_level="warning", note="Seen.")
    assert (answer.status_code, answer.json()["error"]["code"]) == (409, "level_rose")
    assert "critical" in answer.json()["error"]["message"]
    shown = operator.get(f"/api/v1/alerts/{alert.pk}").json()
    assert (shown["level"], shown["acknowledged_at"], shown["notes"]) == ("critical", None, 0)
    assert post(operator, f"{alert.pk}/acknowledge", seen_level="critical").json()["acknowledged_at"]
    again = post(operator, f"{alert.pk}/acknowledge", seen_level="warning")
    assert again.status_code == 200, "somebody has seen it at its level"


def test_without_a_level_an_alert_is_acknowledged_whatever_it_is_and_an_unknown_level_is_refused(uav, operator):
    alert = an_alert(uav, level=AlertLevel.CRITICAL)
    assert post(operator, f"{alert.pk}/acknowledge", seen_level="bad").status_code == 400
    assert post(operator, f"{alert.pk}/acknowledge").json()["acknowledged_at"]


def test_ended_alerts_are_acknowledged_together_and_open_ones_are_left(uav, operator):
    now = timezone.now()
    older = an_alert(uav, "zone", AlertLevel.CRITICAL, closed_at=now - timedelta(hours=2))
    ended = [an_alert(uav, code, AlertLevel.CRITICAL, closed_at=now) for code in ("zone", "gps")]
    unseen = an_alert(uav, "converging", AlertLevel.CRITICAL, closed_at=now)
    live = an_alert(uav, "battery-short", AlertLevel.CRITICAL)
    ids = [*(alert.pk for alert in ended), live.pk, 999_999]
    answer = post(operator, "acknowledge-ended", alerts=ids)
    assert answer.status_code == 200
    outcomes = {row["id"]: row["outcome"] for row in answer.json()["results"]}
    assert outcomes == {ended[0].pk: "acknowledged", ended[1].pk: "acknowledged", live.pk: "still-open", 999_999: "unknown"}
    still = set(Alert.objects.filter(acknowledged_at=None).values_list("pk", flat=True))
    assert still == {unseen.pk, live.pk}, f"{older.pk} is an earlier one of the same cause"
    assert [row.course[-1]["what"] for row in Alert.objects.filter(pk__in=[alert.pk for alert in ended])] == ["acknowledged"] * 2
    audited = AuditEntry.objects.filter(subject_type="alert", action="acknowledge").values_list("subject_id", flat=True)
    assert sorted(audited) == sorted(str(alert.pk) for alert in ended)
    assert post(operator, "acknowledge-ended", alerts=ids).json() == answer.json()
    assert AuditEntry.objects.filter(subject_type="alert").count() == 2, "those that were acknowledged before are not audited again"


def test_ended_alerts_of_others_are_unknown_and_viewers_acknowledge_none(uav):
    ended = an_alert(uav, "zone", AlertLevel.CRITICAL, closed_at=timezone.now())
    assert post(client_of(a_user(Role.VIEWER)), "acknowledge-ended", alerts=[ended.pk]).status_code == 403
    stranger = client_of(a_user(Role.ADMINISTRATOR, organisation=Organisation.objects.create(name="Others")))
    assert post(stranger, "acknowledge-ended", alerts=[ended.pk]).json()["results"] == [{"id": ended.pk, "outcome": "unknown"}]
    for wrong in ([], ["1"], [0], "all"):
        assert post(stranger, "acknowledge-ended", alerts=wrong).status_code == 400
    ended.refresh_from_db()
    assert ended.acknowledged_at is None
