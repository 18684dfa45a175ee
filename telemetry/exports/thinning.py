"""Reduces exported tracks: rounds values to the sensors' resolution and keeps one record per interval."""

import math
from collections.abc import Iterable, Iterator
from dataclasses import replace
from datetime import datetime, timedelta

from telemetry.exports.logged_record import FLAGS, PLACES, REPORTED, LoggedRecord, Value

INTERVAL_S = 1.0
EARLY = 0.25  # of the interval: reports at 1 Hz jitter
POSITION_DIGITS = 7  # degrees, MAVLink's resolution: a centimetre
# Decimal places by unit. MAVLink has heights in mm, speeds in cm/s, headings in 0.01 deg, volts in mV and amperes in cA; the last one or
# two places are sensor noise.
DIGITS = {"_m": 2, "_mps": 2, "_deg": 1, "_percent": 1, "_v": 2, "_a": 2, "hdop": 2}
CHANGES = ("mode", "is_armed", "is_in_air", "mission_item", "waypoint_sequence")  # a record that changes one of these is always kept


def _digits_of(name: str) -> int | None:
    return next((digits for ending, digits in DIGITS.items() if name.endswith(ending)), None)


_DIGITS = tuple(_digits_of(name) for name in (*REPORTED, *FLAGS))
_CHANGES = tuple(PLACES[name] for name in CHANGES)
_HEADING = PLACES["heading_deg"]
_IS_FROM_FUTURE = PLACES["is_from_future"]


def for_files(records: Iterable[LoggedRecord], *, every_s: float = INTERVAL_S) -> Iterator[LoggedRecord]:
    """Return the records rounded, in the same order; one per `every_s` for each stream of a UAV, all with 0."""
    return map(rounded, records if every_s == 0.0 else one_every(records, every_s))


def rounded(record: LoggedRecord) -> LoggedRecord:
    """Return the record with values rounded to the sensors' resolution; never -0."""
    values = [_rounded(value, digits) for value, digits in zip(record.values, _DIGITS, strict=True)]
    heading_deg = values[_HEADING]
    values[_HEADING] = heading_deg % 360.0 if isinstance(heading_deg, float) else heading_deg
    position = record.position and (round(record.position[0], POSITION_DIGITS), round(record.position[1], POSITION_DIGITS))
    return replace(record, values=tuple(values), position=position)


def _rounded(value: Value, digits: int | None) -> Value:
    if digits is None or not isinstance(value, float) or not math.isfinite(value):
        return value
    return round(value, digits) + 0.0


def one_every(records: Iterable[LoggedRecord], every_s: float) -> Iterator[LoggedRecord]:
    """Yield for each stream of a UAV one record per interval, and each record that changes its mode, state or waypoint.

    The records of a stream are sorted by time of measurement. Records from the future are all kept, as their time is unreliable.
    """
    interval, early = timedelta(seconds=every_s), timedelta(seconds=every_s * EARLY)
    due: dict[tuple[int, str], datetime] = {}
    state: dict[tuple[int, str], tuple[Value, ...]] = {}
    for record in records:
        if record.values[_IS_FROM_FUTURE]:
            yield record
            continue
        stream, at = (record.uav, record.stream), record.measured_at
        own_due, own_state = due.get(stream, at), tuple(record.values[place] for place in _CHANGES)
        is_due = at >= own_due - early or at < own_due - 2 * interval  # a clock that was set back restarts the interval
        if is_due:
            due[stream] = own_due + interval if own_due - early <= at < own_due + interval else at + interval
        if is_due or own_state != state[stream]:
            yield record
        state[stream] = own_state
