"""What has changed in UAVs since a mission copied their values: batteries, speeds, sensors, and whether they fly at all."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any
from uuid import UUID

from django.db.models import QuerySet
from django.utils.translation import gettext as _

from missions.models import InspectionTarget, Mission, MissionState, MissionUav, Uav, UavState
from missions.selectors.fleet import FIGURES, figures_of
from planning.energy.performance import PERFORMANCE_KEYS, InvalidPerformance, performance_from_json, performance_to_json
from workspace.locale_negotiation import number_text

TO_BE_FLOWN = (MissionState.PLANNED, MissionState.APPROVED, MissionState.DISPATCHED, MissionState.ACTIVE)
LEFT_OUT = {"uav_out_of_service", "uav_incomplete"}  # the plan's own warnings: it does not use the UAV
# numbers of decimals, fewest first: the first that shows two values as different is used
DECIMALS = {"mass_kg": 3, "rotor_disk_m2": 3}
MAX_DECIMALS = 6

_COLUMNS = (
    "mission", "sequence", "name", "uav", "max_range_m", "cruise_speed_mps", "performance", "sensors", "own_figures", "fleet_figures",
    "mission__state", "mission__plan_warnings",
)  # fmt: skip


@dataclass(frozen=True)
class FigureChange:
    """A changed value by its API name: as the mission has it, and as it is now."""

    name: str
    kept: Any
    now: Any


@dataclass(frozen=True)
class SaidFigure:
    """A value set in the mission itself whose fleet value has changed since: as set, the fleet's then, the fleet's now."""

    name: str
    said: Any
    then: Any
    now: Any


@dataclass(frozen=True)
class UavChange:
    """A UAV that differs from the mission's copy. `uav` is its place in the mission, `uav_id` its key.

    The plan still uses values set in the mission itself, `said`.

    Sensors count where a target needs one of them. `state` is the current one where the plan expects another; `fault` explains why its
    current values cannot be flown with.
    """

    uav: int
    uav_id: int
    name: str
    figures: tuple[FigureChange, ...]
    state: UavState | None = None
    fault: str = ""
    said: tuple[SaidFigure, ...] = ()

    @property
    def concerns_plan(self) -> bool:
        return bool(self.figures or self.state is not None or self.fault)


def uav_changes(mission: UUID) -> list[UavChange]:
    """Return the changes of a mission that is being made or is still to be flown, in the order of its UAVs."""
    return _changes(Mission.objects.filter(pk=mission, state__in=(MissionState.DRAFT, *TO_BE_FLOWN))).get(mission, [])


def missions_with_other_uavs(missions: QuerySet[Mission] | Iterable[Mission]) -> frozenset[UUID]:
    """Return those of the missions whose plan is still to be flown and uses outdated UAV values."""
    pks: Iterable[UUID] = missions.values_list("pk", flat=True) if isinstance(missions, QuerySet) else [mission.pk for mission in missions]
    changes = _changes(Mission.objects.filter(pk__in=pks, state__in=TO_BE_FLOWN))
    return frozenset(pk for pk, own in changes.items() if any(change.concerns_plan for change in own))


def uav_change_words(change: UavChange) -> str:
    """Return a text such as "Kite: battery 56.6 → 40 Wh, in maintenance." in the reader's language."""
    reported = [_figure_words(figure) for figure in change.figures]
    if change.state is not None:
        reported.append(_state_words()[change.state])
    if change.fault:
        reported.append(_("its present figures cannot be flown with"))
    reported += [_("%(change)s in the fleet, but not in this mission") % {"change": _figure_words(figure)} for figure in of_fleet(change)]
    return f"{change.name}: {', '.join(reported)}."


def uav_change_json(change: UavChange) -> dict[str, Any]:
    return {
        "uav": change.uav,
        "id": change.uav_id,
        "name": change.name,
        "figures": [{"name": figure.name, "kept": figure.kept, "now": figure.now} for figure in change.figures],
        "state": change.state,
        "said": [{"name": one.name, "said": one.said, "then": one.then, "now": one.now} for one in change.said],
        "message": uav_change_words(change),
    }


def _changes(missions: QuerySet[Mission]) -> dict[UUID, list[UavChange]]:
    rows = list(MissionUav.objects.filter(mission__in=missions).exclude(uav=None).order_by("mission", "sequence").values(*_COLUMNS))
    if not rows:
        return {}
    uavs = Uav.objects.select_related("uav_type").in_bulk({row["uav"] for row in rows})
    present = {pk: _present_figures(uav) for pk, uav in uavs.items()}
    needed: dict[UUID, set[str]] | None = None
    found: dict[UUID, list[UavChange]] = {}
    for row in rows:
        now, fault = present[row["uav"]]
        kept = _kept_figures(row)
        names = [name for name in FIGURES if now is not None and name not in row["own_figures"] and not _is_same(kept[name], now[name])]
        if now is not None and "sensors" in names:
            needed = _sensors_needed(missions) if needed is None else needed
            count = needed.get(row["mission"], set())
            if _those_of(count, kept["sensors"]) == _those_of(count, now["sensors"]):
                names.remove("sensors")
        state = _unexpected_state(row, uavs[row["uav"]])
        figures = () if now is None else tuple(FigureChange(name, kept[name], now[name]) for name in names)
        change = UavChange(row["sequence"], row["uav"], row["name"], figures, state, fault, _said(row, kept, now))
        if change.concerns_plan or change.said:
            found.setdefault(row["mission"], []).append(change)
    return found


def of_fleet(change: UavChange) -> list[FigureChange]:
    """Return the changed fleet values of what the mission sets itself."""
    return [FigureChange(one.name, one.then, one.now) for one in change.said]


def _said(row: dict[str, Any], kept: dict[str, Any], now: dict[str, Any] | None) -> tuple[SaidFigure, ...]:
    """Return values set in the mission whose fleet value changed since and differs from the mission's."""
    then = {name: value for name, value in row["fleet_figures"].items() if name in row["own_figures"]}
    if now is None:
        return ()
    return tuple(
        SaidFigure(name, kept[name], value, now[name])
        for name, value in then.items()
        if not _is_same(value, now[name]) and not _is_same(kept[name], now[name])
    )


def _present_figures(uav: Uav) -> tuple[dict[str, Any] | None, str]:
    try:
        return figures_of(uav), ""
    except InvalidPerformance as error:
        return None, str(error)


def _kept_figures(row: dict[str, Any]) -> dict[str, Any]:
    return {name: row[name] for name in FIGURES if name not in PERFORMANCE_KEYS} | performance_to_json(
        performance_from_json(row["performance"])
    )


def _is_same(kept: Any, now: Any) -> bool:
    return set(kept) == set(now) if isinstance(kept, list) else kept == now


def _those_of(needed: set[str], sensors: list[str]) -> set[str]:
    return needed & {sensor.strip().casefold() for sensor in sensors}


def _sensors_needed(missions: QuerySet[Mission]) -> dict[UUID, set[str]]:
    needed: dict[UUID, set[str]] = {}
    targets = InspectionTarget.objects.filter(mission__in=missions).exclude(sensor="").order_by()
    for mission, sensor in targets.values_list("mission", "sensor").distinct():
        needed.setdefault(mission, set()).add(sensor.strip().casefold())
    return needed


def _unexpected_state(row: dict[str, Any], uav: Uav) -> UavState | None:
    """Return the UAV's state if a plan uses it although it is not active, or excludes it although it can fly again; else None."""
    state = UavState(uav.state)
    if row["mission__state"] == MissionState.DRAFT or (state == UavState.ACTIVE and uav.missing):
        return None
    is_left_out = any(warning["code"] in LEFT_OUT and warning["uav"] == row["sequence"] for warning in row["mission__plan_warnings"])
    return state if is_left_out == (state == UavState.ACTIVE) else None


def _state_words() -> dict[UavState, str]:
    return {
        UavState.ACTIVE: _("flies again, and the plan leaves it on the ground"),
        UavState.MAINTENANCE: _("is in maintenance"),
        UavState.RETIRED: _("is retired"),
    }


def _figure_words(change: FigureChange) -> str:
    if change.name == "sensors":
        return _("sensors %(kept)s → %(now)s") % {"kept": _list(change.kept), "now": _list(change.now)}
    words, unit, scale, nothing = {
        "max_range_m": (_("range"), "km", 1000.0, _("not stated")),
        "cruise_speed_mps": (_("speed"), "m/s", 1.0, ""),
        "battery_wh": (_("battery"), "Wh", 1.0, _("not counted")),
        "mass_kg": (_("mass"), "kg", 1.0, ""),
        "reserve_percent": (_("reserve"), "%", 1.0, ""),
        "max_airspeed_mps": (_("highest airspeed"), "m/s", 1.0, _("not stated")),
        "rotor_disk_m2": (_("rotor area"), "m²", 1.0, ""),
        "hover_power_w": (_("power in the hover"), "W", 1.0, _("worked out")),
    }[change.name]
    kept, now = _distinguished(_scaled(change.kept, scale), _scaled(change.now, scale), DECIMALS.get(change.name, 1))
    return f"{words} {kept or nothing} → {now or nothing}{f' {unit}' if now else ''}"


def _scaled(value: Any, scale: float) -> float | None:
    return None if value is None else value / scale


def _distinguished(kept: float | None, now: float | None, decimals: int) -> tuple[str, str]:
    texts = tuple("" if value is None else _number(value, decimals) for value in (kept, now))
    if texts[0] == texts[1] and decimals < MAX_DECIMALS and kept is not None and now is not None:
        return _distinguished(kept, now, decimals + 1)
    return texts[0], texts[1]


def _number(value: float, decimals: int) -> str:
    rounded = round(value, decimals)
    return number_text(rounded, len(f"{rounded:.{decimals}f}".rstrip("0").partition(".")[2]))


def _list(sensors: list[str]) -> str:
    return ", ".join(sensors) or _("none")
