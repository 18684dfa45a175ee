"""What an offer would change against what flies now, in the shape of the API.

    {
      "computed_at", "valid_until":  RFC 3339; later the offer is outdated,
      "departs_at":  when the continued routes are estimated to begin, RFC 3339,
      "uavs": [                     each UAV of the flying mission that has something left, in the order of their places
        {
          "uav": key of the UAV or null, "place": its place in the flying mission (0 = A), "name",
          "change": "untouched" (flies on as approved) | "changed" (is held, gets another route, goes on) |
                    "recalled" (returns: nothing is left for it, or it cannot go on) | "out" (dropped out before),
          "why":    text: why it is out, must change, or can only go on as it does; may be empty,
          "reasons": the same as codes and params,
          "kept", "lost", "gained":   targets by their places in the flying mission,
          "order":  targets that it flies to from now on, in their order,
          "before": {"length_m", "duration_s", "ends_at", "battery_percent"} or null: from here on, as approved,
          "after":  the same of the offer; null: it has no route any more.
                    battery_percent is what is left at the end, null without a battery; ends_at is the landing
                    (or the last target, for one that hovers there), null where the UAV's position is unknown,
          "continuation_place": its place in the continuing mission, null where it is not in it
        }],
      "targets": [                  those that move to another UAV or are not reached, in the order of their places
        {"target": place in the flying mission, "label", "from": place of a UAV or null, "to": place of a UAV or null,
         "reason": code, "message": text}      reason and message are empty where a UAV takes it
      ],
      "unreached": how many no UAV can take,
      "total": {"length_m_before", "length_m_after", "ends_at_before", "ends_at_after"}   of all UAVs that go on
    }

The continued routes themselves are the plan of the mission that the offer names as its `continuation`.
"""

from collections.abc import Sequence
from datetime import datetime, timedelta
from itertools import pairwise
from typing import Any

from missions.services.replanning.proposals import Proposal
from missions.services.replanning.rest import Rest, distance_apart_m
from operation.reasons import english
from planning.request import moment_to_json


def difference_of(proposal: Proposal, *, now: datetime, valid_until: datetime) -> dict[str, Any]:
    """Return the difference in the shape that the module describes."""
    field = proposal.field
    rests = sorted(field.rests, key=lambda rest: rest.place)
    uavs = [_uav(proposal, rest, now) for rest in rests]
    going_on = [uav for uav in uavs if uav["change"] in ("untouched", "changed")]
    return {
        "computed_at": moment_to_json(now),
        "valid_until": moment_to_json(valid_until),
        "departs_at": moment_to_json(field.departs_at),
        "uavs": uavs,
        "targets": _targets(proposal, rests, uavs),
        "unreached": len(proposal.unreached),
        "total": {
            "length_m_before": _sum(going_on, "before"),
            "length_m_after": _sum(going_on, "after"),
            "ends_at_before": _latest(going_on, "before"),
            "ends_at_after": _latest(going_on, "after"),
        },
    }


def _uav(proposal: Proposal, rest: Rest, now: datetime) -> dict[str, Any]:
    field, place = proposal.field, rest.place
    continued = proposal.continued.get(place)
    change = "out" if rest.is_out else "recalled" if place in proposal.recalled else "untouched" if continued is None else "changed"
    why = [rest.trouble] if rest.is_out and rest.trouble else field.why(place)
    order = continued.order if continued is not None else rest.ahead if change == "untouched" else ()
    before = _before(rest, now)
    if continued is not None:
        route = continued.route
        battery = None if route.timing is None else route.timing.end_percent
        after: dict[str, Any] | None = _figures(route.length_m, route.duration_s, field.departs_at, battery)
    else:
        after = before if change == "untouched" else None
    return {
        "uav": rest.route.mission_uav.uav_id,
        "place": place,
        "name": rest.name,
        "change": change,
        "why": english(why, "\n"),
        "reasons": [reason.to_json() for reason in why],
        "kept": [target for target in order if target in rest.ahead],
        "lost": [target for target in rest.ahead if target not in order],
        "gained": [target for target in order if target not in rest.ahead],
        "order": list(order),
        "before": before,
        "after": after,
        "continuation_place": sorted(proposal.continued).index(place) if continued is not None else None,
    }


def _before(rest: Rest, now: datetime) -> dict[str, Any] | None:
    if rest.here is None or rest.is_out:
        return None
    ahead = [rest.here.position, *(point.position for point in rest.points[rest.here.ahead :])]
    length_m = sum(distance_apart_m(one, other) for one, other in pairwise(ahead))
    duration_s = max(rest.route.departs_s + rest.route.duration_s - rest.here.at_s(rest.points), 0.0)
    planned = [row.battery_left_percent for row in rest.rows]
    battery = None
    if rest.battery_percent is not None and rest.route.battery_percent is not None:
        here = rest.here.between(planned[rest.here.ahead - 1] or 0.0, planned[rest.here.ahead] or 0.0)
        battery = rest.battery_percent - (here - rest.route.battery_percent)
    return _figures(length_m, duration_s, now, battery)


def _figures(length_m: float, duration_s: float, begins_at: datetime, battery_percent: float | None) -> dict[str, Any]:
    return {
        "length_m": round(length_m, 1),
        "duration_s": round(duration_s, 1),
        "ends_at": moment_to_json(begins_at + timedelta(seconds=round(duration_s))),
        "battery_percent": None if battery_percent is None else round(battery_percent, 1),
    }


def _targets(proposal: Proposal, rests: Sequence[Rest], uavs: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    labels = {target.sequence: target.label for target in proposal.field.mission.targets.all()}
    before = {target: rest.place for rest in rests for target in rest.ahead}
    after = {target: uav["place"] for uav in uavs for target in uav["order"]}
    found = []
    for target in sorted({*before, *after}):
        reason, words, why = ("", "", []) if target in after else proposal.unreached.get(target, ("", "", []))
        if before.get(target) != after.get(target):
            entry = {"target": target, "label": labels[target], "from": before.get(target), "to": after.get(target)}
            found.append({**entry, "reason": reason, "message": words, "why": why})
    return found


def _sum(uavs: Sequence[dict[str, Any]], side: str) -> float:
    return round(sum(uav[side]["length_m"] for uav in uavs if uav[side] is not None), 1)


def _latest(uavs: Sequence[dict[str, Any]], side: str) -> str | None:
    return max((uav[side]["ends_at"] for uav in uavs if uav[side] is not None), default=None)
