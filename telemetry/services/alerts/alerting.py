"""Converts detector detections to alerts, which are opened, raised and closed in bulk."""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import datetime
from typing import Any

from mavlink.autopilot_type import AutopilotType
from telemetry.alerting.conflicts import conflicts, elsewhere, ways_of
from telemetry.alerting.detector_input import DetectorInput, WatchedUav
from telemetry.alerting.detector_state import DetectorState, position_of
from telemetry.alerting.detectors import CODES, DETECTORS, down
from telemetry.alerting.limits import AlertLimits, sound_limits
from telemetry.alerting.state_machine import Closed, Opened, changes
from telemetry.alerting.surroundings import LinkFacts, NearZone, OnboardState
from telemetry.selectors.alert_facts import (
    LoadedFacts,
    closed_by_users,
    estimated_by_other_watches,
    links_of,
    orders_to,
    stated_limits,
    status_texts_of,
)
from telemetry.selectors.alerts import MIXED, OTHER_LIST, OpenRow, open_alerts_of
from telemetry.services.alerts.nearby_zones import ZonesAbout, zones_about
from telemetry.services.alerts.replan_hooks import suggest_for_detections, withdraw_for_closed
from telemetry.services.alerts.rows import close_alerts_of_ended_missions, settle
from telemetry.services.approved_flights import approved_content, flight_model
from telemetry.services.flown import note_down_off_plan
from workspace.live.changes import publish_live

MIN_REACH_M, MAX_SPEED_MPS = 200.0, 40.0  # search distance for zones: at least this, and as far as a UAV flies within the horizon


@dataclass
class DetectorStates:
    """Detector states of this process by UAV. They may be lost: the alerts themselves are rows."""

    of_uav: dict[int, DetectorState] = field(default_factory=lambda: defaultdict(DetectorState))

    def keep_only(self, uav_ids: Iterable[int]) -> None:
        for uav_id in self.of_uav.keys() - set(uav_ids):
            del self.of_uav[uav_id]


_OF_THIS_PROCESS = DetectorStates()


def poll_alerts(
    *, watched: Sequence[WatchedUav], now: datetime, detector_states: DetectorStates | None = None
) -> dict[int, dict[str, Any] | None]:
    """Open, raise and close alerts of this process's UAVs. Called once a second; idempotent.

    Returns the battery forecast of each UAV for live pages (battery_forecast.py).
    """
    detector_states = _OF_THIS_PROCESS if detector_states is None else detector_states
    detector_states.keep_only(uav.uav_id for uav in watched)
    batteries: dict[int, dict[str, Any] | None] = {}
    reported = close_alerts_of_ended_missions(codes={*CODES, OTHER_LIST} - {down.CODE}, but=[uav.uav_id for uav in watched], now=now)
    if watched:
        open_rows = open_alerts_of([uav.uav_id for uav in watched], (*CODES, MIXED))
        levels = {uav_id: {(row.code, row.subject): row.level for row in rows} for uav_id, rows in open_rows.items()}
        situations = _with_accounts(_with_conflicts(list(_situations(watched, now.timestamp(), detector_states, levels))))
        found: list[tuple[WatchedUav, Opened | Closed]] = [
            (inputs.uav, change) for inputs in situations for change in changes(inputs, DETECTORS)
        ]
        in_mission = {inputs.uav.uav_id for inputs in situations if inputs.is_in_flight and inputs.flies_mission}
        reported |= settle(found, open_rows=open_rows, now=now)
        batteries = {inputs.uav.uav_id: inputs.detector_state.battery if inputs.is_in_flight else None for inputs in situations}
        _end_flights(situations)
        suggest_for_detections(
            (uav.mission_id, uav.uav_id, change.detection)
            for uav, change in found
            if isinstance(change, Opened) and _is_new(change, open_rows.get(uav.uav_id, ()))
        )
        withdraw_for_closed(
            (uav.mission_id, uav.uav_id, change) for uav, change in found if isinstance(change, Closed) and uav.uav_id in in_mission
        )
    for organisation_id in reported:
        publish_live(organisation_id)
    return batteries


def _end_flights(situations: Iterable[DetectorInput]) -> None:
    """End the flights of UAVs that are down off plan; each is reported to its mission once."""
    for inputs in situations:
        if not inputs.detector_state.has_ended and down.has_ended(inputs):
            uav = inputs.uav
            note_down_off_plan(uav_id=uav.uav_id, approval_id=uav.approval_id, flight=uav.flight)
            inputs.detector_state.has_ended = True


def _with_accounts(situations: list[DetectorInput]) -> list[DetectorInput]:
    """Mark UAVs that are down where a user has closed the alert, so that they are not reported again."""
    pairs = [(inputs.uav.uav_id, inputs.uav.mission_id) for inputs in situations if down.is_down_away(inputs)]
    known = closed_by_users(pairs, down.CODE) if pairs else set()
    return [
        replace(inputs, is_accounted_for=(inputs.uav.uav_id, inputs.uav.mission_id, str(inputs.uav.flight)) in known)
        for inputs in situations
    ]


def _is_new(change: Opened, rows: Iterable[OpenRow]) -> bool:
    """Return whether the alert is new, worse, or has another message. rows: open alerts of its UAV."""
    detection = change.detection
    row = next((row for row in rows if (row.code, row.subject) == (detection.code, detection.subject)), None)
    return row is None or row.level != detection.level or (row.message != detection.message and not change.is_held)


def _situations(
    watched: Sequence[WatchedUav], now_s: float, detector_states: DetectorStates, levels: Mapping[int, Mapping[tuple[str, str], str]]
) -> Iterator[DetectorInput]:
    flying = [(uav.uav_id, uav.mission_id) for uav in watched]
    links, orders, stated, zones = links_of([uav_id for uav_id, _ in flying]), orders_to(flying), stated_limits(flying), zones_about(now_s)
    status_texts = status_texts_of([uav_id for uav_id, _ in flying], now_s)
    for uav in watched:
        detector_state, model = detector_states.of_uav[uav.uav_id], flight_model(uav.approval_id, uav.uav_id, uav.flight)
        detector_state.take(uav.newest, None if model is None else model.line)
        link, loaded = links.get(uav.uav_id, (LinkFacts(), LoadedFacts()))
        order, is_changing = orders.get(uav.uav_id, (None, False))
        limits = sound_limits(stated[uav.uav_id])
        inputs = DetectorInput(
            now_s=now_s,
            uav=uav,
            limits=limits,
            detector_state=detector_state,
            link=link,
            open_levels=levels.get(uav.uav_id, {}),
            model=model,
            held=_held(uav, loaded, is_changing=is_changing),
            order=order,
            zones=_zones(uav, limits, zones),
            status_texts=status_texts.get(uav.uav_id, ()),
        )
        if model is not None:
            detector_state.note_flight(is_in_flight=inputs.is_in_flight)
        yield inputs


def _with_conflicts(situations: list[DetectorInput]) -> list[DetectorInput]:
    within_s = max(inputs.limits.converging_s for inputs in situations)
    moving = [way for inputs in situations for way in ways_of(inputs, within_s)]
    if not moving:
        return situations
    organisations = {inputs.uav.organisation_id for inputs in situations}
    others = estimated_by_other_watches(organisations, [inputs.uav.uav_id for inputs in situations])
    moving += [
        elsewhere(uav_id, name, organisation_id, estimated, within_s, clock_rate, is_twin=is_twin)
        for organisation_id, of_organisation in others.items()
        for uav_id, name, estimated, clock_rate, is_twin in of_organisation
    ]
    met = conflicts(moving, within_s)
    return [replace(inputs, conflicts=tuple(met[inputs.uav.uav_id])) if inputs.uav.uav_id in met else inputs for inputs in situations]


def _zones(uav: WatchedUav, limits: AlertLimits, zones: ZonesAbout) -> tuple[NearZone, ...]:
    position = None if uav.newest is None else position_of(uav.newest)
    return () if position is None else zones.within(position, max(MIN_REACH_M, MAX_SPEED_MPS * limits.zone_ahead_s))


def _held(uav: WatchedUav, loaded: LoadedFacts, *, is_changing: bool) -> OnboardState:
    if loaded.approval_id is None or loaded.flight is None:
        return OnboardState(doubt=loaded.doubt, is_changing=is_changing)
    content = approved_content(loaded.approval_id, uav.uav_id, loaded.flight)
    is_approved = loaded.approval_id == uav.approval_id and content is not None and content.content_sha256 == loaded.sha256
    return OnboardState(
        approval_id=loaded.approval_id,
        is_approved=is_approved,
        doubt=loaded.doubt,
        is_changing=is_changing,
        items=None if content is None else content.items,
        first_item=1 if loaded.autopilot == AutopilotType.ARDUPILOT else 0,
    )
