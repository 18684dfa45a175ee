"""Detects that the battery reaches the reserve or the energy needed to return, or that the vehicle reports it low."""

import math
from dataclasses import dataclass
from typing import Any

from telemetry.alerting.advice import (
    COMES_DOWN_LOW,
    FALLS_SHORT,
    LOW_RETURN,
    NO_HEADWAY,
    NO_RETURN,
    TIGHT_RETURN,
    TO_LANDING_PLACE,
    UNKNOWN_RETURN,
    advice,
    own_act,
)
from telemetry.alerting.battery_forecast import BatteryForecast, battery_forecast
from telemetry.alerting.detection import ACTS, CRITICAL, LAND, RANK, RETURN, WARNING, Detection, acts
from telemetry.alerting.detector import Detector
from telemetry.alerting.detector_input import DetectorInput
from telemetry.alerting.modes import ModeKind
from telemetry.alerting.status_texts import is_worse, newest_battery_text

CODE = "battery-short"
TURN_BACK = "%(uav)s: battery %(percent)s %%, just enough to return (%(home)s %%) with the reserve of %(reserve)s %%."
EXPECTED = "%(uav)s is expected to land with %(percent)s %% of its battery (reserve %(reserve)s %%)."
EMPTY = "The battery of %(uav)s is not enough for its route: it would be empty before the end."
BELOW = "%(uav)s: battery %(percent)s %%, below the reserve of %(reserve)s %%."
SOON = "%(uav)s: battery %(percent)s %%, below the reserve of %(reserve)s %% within a minute."
NO_WAY_HOME = "%(uav)s: battery %(percent)s %%, not enough to return (%(home)s %%)."
TIGHT = "%(uav)s: battery %(percent)s %%, after a return (%(home)s %%) hardly any would be left."
NO_WAY_BUT_LANDING = (
    "%(uav)s: battery %(percent)s %%, not enough to return home (%(home)s %%). The landing place %(metres)s m away is in reach."
)
STATED = "%(uav)s itself reports its battery as %(state)s."
STATED_AS = "%(uav)s itself reports its battery as %(state)s: %(words)s"
STATES = {"low": WARNING, "critical": CRITICAL, "emergency": CRITICAL, "failed": CRITICAL, "unhealthy": CRITICAL}
OVERRULES_AFTER_S = 15.0  # a good state overrides status texts older than this
CLEARS_ABOVE_PERCENT = 2.0  # above the threshold that raises it
AHEAD_S = 45.0  # forecast horizon for a UAV still above its reserve


@dataclass(frozen=True, slots=True)
class _Judged:
    level: str
    message: str
    percent: float = 0.0
    is_route_short: bool = False


def detect(inputs: DetectorInput) -> list[Detection] | None:
    """Return the worse of two detections: by the vehicle's own report, which may rest on voltage, and by the percentage left."""
    newest = inputs.uav.newest
    inputs.detector_state.note_mode(inputs.mode, inputs.now_s if newest is None else newest.measured_s)
    forecast = _forecast(inputs)
    expected = None if forecast is None else _expected(inputs, forecast)
    stated = _stated(inputs)
    inputs.detector_state.battery = None if forecast is None else forecast.as_json(expected[0].level if expected else "")
    if stated is None or (expected and RANK[expected[0].level] >= RANK[stated.level]):
        return expected
    return [Detection(CODE, stated.level, stated.message, stated.values, details=stated.details | _answer(inputs, forecast))]


def _forecast(inputs: DetectorInput) -> BatteryForecast | None:
    fresh = inputs.fresh
    left_percent = None if fresh is None else fresh.measurement.battery_percent
    if fresh is None or left_percent is None or inputs.has_just_jumped:
        return None
    return battery_forecast(inputs, fresh, left_percent)


def _stated(inputs: DetectorInput) -> Detection | None:
    state, text = inputs.link.battery_state, newest_battery_text(inputs.status_texts, inputs.now_s)
    if text is not None and state == "ok" and inputs.now_s - text.at_s > OVERRULES_AFTER_S:
        text = None
    if state not in STATES and text is None:
        return None
    named = state if state in STATES else "critical" if text is not None and is_worse(text) else "low"
    values = {"uav": inputs.uav.name, "state": named}
    details = {"charge_state": state, "words": "" if text is None else text.text}
    if text is None:
        return Detection(CODE, STATES[named], STATED, values, details=details)
    level = CRITICAL if is_worse(text) else STATES[named]
    return Detection(CODE, level, STATED_AS, values | {"words": text.text}, details=details)


def _expected(inputs: DetectorInput, forecast: BatteryForecast) -> list[Detection]:
    judged = _judged(inputs, forecast)
    if judged is None:
        return []
    values: dict[str, object] = {"uav": inputs.uav.name}
    if judged.message is not EMPTY:
        values["percent"] = str(round(judged.percent if judged.message is EXPECTED else forecast.left_percent))
    if judged.message not in (EMPTY, TIGHT, NO_WAY_HOME, NO_WAY_BUT_LANDING):
        values["reserve"] = str(round(forecast.reserve_percent))
    if judged.message in (TURN_BACK, TIGHT, NO_WAY_HOME, NO_WAY_BUT_LANDING):
        values["home"] = _share(forecast.home_percent)
    if judged.message is NO_WAY_BUT_LANDING:
        values["metres"] = round(forecast.landing_m or 0.0)
    details = {
        **forecast.as_json(judged.level),
        **_answer(inputs, forecast),
        "expected_percent": round(judged.percent, 1),
        "rate": round(inputs.detector_state.drain.ratio(inputs.detector_state.drain.kind), 2),
        "route_short": judged.is_route_short,
    }
    return [Detection(CODE, judged.level, judged.message, values, details=details, severity=-forecast.left_percent)]


def _judged(inputs: DetectorInput, forecast: BatteryForecast) -> _Judged | None:
    """Return the worst detection by the forecast. An open alert stays until all values are CLEARS_ABOVE_PERCENT above the thresholds."""
    worst = _worst(inputs, forecast, 0.0)
    if worst is not None or not inputs.is_open(CODE):
        return worst
    nearly = _worst(inputs, forecast, CLEARS_ABOVE_PERCENT)
    if nearly is None or nearly.message in (TURN_BACK, EXPECTED):
        return nearly
    return _Judged(WARNING, EXPECTED, max(_ends(forecast), default=forecast.left_percent))


def _ends(forecast: BatteryForecast) -> list[float]:
    """Return the percentage left after landing at home, and after the rest of the route."""
    return [forecast.left_percent - need for need in (forecast.home_percent, forecast.rest_percent) if need is not None]


def _worst(inputs: DetectorInput, forecast: BatteryForecast, more: float) -> _Judged | None:
    """more: percent added to all limits."""
    limits, left, reserve, rest = inputs.limits, forecast.left_percent, forecast.reserve_percent + more, forecast.rest_percent
    floor, at_home = limits.battery_critical_percent + more, None if forecast.home_percent is None else left - forecast.home_percent
    best = max(_ends(forecast), default=left)
    if left < reserve:
        return _Judged(CRITICAL, BELOW, left)
    if _falls_soon(inputs, forecast, reserve):
        return _Judged(CRITICAL, SOON, left)
    if best < floor:
        if at_home is not None and at_home >= more:
            return _Judged(CRITICAL, TIGHT, best, is_route_short=True)
        is_reachable = forecast.landing_percent is not None and left - forecast.landing_percent >= floor
        return _Judged(CRITICAL, NO_WAY_BUT_LANDING if is_reachable else NO_WAY_HOME, best, is_route_short=True)
    margin, is_short = limits.battery_margin_percent, rest is not None and left - rest < floor
    if rest is not None and left - rest < max(reserve - margin, floor):
        if at_home is not None and at_home <= reserve:
            return _Judged(WARNING, TURN_BACK, at_home, is_short)
        return _Judged(WARNING, EMPTY if left - rest <= 0.0 else EXPECTED, left - rest, is_short)
    comes_down = inputs.mode in (ModeKind.RETURN, ModeKind.LAND)
    if rest is None and at_home is not None and at_home < reserve - (margin if comes_down else 0.0):
        return _Judged(WARNING, EXPECTED if comes_down else TURN_BACK, at_home)
    return None


def _falls_soon(inputs: DetectorInput, forecast: BatteryForecast, below_percent: float) -> bool:
    """Return whether the battery falls below a percentage within AHEAD_S, or before landing if it comes down earlier by its mode."""
    down = {ModeKind.RETURN: forecast.home_percent, ModeKind.LAND: forecast.down_percent}
    need = forecast.rest_percent if forecast.rest_percent is not None or inputs.mode is None else down.get(inputs.mode)
    drained = forecast.drain_per_s * AHEAD_S
    return forecast.left_percent - (drained if need is None else min(drained, need)) < below_percent


def _answer(inputs: DetectorInput, forecast: BatteryForecast | None) -> dict[str, Any]:
    """Return the acts for an operator, their cost, and what the UAV does by itself, in the form of an alert's details."""
    mode, uav_id = inputs.mode, inputs.uav.uav_id
    floor_percent = inputs.limits.battery_critical_percent
    own = {} if inputs.ends_as_planned else own_act(mode, inputs.detector_state.mode_since_s, inputs.order)
    if mode is ModeKind.LAND:
        return {ACTS: [], **own}
    if mode is ModeKind.RETURN:
        best = None if forecast is None else _best_landing(forecast)
        may_fall_short = best is None or best < floor_percent
        return {ACTS: acts(LAND, uav_id=uav_id) if may_fall_short else [], **own, **_advice_of_return(forecast)}
    kinds, status_texts = _ways_down(forecast, floor_percent)
    return {ACTS: acts(*kinds, uav_id=uav_id), **status_texts}


def _best_landing(forecast: BatteryForecast) -> float | None:
    """Return the percentage left after a return home or to the nearest landing place, whichever is more; None if both are unknown."""
    needs = [need for need in (forecast.home_percent, forecast.landing_percent) if need is not None]
    return forecast.left_percent - min(needs) if needs else None


def _advice_of_return(forecast: BatteryForecast | None) -> dict[str, Any]:
    """Return advice for a UAV that already returns."""
    best = None if forecast is None else _best_landing(forecast)
    if forecast is None or best is None:
        return {}
    if best < 0.0:
        return advice(FALLS_SHORT, home=_share(forecast.home_percent), percent=_whole(forecast.left_percent))
    return advice(COMES_DOWN_LOW, landing=_whole(best), reserve=_whole(forecast.reserve_percent))


def _ways_down(forecast: BatteryForecast | None, floor_percent: float) -> tuple[tuple[str, ...], dict[str, Any]]:
    """Return the acts for a UAV that flies on, the best first, and their advice.

    Preferred is home, then the nearest landing place, which a return also leads to, then the ground below. A return that leaves less than
    floor_percent is offered together with landing here.
    """
    best = None if forecast is None else _best_landing(forecast)
    if forecast is None or best is None:
        return (RETURN,), advice(UNKNOWN_RETURN)
    left, home, landing = forecast.left_percent, forecast.home_percent, forecast.landing_percent
    if home is not None and left - home >= forecast.reserve_percent:
        return (RETURN,), {}
    if home is not None and left - home >= floor_percent:
        return (RETURN,), advice(LOW_RETURN, landing=_whole(left - home), reserve=_whole(forecast.reserve_percent))
    if landing is not None and left - landing >= floor_percent:
        metres = round(forecast.landing_m or 0.0)
        return (RETURN,), advice(TO_LANDING_PLACE, metres=metres, landing=_whole(left - landing), home=_share(home))
    if best >= 0.0:
        return (RETURN, LAND), advice(TIGHT_RETURN, landing=_whole(best))
    if home is not None and not math.isfinite(home):
        return (LAND,), advice(NO_HEADWAY)
    return (LAND,), advice(NO_RETURN, home=_share(home), percent=_whole(left))


def _whole(percent: float) -> str:
    return str(round(percent))


def _share(percent: float | None) -> str:
    return "–" if percent is None or percent > 100.0 else str(round(percent))


DETECTOR = Detector(CODE, detect, raise_after_s=5.0, clear_after_s=15.0)
