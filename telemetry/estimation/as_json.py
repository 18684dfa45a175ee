"""An estimate as pages and programs read it."""

from datetime import UTC, datetime
from typing import Any

from telemetry.estimation.estimate import Arrival, Estimate


def estimate_to_json(estimate: Estimate) -> dict[str, Any]:
    """Times as RFC 3339 in UTC, to a tenth of a second; metres and degrees rounded to what they can be worth."""
    bound = estimate.bound
    return {
        "at": _time(estimate.at_s),
        "report_at": _time(estimate.report_s),
        "position": [round(estimate.position.lon, 7), round(estimate.position.lat, 7)],
        "altitude_relative_m": _rounded(estimate.altitude_relative_m),
        "altitude_amsl_m": _rounded(estimate.altitude_amsl_m),
        "speed_mps": round(estimate.speed_mps, 2),
        "heading_deg": _rounded(estimate.heading_deg),
        "bound": {
            "along_m": round(bound.along_m, 1),
            "across_m": round(bound.across_m, 1),
            "bearing_deg": round(bound.bearing_deg, 1) % 360.0,
            "height_m": round(estimate.bound_height_m, 1),
            "speed_mps": round(estimate.bound_speed_mps, 2),
        },
        "is_measured": estimate.is_measured,
        "is_lost": estimate.is_lost,
        "waypoint_sequence": estimate.waypoint_sequence,
        "along_route_m": _rounded(estimate.along_route_m),
        "to_go_m": _rounded(estimate.to_go_m),
        "arrivals": [_arrival(arrival) for arrival in estimate.arrivals],
        "ends_at": _time(estimate.ends_at_s),
        "contact_expected_at": _time(estimate.contact_expected_s),
        "report_interval_s": _rounded(estimate.report_interval_s),
    }


def _arrival(arrival: Arrival) -> dict[str, Any]:
    return {
        "waypoint_sequence": arrival.waypoint_sequence,
        "target": arrival.target,
        "at": _time(arrival.at_s),
        "earliest": _time(arrival.earliest_s),
        "latest": _time(arrival.latest_s),
    }


def _time(at_s: float | None) -> str | None:
    return None if at_s is None else datetime.fromtimestamp(round(at_s, 1), UTC).isoformat(timespec="milliseconds").replace("+00:00", "Z")


def _rounded(value: float | None) -> float | None:
    return None if value is None else round(value, 1)
