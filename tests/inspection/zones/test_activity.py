"""When zones apply: hand-worked times, published times of sunrise, and what may never get less."""

from datetime import UTC, datetime
from itertools import pairwise
from typing import Any

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from inspection.importers.zones.zone_file import read_zones
from inspection.zones.activity import DAY_S, EPOCH, SUN_ALLOWANCE_S, TimeSpan, active_spans, merged, sun_event_s
from inspection.zones.schedule import DAYS, EVENTS, checked_schedule

COPENHAGEN = (12.5, 55.6, 12.6, 55.7)
COLUMBUS = (-83.0, 39.9, -82.9, 40.0)
AUCKLAND = (174.7, -36.9, 174.8, -36.8)
TROMSO = (18.9, 69.6, 19.0, 69.7)
A_MINUTE_S = 60.0


def at(text: str) -> float:
    """2026-11-23 is a Monday."""
    return datetime.fromisoformat(text).replace(tzinfo=UTC).timestamp()


def entry(*days: str, **sides: str | None) -> dict[str, Any]:
    return {"day": list(days), "startTime": None, "startEvent": None, "endTime": None, "endEvent": None} | sides


def schedule(*entries: dict[str, Any], start: str | None = None, end: str | None = None) -> list[dict[str, Any]]:
    return [{"startDateTime": start, "endDateTime": end, "schedule": list(entries)}]


def spans(periods: Any, from_at: str, to_at: str, box: Any = COPENHAGEN, margin_s: float = 0.0) -> list[tuple[str, str]]:
    found = active_spans(periods, box, at(from_at), at(to_at), margin_s)
    return [(_text(span.from_s), _text(span.to_s)) for span in found]


def _text(moment_s: float) -> str:
    return f"{datetime.fromtimestamp(moment_s, UTC):%a %H:%M}"


WORKDAYS = schedule(entry("MON", "TUE", startTime="08:00:00Z", endTime="18:00:00Z"))


def test_days_and_times() -> None:
    assert spans(WORKDAYS, "2026-11-22T00:00", "2026-11-29T00:00") == [("Mon 08:00", "Mon 18:00"), ("Tue 08:00", "Tue 18:00")]
    assert spans(WORKDAYS, "2026-11-23T09:00", "2026-11-24T09:00") == [("Mon 09:00", "Mon 18:00"), ("Tue 08:00", "Tue 09:00")]
    assert spans(WORKDAYS, "2026-11-25T00:00", "2026-11-30T08:00") == []


def test_the_end_of_a_span_is_not_in_it_and_its_start_is() -> None:
    assert spans(WORKDAYS, "2026-11-23T18:00", "2026-11-23T19:00") == []
    assert spans(WORKDAYS, "2026-11-23T07:00", "2026-11-23T08:00") == []
    assert spans(WORKDAYS, "2026-11-23T17:59", "2026-11-23T19:00") == [("Mon 17:59", "Mon 18:00")]


def test_an_entry_over_midnight_goes_on_into_the_next_day_and_the_next_week() -> None:
    night = schedule(entry("SUN", startTime="22:00:00Z", endTime="05:00:00Z"))
    assert spans(night, "2026-11-22T00:00", "2026-11-24T00:00") == [("Sun 22:00", "Mon 05:00")]
    assert spans(night, "2026-11-23T00:00", "2026-11-24T00:00") == [("Mon 00:00", "Mon 05:00")]


def test_days_without_times_join_at_midnight() -> None:
    assert spans(schedule(entry("SAT", "SUN")), "2026-11-20T00:00", "2026-11-25T00:00") == [("Sat 00:00", "Mon 00:00")]
    last_second = schedule(entry("SAT", "SUN", startTime="17:00:00Z", endTime="23:59:59Z"), entry("SUN", endTime="01:00:00Z"))
    assert spans(last_second, "2026-11-20T00:00", "2026-11-25T00:00") == [("Sat 17:00", "Sun 01:00"), ("Sun 17:00", "Mon 00:00")]


def test_the_same_time_at_both_ends_is_a_whole_day() -> None:
    around = schedule(entry("MON", startTime="06:00:00Z", endTime="06:00:00Z"))
    assert spans(around, "2026-11-22T00:00", "2026-11-26T00:00") == [("Mon 06:00", "Tue 06:00")]


def test_a_period_bounds_its_entries_and_without_entries_is_all_the_time() -> None:
    bounded = schedule(entry("ANY", startTime="08:00:00Z", endTime="18:00:00Z"), start="2026-11-23T10:00:00Z", end="2026-11-24T09:00:00Z")
    assert spans(bounded, "2026-11-22T00:00", "2026-11-29T00:00") == [("Mon 10:00", "Mon 18:00"), ("Tue 08:00", "Tue 09:00")]
    assert spans(schedule(end="2026-11-24T15:59:59Z"), "2026-11-24T00:00", "2026-11-29T00:00") == [("Tue 00:00", "Tue 16:00")]
    assert spans(schedule(end="2026-11-21T00:00:00Z"), "2026-11-22T00:00", "2026-11-29T00:00") == []


def test_no_schedule_is_always() -> None:
    assert active_spans(None, COPENHAGEN, 0.0, 10.0) == (TimeSpan(0.0, 10.0),)
    assert active_spans(None, COPENHAGEN, 10.0, 10.0) == ()


@pytest.mark.parametrize(
    "stored",
    [
        [],
        [{}],
        ["daily"],
        {"day": "MON"},
        schedule(entry("FUNDAY")),
        schedule(entry("MON", startTime="8 o'clock")),
        schedule(entry("MON", startEvent="TEATIME")),
        schedule(entry("MON", startTime="08:00:00Z", startEvent="SR")),
        schedule({"day": ["MON"]}),
        schedule(entry("MON"), start="2026-11-23T10:00:00"),
        schedule(entry("MON"), start="9999999"),
    ],
)
def test_what_cannot_be_understood_applies_always(stored: Any) -> None:
    assert spans(stored, "2026-11-24T00:00", "2026-11-26T00:00") == [("Tue 00:00", "Thu 00:00")]


def test_a_margin_is_added_on_both_sides_and_reaches_in_from_outside() -> None:
    assert spans(WORKDAYS, "2026-11-22T00:00", "2026-11-24T00:00", margin_s=300) == [("Mon 07:55", "Mon 18:05")]
    assert spans(WORKDAYS, "2026-11-23T18:01", "2026-11-23T19:00", margin_s=300) == [("Mon 18:01", "Mon 18:05")]


@pytest.mark.parametrize(
    ("event", "day", "place", "published"),
    [  # timeanddate.com and the U.S. Naval Observatory's tables, to the minute
        ("SR", "2026-06-21", (12.57, 55.68), "2026-06-21T02:25"),
        ("SS", "2026-06-21", (12.57, 55.68), "2026-06-21T19:57"),
        ("SR", "2026-12-21", (12.57, 55.68), "2026-12-21T07:37"),
        ("SS", "2026-12-21", (12.57, 55.68), "2026-12-21T14:38"),
        ("SR", "2026-06-21", (-83.0, 39.96), "2026-06-21T10:03"),
        ("SS", "2026-06-21", (-83.0, 39.96), "2026-06-22T01:04"),
        ("SR", "2026-06-21", (174.76, -36.85), "2026-06-20T19:33"),
        ("SS", "2026-06-21", (174.76, -36.85), "2026-06-21T05:11"),
        ("BMCT", "2026-06-21", (-83.0, 39.96), "2026-06-21T09:31"),
        ("EECT", "2026-06-21", (-83.0, 39.96), "2026-06-22T01:36"),
    ],
)
def test_the_sun_keeps_the_published_times(event: str, day: str, place: tuple[float, float], published: str) -> None:
    solar_day = (datetime.fromisoformat(day).date() - EPOCH).days
    moment = sun_event_s(event, solar_day, *place)
    assert moment == pytest.approx(at(published), abs=1.5 * A_MINUTE_S)


def test_on_the_equator_at_the_equinox_day_and_night_are_equal_but_for_refraction() -> None:
    """Of 360 degrees the sun is up for 180 and twice 50', which is 12 h 6 min 40 s."""
    day = (datetime.fromisoformat("2026-03-20").date() - EPOCH).days
    rises, sets = sun_event_s("SR", day, 0.0, 0.0), sun_event_s("SS", day, 0.0, 0.0)
    assert rises is not None
    assert sets is not None
    assert sets - rises == pytest.approx(DAY_S / 2 + 400.0, abs=20.0)


def test_from_sunset_to_sunrise_is_a_night_wherever_the_zone_is() -> None:
    night = schedule(entry("ANY", startEvent="SS", endEvent="SR"))
    assert spans(night, "2026-06-21T12:00", "2026-06-22T12:00") == [("Sun 19:55", "Mon 02:28")]
    assert spans(night, "2026-06-21T14:00", "2026-06-22T14:00", COLUMBUS) == [("Mon 01:01", "Mon 10:06")]
    assert spans(night, "2026-06-21T00:00", "2026-06-22T00:00", AUCKLAND) == [("Sun 05:09", "Sun 19:36")]


def test_a_night_named_by_its_day_is_that_day_by_utc_and_by_the_sun() -> None:
    """In Columbus Sunday's sunset comes on Monday in UTC; both readings of "SUN" count."""
    night = schedule(entry("SUN", startEvent="SS", endEvent="SR"))
    found = spans(night, "2026-06-19T12:00", "2026-06-24T12:00", COLUMBUS)
    assert [start[:3] for start, _end in found] == ["Sun", "Mon"]


def test_a_wide_zone_begins_where_the_sun_is_first_and_ends_where_it_is_last() -> None:
    """40 degrees of longitude are 160 min of the sun's way."""
    day = schedule(entry("ANY", startEvent="SR", endEvent="SS"))
    (narrow,) = active_spans(day, (0.0, 50.0, 0.0, 50.0), at("2026-03-20T00:00"), at("2026-03-21T00:00"))
    (wide,) = active_spans(day, (-20.0, 50.0, 20.0, 50.0), at("2026-03-20T00:00"), at("2026-03-21T00:00"))
    assert narrow.from_s - wide.from_s == pytest.approx(80 * 60, abs=60)
    assert wide.to_s - narrow.to_s == pytest.approx(80 * 60, abs=60)


def test_where_the_sun_does_not_set_or_rise_the_zone_applies_all_day() -> None:
    for from_at, to_at in (("2026-06-21T00:00", "2026-06-23T00:00"), ("2026-12-21T00:00", "2026-12-23T00:00")):
        for sides in (
            {"startEvent": "SS", "endEvent": "SR"},
            {"startEvent": "SR", "endEvent": "SS"},
            {"startTime": "10:00:00Z", "endEvent": "SS"},
        ):
            found = active_spans(schedule(entry("ANY", **sides)), TROMSO, at(from_at), at(to_at))
            assert found == (TimeSpan(at(from_at), at(to_at)),)


def test_sunset_may_end_what_a_time_began() -> None:
    evening = schedule(entry("MON", startTime="12:00:00Z", endEvent="SS"))
    (found,) = active_spans(evening, COPENHAGEN, at("2026-12-20T00:00"), at("2026-12-24T00:00"))
    assert found.from_s == at("2026-12-21T12:00")
    assert found.to_s == pytest.approx(at("2026-12-21T14:38") + SUN_ALLOWANCE_S, abs=2 * A_MINUTE_S)


def test_zones_of_both_standards(zone_file: Any) -> None:
    timed = [zone for zone in read_zones(zone_file("ed318-collection.json").read_bytes()).zones if zone.schedule is not None]
    box = timed[0].geometry.bounds
    inside = spans(timed[0].schedule, "2026-03-07T00:00", "2026-03-09T12:00", box)  # a Saturday
    assert ("Sat 15:00", "Sat 16:30") in inside
    assert any(start.startswith("Sun 0") and end == "Sun 11:00" for start, end in inside)  # from sunrise on
    assert spans(timed[0].schedule, "2027-03-07T00:00", "2027-03-09T00:00", box) == []

    weekend, nights = (
        next(zone for zone in read_zones(zone_file("ed269-features.json").read_bytes()).zones if zone.identifier == identifier)
        for identifier in ("Elmsgard Concert Meadow", "EL-GT9990")
    )
    assert spans(weekend.schedule, "2026-07-03T00:00", "2026-07-07T00:00", weekend.geometry.bounds) == [
        ("Sat 18:00", "Sun 00:00"), ("Sun 18:00", "Mon 00:00"),
    ]  # fmt: skip
    assert ("Fri 22:00", "Sat 04:00") in spans(nights.schedule, "2026-07-03T12:00", "2026-07-05T12:00", nights.geometry.bounds)


def test_real_zones_of_both_standards(shared_data: Any) -> None:
    collection = read_zones(shared_data("zones/ed318-Example_Collection.json").read_bytes()).zones
    timed = [zone for zone in collection if zone.schedule is not None]
    assert timed
    box = timed[0].geometry.bounds
    inside = spans(timed[0].schedule, "2019-03-02T00:00", "2019-03-04T12:00", box)  # a Saturday
    assert ("Sat 16:00", "Sat 17:00") in inside
    assert spans(timed[0].schedule, "2020-03-02T00:00", "2020-03-09T00:00", box) == []

    swiss = [zone for zone in read_zones(shared_data("zones/switzerland-ed269-test-che-1.json").read_bytes()).zones if zone.schedule]
    weekend = next(zone for zone in swiss if zone.schedule[0]["schedule"])
    assert spans(weekend.schedule, "2022-07-01T00:00", "2022-07-05T00:00", weekend.geometry.bounds) == [
        ("Sat 17:00", "Sun 00:00"), ("Sun 17:00", "Mon 00:00"),
    ]  # fmt: skip


times = st.one_of(st.none(), st.times().map(lambda moment: f"{moment:%H:%M:%S}Z"), st.sampled_from(EVENTS))


@st.composite
def periods(draw: Any) -> Any:
    entries = []
    for _ in range(draw(st.integers(0, 3))):
        sides: dict[str, str] = {}
        for side in ("start", "end"):
            value = draw(times)
            if value is not None:
                sides[f"{side}Event" if value in EVENTS else f"{side}Time"] = value
        entries.append(entry(*draw(st.lists(st.sampled_from(DAYS), min_size=1, max_size=3)), **sides))
    first = draw(st.integers(0, 20))
    bounds = {"startDateTime": f"2026-11-{first + 1:02}T03:00:00Z", "endDateTime": f"2026-11-{first + 9:02}T21:30:00Z"}
    return checked_schedule([{"schedule": entries} | (bounds if draw(st.booleans()) else {})], "x")


boxes = st.tuples(st.floats(-180, 170), st.floats(-80, 75), st.floats(0, 10), st.floats(0, 5)).map(
    lambda box: (box[0], box[1], box[0] + box[2], box[1] + box[3])
)


@given(
    stored=periods(), box=boxes, from_h=st.integers(0, 700), hours=st.integers(1, 80), more=st.floats(0, 7_200), less=st.floats(0, 7_200)
)
def test_spans_stand_apart_in_order_and_more_margin_is_never_less(
    stored: Any, box: Any, from_h: int, hours: int, more: float, less: float
) -> None:
    from_s = at("2026-11-01T00:00") + from_h * 3_600
    to_s = from_s + hours * 3_600
    small, large = sorted((less, more))
    narrow, wide = active_spans(stored, box, from_s, to_s, small), active_spans(stored, box, from_s, to_s, large)
    for found in (narrow, wide):
        assert all(from_s <= span.from_s < span.to_s <= to_s for span in found)
        assert all(before.to_s < after.from_s for before, after in pairwise(found))
    assert all(any(outer.from_s <= span.from_s and span.to_s <= outer.to_s for outer in wide) for span in narrow)


@given(stored=periods(), box=boxes, from_h=st.integers(0, 700), hours=st.integers(2, 60), cut=st.floats(0.1, 0.9))
def test_two_halves_of_a_window_tell_what_the_window_tells(stored: Any, box: Any, from_h: int, hours: int, cut: float) -> None:
    from_s = at("2026-11-01T00:00") + from_h * 3_600
    to_s = from_s + hours * 3_600
    middle = from_s + cut * (to_s - from_s)
    halves = active_spans(stored, box, from_s, middle) + active_spans(stored, box, middle, to_s)
    assert merged(halves) == active_spans(stored, box, from_s, to_s)


@example(stored=schedule(entry("MON", startEvent="SR", endEvent="SR")), box=(0.0, 71.75, 0.0, 76.75), from_h=178, share=(0.0, 0.0))
@example(stored=schedule(entry("MON", startEvent="SR", endTime="09:00:00Z")), box=(0.0, 60.0, 0.0, 76.75), from_h=178, share=(0.0, 0.6))
@given(stored=periods(), box=boxes, from_h=st.integers(0, 700), share=st.tuples(st.floats(0, 1), st.floats(0, 1)))
def test_a_larger_box_is_never_active_for_less(stored: Any, box: Any, from_h: int, share: tuple[float, float]) -> None:
    from_s = at("2026-11-01T00:00") + from_h * 3_600
    to_s = from_s + 48 * 3_600
    west, south, east, north = box
    lon, lat = west + share[0] * (east - west), south + share[1] * (north - south)
    inner = active_spans(stored, (lon, lat, lon, lat), from_s, to_s)
    outer = active_spans(stored, box, from_s, to_s, SUN_ALLOWANCE_S)
    assert all(any(wide.from_s <= span.from_s and span.to_s <= wide.to_s for wide in outer) for span in inner)
