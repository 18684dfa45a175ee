"""Periods of applicability: read from both standards, kept in one form, said in words."""

from typing import Any

import pytest

from inspection.geodesy.geometry_validator import GeometryFault
from inspection.serializers.zones import schedule_sentence
from inspection.zones.schedule import checked_schedule


def entry(*days: str, **sides: str | None) -> dict[str, Any]:
    return {"day": list(days), "startTime": None, "startEvent": None, "endTime": None, "endEvent": None} | sides


def test_a_period_of_ed_269_and_one_of_ed_318_have_one_form() -> None:
    ed269 = [
        {
            "startDateTime": "2022-06-15T09:00:00.00Z", "endDateTime": "2023-06-15T11:00:00+02:00", "permanent": "NO",
            "schedule": [{"day": ["SUN", "SAT"], "startTime": "17:00:00.00Z", "endTime": "23:59:59.00Z"}],
        }
    ]  # fmt: skip
    assert checked_schedule(ed269, "applicability") == [
        {
            "startDateTime": "2022-06-15T09:00:00Z",
            "endDateTime": "2023-06-15T09:00:00Z",
            "schedule": [entry("SAT", "SUN", startTime="17:00:00Z", endTime="23:59:59Z")],
        }
    ]
    ed318 = [{"schedule": [{"day": ["ANY"], "startEvent": "SS", "endEvent": "SR"}]}]
    assert checked_schedule(ed318, "limitedApplicability") == [
        {"startDateTime": None, "endDateTime": None, "schedule": [entry("ANY", startEvent="SS", endEvent="SR")]}
    ]


@pytest.mark.parametrize(
    "value", [None, [], [{"permanent": "YES"}], [{"permanent": "YES"}, {"startDateTime": "2026-01-01T00:00:00Z"}], [{}]]
)
def test_what_has_no_bound_applies_always(value: Any) -> None:
    assert checked_schedule(value, "applicability") is None


def test_the_form_is_its_own_form() -> None:
    value = [{"endDateTime": "2026-12-31T23:59:00Z", "schedule": [entry("MON", startTime="08:00:00Z", endTime="24:00:00Z")]}]
    once = checked_schedule(value, "x")
    assert checked_schedule(once, "x") == once


@pytest.mark.parametrize(
    ("value", "place"),
    [
        ("always", "x"),
        ([7], "x[0]"),
        ([{"permanent": "MAYBE"}], "x[0].permanent"),
        ([{"startDateTime": "2026-13-01T00:00:00Z"}], "x[0].startDateTime"),
        ([{"startDateTime": "2026-12-01T00:00:00"}], "x[0].startDateTime"),
        ([{"startDateTime": {"no": "date"}}], "x[0].startDateTime"),
        ([{"startDateTime": "2026-12-02T00:00:00Z", "endDateTime": "2026-12-01T00:00:00Z"}], "x[0].endDateTime"),
        ([{"schedule": [{"day": ["FUNDAY"]}]}], "x[0].schedule[0].day"),
        ([{"schedule": [{"day": "MON"}]}], "x[0].schedule[0].day"),
        ([{"schedule": [{"startTime": "25:00:00Z"}]}], "x[0].schedule[0].startTime"),
        ([{"schedule": [{"startTime": "01:00:00+02:00"}]}], "x[0].schedule[0].startTime"),
        ([{"schedule": [{"endTime": "8 am"}]}], "x[0].schedule[0].endTime"),
        ([{"schedule": [{"startEvent": "NOON"}]}], "x[0].schedule[0].startEvent"),
        ([{"schedule": [{"startEvent": "SR", "startTime": "08:00:00Z"}]}], "x[0].schedule[0].startEvent"),
        ([{"schedule": [{"day": ["MON"]}] * 101}], "x[0].schedule"),
        ([{"startDateTime": "2026-12-02T00:00:00Z"}] * 201, "x"),
    ],
)
def test_what_is_wrong_is_refused_with_its_place(value: Any, place: str) -> None:
    with pytest.raises(GeometryFault) as refused:
        checked_schedule(value, "x")
    assert refused.value.place == place


def test_people_read_it_as_a_sentence() -> None:
    weekdays = [
        {
            "endDateTime": "2026-12-31T23:59:00Z",
            "schedule": [{"day": ["MON", "TUE", "WED", "THU", "FRI"], "startTime": "08:00Z", "endTime": "18:00Z"}],
        }
    ]
    assert schedule_sentence(checked_schedule(weekdays, "x")) == "Mon to Fri 08:00 to 18:00 UTC, until 31 Dec 2026"
    assert schedule_sentence(checked_schedule([{"schedule": [{"startEvent": "SS", "endEvent": "SR"}]}], "x")) == "daily sunset to sunrise"
    some_hours = {"startDateTime": "2026-11-21T14:00:00Z", "endDateTime": "2026-11-21T17:00:00Z"}
    assert schedule_sentence(checked_schedule([some_hours], "x")) == "21 Nov 2026, 14:00 to 17:00 UTC"
    assert schedule_sentence(checked_schedule([{"startDateTime": "2026-11-21T06:30:00Z"}], "x")) == "from 21 Nov 2026 06:30 UTC on"
    assert schedule_sentence(checked_schedule([{"endDateTime": "2026-11-21T00:00:00Z"}], "x")) == "until 21 Nov 2026"
    over_night = some_hours | {"endDateTime": "2026-11-22T05:00:00Z"}
    assert schedule_sentence(checked_schedule([over_night], "x")) == "from 21 Nov 2026 14:00 UTC to 22 Nov 2026 05:00 UTC"
    assert schedule_sentence(None) == "Always"
