"""Assessments as stored and returned: plain values, with the codes and facts of their sentences."""

from collections.abc import Sequence
from typing import Any

from simulation.assessment.closest_approach import ClosestApproach
from simulation.assessment.flown import FlownPhoto, FlownTrack
from simulation.assessment.following import Error
from simulation.assessment.judging import Assessment, RouteAssessment, TargetAssessment
from simulation.assessment.limits import AssessmentFinding
from simulation.assessment.obstacles import Approach, ZoneApproach

METRE_DIGITS, SECOND_DIGITS, PERCENT_DIGITS, DEGREE_DIGITS, ANGLE_DIGITS = 2, 1, 1, 7, 1
PHOTO_SECOND_DIGITS, PHOTO_DEGREE_DIGITS, PHOTO_ANGLE_DIGITS = 2, 8, 2  # a millimetre and a hundredth of a degree
ANGLES = ("roll_deg", "pitch_deg", "heading_deg")
TRACK_STEP_S = 1.0


def assessment_to_json(assessment: Assessment) -> dict[str, Any]:
    return {
        "level": str(assessment.level),
        "findings": [finding_to_json(finding) for finding in assessment.findings],
        "routes": [_route(route) for route in assessment.routes],
        "meetings": [_closest_approach(closest) for closest in assessment.closest_approaches],
    }


def finding_to_json(finding: AssessmentFinding) -> dict[str, Any]:
    facts = {name: round(value, METRE_DIGITS) if isinstance(value, float) else value for name, value in finding.facts.items()}
    return {"level": str(finding.level), "code": finding.code, "uav": finding.uav, "target": finding.target, "facts": facts}


def track_to_json(tracks: Sequence[FlownTrack]) -> list[dict[str, Any]]:
    """Return one object for each flight, with columns of equal length: one row per second, and the last."""
    return [_track(track) for track in tracks]


def _track(track: FlownTrack) -> dict[str, Any]:
    rows: list[int] = []
    for row, t_s in enumerate(track.t_s.tolist()):
        if not rows or t_s - track.t_s[rows[-1]] >= TRACK_STEP_S - 1e-6 or row == len(track) - 1:
            rows.append(row)
    return {
        "ending": str(track.ending),
        "t_s": _column(track.t_s[rows].tolist(), SECOND_DIGITS),
        "position": [[round(lon, DEGREE_DIGITS), round(lat, DEGREE_DIGITS)] for lon, lat in track.position[rows].tolist()],
        "altitude_amsl_m": _column(track.amsl_m[rows].tolist(), METRE_DIGITS),
        "altitude_relative_m": _column(track.relative_m[rows].tolist(), METRE_DIGITS),
        "battery_percent": _column(track.battery_percent[rows].tolist(), PERCENT_DIGITS),
        "used_wh": _column(track.used_wh[rows].tolist(), METRE_DIGITS),
        **{name: _column(track.attitude_deg[rows, at].tolist(), ANGLE_DIGITS) for at, name in enumerate(ANGLES)},
        "waypoint": [None if waypoint < 0 else waypoint for waypoint in track.waypoint[rows].tolist()],
        "photos": [_photo(photo) for photo in track.photos],
    }


def _photo(photo: FlownPhoto) -> dict[str, Any]:
    return {
        "t_s": round(photo.t_s, PHOTO_SECOND_DIGITS),
        "position": [round(photo.position.lon, PHOTO_DEGREE_DIGITS), round(photo.position.lat, PHOTO_DEGREE_DIGITS)],
        "altitude_amsl_m": round(photo.amsl_m, METRE_DIGITS),
        "altitude_relative_m": round(photo.relative_m, METRE_DIGITS),
        "yaw_deg": round(photo.yaw_deg, PHOTO_ANGLE_DIGITS),
        "pitch_deg": round(photo.pitch_deg, PHOTO_ANGLE_DIGITS),
        "roll_deg": round(photo.roll_deg, PHOTO_ANGLE_DIGITS),
        "waypoint": _waypoint(photo.waypoint),
        "item": photo.item,
        "sequence": photo.sequence,
    }


def _column(values: list[float], digits: int) -> list[float]:
    return [round(value, digits) for value in values]


def _route(route: RouteAssessment) -> dict[str, Any]:
    return {
        "uav": route.uav,
        "name": route.name,
        "level": str(route.level),
        "endings": [None if ending is None else str(ending) for ending in route.endings],
        "across": _error(route.following.across),
        "height": _error(route.following.height),
        "energy": [
            {
                "flight": one.flight + 1,
                "used_wh": _rounded(one.used_wh),
                "left_percent": _rounded(one.left_percent, PERCENT_DIGITS),
                "lowest_percent": _rounded(one.lowest_percent, PERCENT_DIGITS),
            }
            for one in route.energy
        ],
        "used_wh": _rounded(route.used_wh),
        "planned_wh": _rounded(route.planned_wh),
        "reserve_percent": route.reserve_percent,
        "flown_s": _rounded(route.flown_s, SECOND_DIGITS),
        "planned_s": _rounded(route.planned_s, SECOND_DIGITS),
        "zones": [_zone(zone) for zone in route.zones],
        "lowest": _approach(route.lowest),
        "obstacle": _approach(route.obstacle),
        "widest_waypoint_m": _rounded(route.widest_waypoint_m),
        "targets": [_target(target) for target in route.targets],
    }


def _target(target: TargetAssessment) -> dict[str, Any]:
    return {
        "target": target.target,
        "level": str(target.level),
        "is_reached": target.is_reached,
        "closest_m": _rounded(target.closest_m),
        "at_s": _rounded(target.at_s, SECOND_DIGITS),
        "late_s": _rounded(target.late_s, SECOND_DIGITS),
        "held_s": _rounded(target.held_s, SECOND_DIGITS),
        "planned_hold_s": _rounded(target.planned_hold_s, SECOND_DIGITS),
        "battery_percent": _rounded(target.battery_percent, PERCENT_DIGITS),
    }


def _error(error: Error) -> dict[str, float | None]:
    return {"rms_m": _rounded(error.rms_m), "max_m": _rounded(error.max_m)}


def _zone(zone: ZoneApproach) -> dict[str, Any]:
    return {
        "zone": zone.zone, "name": zone.name, "beside_m": _rounded(zone.beside_m), "height_m": _rounded(zone.height_m),
        "at_s": _rounded(zone.t_s, SECOND_DIGITS), "waypoint": _waypoint(zone.waypoint),
    }  # fmt: skip


def _approach(approach: Approach | None) -> dict[str, Any] | None:
    if approach is None:
        return None
    return {
        "away_m": _rounded(approach.away_m),
        "at_s": _rounded(approach.t_s, SECOND_DIGITS),
        "waypoint": _waypoint(approach.waypoint),
        "position": [round(degrees, DEGREE_DIGITS) for degrees in approach.position],
        "is_column": approach.is_column,
    }


def _closest_approach(closest: ClosestApproach) -> dict[str, Any]:
    return {
        "uavs": list(closest.uavs),
        "beside_m": _rounded(closest.beside_m),
        "height_m": _rounded(closest.height_m),
        "at_s": _rounded(closest.t_s, SECOND_DIGITS),
    }


def _waypoint(sequence: int) -> int | None:
    return None if sequence < 0 else sequence


def _rounded(value: float | None, digits: int = METRE_DIGITS) -> float | None:
    return None if value is None else round(value, digits)
