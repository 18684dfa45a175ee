"""What is left of the battery is not enough for the rest of the flight, or the vehicle itself says so."""

from telemetry.alerting.detector import Detector
from telemetry.alerting.finding import CRITICAL, WARNING, Finding
from telemetry.alerting.memory import Memory
from telemetry.alerting.route_line import RouteLine
from telemetry.alerting.said import is_worse, words_of_battery
from telemetry.alerting.situation import Situation

CODE = "battery-short"
EXPECTED = "%(uav)s is expected to end its flight with %(percent)s %% of its battery; %(reserve)s %% were to be left."
EMPTY = "The battery of %(uav)s is not enough for its route: it would be empty before the end."
LOW = "%(uav)s has %(percent)s %% of its battery left; its reserve is %(reserve)s %%."
STATED = "%(uav)s itself reports its battery as %(state)s."
SAID = "%(uav)s itself reports its battery as %(state)s: %(words)s"
STATES = {"low": WARNING, "critical": CRITICAL, "emergency": CRITICAL, "failed": CRITICAL, "unhealthy": CRITICAL}
OVERRULES_AFTER_S = 15.0  # a state that is well counts more than words that are so old
CLEARS_ABOVE_PERCENT = 2.0  # of what raises it
LEAST_FLOWN_PERCENT = 6.0  # of the battery by the plan, before what it takes is compared with the plan
READ_WITHIN_PERCENT = 1.0  # of what is reported
RATES = (1.0, 4.0)


def detect(situation: Situation) -> list[Finding] | None:
    """By the vehicle's own word, which may go by voltage while its percentage stays high, and by what is left; the worse of both."""
    stated, expected = _stated(situation), _expected(situation)
    if stated is None or (expected and expected[0].level == CRITICAL):
        return expected
    return [stated]


def _stated(situation: Situation) -> Finding | None:
    state, word = situation.link.battery_state, words_of_battery(situation.said, situation.now_s)
    if word is not None and state == "ok" and situation.now_s - word.at_s > OVERRULES_AFTER_S:
        word = None
    if state not in STATES and word is None:
        return None
    named = state if state in STATES else "critical" if word is not None and is_worse(word) else "low"
    values = {"uav": situation.uav.name, "state": named}
    details = {"charge_state": state, "words": "" if word is None else word.text}
    if word is None:
        return Finding(CODE, STATES[named], STATED, values, details=details)
    level = CRITICAL if is_worse(word) else STATES[named]
    return Finding(CODE, level, SAID, values | {"words": word.text}, details=details)


def _expected(situation: Situation) -> list[Finding] | None:
    fresh, limits = situation.fresh, situation.limits
    left_percent = None if fresh is None else fresh.measurement.battery_percent
    if fresh is None or left_percent is None or situation.has_just_jumped:
        return None
    place, model = situation.place, situation.model
    reserve_percent = 20.0 if model is None else model.reserve_percent
    rate, expected_percent = 1.0, left_percent
    if situation.flies_mission and place is not None and model is not None and model.energy is not None:
        used_percent = model.energy.used_at(place, _climbed_share(model.line, fresh.measurement.altitude_relative_m))
        situation.memory.note_battery(used_percent, left_percent)
        rate = drain_rate(situation.memory, used_percent, left_percent)
        expected_percent = left_percent - rate * model.energy.rest_at(place, used_percent)
    warns_below = max(reserve_percent - limits.battery_margin_percent, limits.battery_critical_percent)
    if expected_percent >= warns_below + (CLEARS_ABOVE_PERCENT if situation.is_open(CODE) else 0.0):
        return []
    level = CRITICAL if expected_percent < limits.battery_critical_percent else WARNING
    words = LOW if expected_percent == left_percent else EXPECTED if expected_percent > 0.0 else EMPTY
    values = {"uav": situation.uav.name}
    if words is not EMPTY:
        values |= {"percent": str(round(expected_percent)), "reserve": str(round(reserve_percent))}
    details = {"left_percent": left_percent, "expected_percent": round(expected_percent, 1), "rate": round(rate, 2)}
    return [Finding(CODE, level, words, values, details=details)]


def _climbed_share(line: RouteLine, height_m: float | None) -> float:
    return 1.0 if height_m is None else min(max(height_m / max(line.heights_m[0], 1.0), 0.0), 1.0)


def drain_rate(memory: Memory, used_percent: float, left_percent: float) -> float:
    """How many times as fast as planned the battery goes down: since the flight began, or of late, whichever is more."""
    rates = [RATES[0]]
    for planned_percent, before_percent in memory.drained:
        planned = used_percent - planned_percent
        if planned >= LEAST_FLOWN_PERCENT:
            rates.append((before_percent - left_percent - READ_WITHIN_PERCENT) / planned)
    return min(max(rates), RATES[1])


DETECTOR = Detector(CODE, detect, raise_after_s=5.0, clear_after_s=15.0)
