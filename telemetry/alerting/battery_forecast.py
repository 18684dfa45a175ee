"""Battery forecast of a UAV: the flight home, the rest of its route, and the time until the reserve is reached."""

import math
from dataclasses import dataclass

from inspection.geodesy import LonLat
from mavlink.decoding.measurement import Measurement
from telemetry.alerting.consumption import Consumption, DrainState, FlightKind, Wind, east_north_m, kind_of
from telemetry.alerting.detector_input import DetectorInput
from telemetry.alerting.detector_state import position_of
from telemetry.alerting.modes import ModeKind
from telemetry.alerting.route_line import NEAR_VERTEX_M
from telemetry.alerting.surroundings import FlightModel
from telemetry.estimation.report import Report

USUAL_RESERVE_PERCENT = 20.0
USUAL_CRUISE_MPS = 8.0


@dataclass(frozen=True, slots=True)
class BatteryForecast:
    """Percentages are of the full battery. None: unknown.

    home_percent      used by the climb to its RTL height, the straight flight home and the landing there; home_s its duration
    landing_percent   the same to the nearest landing place other than home, landing_m away
    rest_percent      used by the rest of the route, if it flies that
    down_percent      used by a landing at its present position
    reserve_in_s      until the reserve is reached, at the drain of the flight home
    drain_per_s       now, in its present kind of flight
    hold_s            time that it can hold and then still return and land with the reserve
    lands_percent     left after landing as it flies now: by its route, home or here; negative: the battery does not last
    """

    left_percent: float
    reserve_percent: float
    drain_per_s: float
    reserve_in_s: float
    home_percent: float | None = None
    home_s: float | None = None
    landing_percent: float | None = None
    landing_m: float | None = None
    rest_percent: float | None = None
    down_percent: float | None = None
    hold_s: float | None = None
    lands_percent: float | None = None

    def as_json(self, level: str) -> dict[str, float | str | None]:
        """Return the forecast for live pages; times are in the UAV's own seconds."""
        home_s = self.home_s if self.home_s is not None and math.isfinite(self.home_s) else None
        return {
            "level": level,
            "left_percent": round(self.left_percent, 1),
            "reserve_percent": round(self.reserve_percent, 1),
            "home_percent": None if home_s is None or self.home_percent is None else round(self.home_percent, 1),
            "home_s": None if home_s is None else round(home_s),
            "reserve_in_s": round(self.reserve_in_s),
            "hold_s": None if home_s is None or self.hold_s is None else round(self.hold_s),
            "lands_percent": None if self.lands_percent is None else round(self.lands_percent, 1),
        }


def battery_forecast(inputs: DetectorInput, fresh: Report, left_percent: float) -> BatteryForecast:
    """Return the forecast of a UAV in flight with a fresh report. Updates the detector state."""
    reported, model, detector_state = fresh.measurement, inputs.model, inputs.detector_state
    consumption = None if model is None else model.consumption
    if consumption is None:
        consumption = Consumption(USUAL_CRUISE_MPS)
    wind_mps = _wind(reported, consumption)
    kind, airspeed_mps = _flight_now(reported, wind_mps)
    per_s = consumption.percent_per_s(airspeed_mps)
    detector_state.drain.note(fresh.measured_s, left_percent, kind, per_s, inputs.link.clock_rate)
    reserve_percent = USUAL_RESERVE_PERCENT if model is None else model.reserve_percent
    ways = _ReturnEnergy() if model is None else _ways(inputs, model, reported, consumption, wind_mps, position_of(fresh))
    moving_per_s = ways.moving_per_s or consumption.percent_per_s(consumption.cruise_mps) * detector_state.drain.ratio(FlightKind.MOVING)
    rest_percent = None if model is None else _rest_percent(inputs, model, reported, consumption)
    if rest_percent is not None and ways.down_percent is not None and _lands_at_end(inputs):
        rest_percent = min(rest_percent, ways.down_percent)
    spare_percent = None if ways.home_percent is None else max(left_percent - reserve_percent - ways.home_percent, 0.0)
    still_per_s = consumption.percent_per_s(math.hypot(*wind_mps)) * detector_state.drain.ratio(FlightKind.STILL)
    return BatteryForecast(
        left_percent=left_percent,
        reserve_percent=reserve_percent,
        drain_per_s=per_s * detector_state.drain.ratio(kind),
        reserve_in_s=max(left_percent - reserve_percent, 0.0) / max(moving_per_s, 1e-6),
        home_percent=ways.home_percent,
        home_s=ways.home_s,
        landing_percent=ways.landing_percent,
        landing_m=ways.landing_m,
        rest_percent=rest_percent,
        down_percent=ways.down_percent,
        hold_s=None if spare_percent is None else spare_percent / max(still_per_s, 1e-6),
        lands_percent=_lands_percent(inputs, left_percent, rest_percent, ways),
    )


def _lands_percent(inputs: DetectorInput, left_percent: float, rest_percent: float | None, ways: "_ReturnEnergy") -> float | None:
    """Return what is left after landing as it flies now; None if it holds or is flown manually."""
    needs = {ModeKind.RETURN: ways.home_percent, ModeKind.LAND: ways.down_percent}
    need = rest_percent if inputs.flies_mission or inputs.mode is None else needs.get(inputs.mode)
    return None if need is None or not math.isfinite(need) else left_percent - need


def _lands_at_end(inputs: DetectorInput) -> bool:
    place, model = inputs.place, inputs.model
    if place is None or model is None or inputs.detector_state.drain.kind is not FlightKind.STILL:
        return False
    return model.line.length_m - place.along_m <= NEAR_VERTEX_M


@dataclass(frozen=True, slots=True)
class _ReturnEnergy:
    """Values as in BatteryForecast; moving_per_s: drain on the flight home [% per second]."""

    home_percent: float | None = None
    home_s: float | None = None
    moving_per_s: float | None = None
    landing_percent: float | None = None
    landing_m: float | None = None
    down_percent: float | None = None


def _ways(
    inputs: DetectorInput, model: FlightModel, reported: Measurement, consumption: Consumption, wind_mps: Wind, position: LonLat | None
) -> _ReturnEnergy:
    """Return the energy of straight returns from its position; all None without a position."""
    if position is None:
        return _ReturnEnergy()
    height_m, drain, home = reported.altitude_relative_m or 0.0, inputs.detector_state.drain, model.line.vertices[0]
    here = model.line.east_north(position)
    way, own = (home[0] - here[0], home[1] - here[1]), inputs.link.rtl_behaviour
    climb_m = 0.0 if own is None or inputs.mode is ModeKind.LAND else own.level_m(height_m, math.hypot(*way), 0.0) - height_m
    home_s, home_percent, moving_per_s = _way_to(consumption, drain, way, height_m, wind_mps, climb_m=climb_m)
    landings = [(math.hypot(*way), way) for way in (east_north_m(position, point) for point in model.rally_points)]
    landing_m, nearest = min(landings, default=(None, None))
    return _ReturnEnergy(
        home_percent=home_percent,
        home_s=home_s,
        moving_per_s=moving_per_s,
        landing_percent=None if nearest is None else _way_to(consumption, drain, nearest, height_m, wind_mps)[1],
        landing_m=landing_m,
        down_percent=_way_to(consumption, drain, (0.0, 0.0), height_m, wind_mps)[1],
    )


def _way_to(
    consumption: Consumption, drain: DrainState, way: tuple[float, float], height_m: float, wind_mps: Wind, *, climb_m: float = 0.0
) -> tuple[float, float, float]:
    """Return seconds, percent, and percent per second while moving. climb_m: climbed first, and descended in addition at the end."""
    flies_s, sinks_s, air_mps = consumption.way(*way, height_m + climb_m, wind_mps)
    climbs_s = climb_m / consumption.climb_mps
    climbing = consumption.percent_per_s(math.hypot(*wind_mps), consumption.climb_mps) * drain.ratio(FlightKind.CLIMBING)
    moving = consumption.percent_per_s(air_mps) * drain.ratio(FlightKind.MOVING)
    still = consumption.percent_per_s(0.0) * drain.ratio(FlightKind.STILL)
    return climbs_s + flies_s + sinks_s, climbs_s * climbing + flies_s * moving + sinks_s * still, moving


def _rest_percent(inputs: DetectorInput, model: FlightModel, reported: Measurement, consumption: Consumption) -> float | None:
    place = inputs.place
    if not inputs.flies_mission or place is None or model.energy is None:
        return None
    height_m, line, drain = reported.altitude_relative_m, model.line, inputs.detector_state.drain
    climbed = 1.0 if height_m is None else min(max(height_m / max(line.heights_m[0], 1.0), 0.0), 1.0)
    rest = model.energy.rest_at(place, model.energy.used_at(place, climbed))
    if drain.kind is FlightKind.STILL and math.isfinite(holds_s := line.planned_hold_s(place.along_m)):
        rest -= min(max(drain.still_lost, 0.0), holds_s * consumption.percent_per_s(0.0))  # of a planned stay here
    return max(rest, 0.0) * max(drain.ratio(FlightKind.MOVING), 1.0)


def _wind(reported: Measurement, consumption: Consumption) -> Wind:
    if reported.wind_east_mps is None or reported.wind_north_mps is None:
        return consumption.wind_mps
    return reported.wind_east_mps, reported.wind_north_mps


def _flight_now(reported: Measurement, wind_mps: Wind) -> tuple[FlightKind, float]:
    east, north = reported.velocity_east_mps or 0.0, reported.velocity_north_mps or 0.0
    return kind_of(math.hypot(east, north), -(reported.velocity_down_mps or 0.0)), math.hypot(east - wind_mps[0], north - wind_mps[1])
