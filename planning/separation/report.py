"""How routes are kept apart, in the shape of the API."""

from collections.abc import Mapping, Sequence
from typing import Any

from planning.separation.separation import Encounter, Separation


def separation_json(separation: Separation, untimed: Sequence[tuple[str, str]] = ()) -> dict[str, Any]:
    """As a plan has it. untimed: mission and UAV of flights of which nobody knows when they are where."""
    rules = separation.rules
    return {
        "lateral_m": rules.lateral_m,
        "vertical_m": rules.vertical_m,
        "time_s": rules.time_s,
        "delays": list(separation.delays_s),
        "layers": list(separation.layers_m),
        "closest": None if separation.closest is None else _encounter_json(separation.closest),
        "unresolved": [
            {"code": "hovers_in_the_way" if encounter.blocks else "too_near", **_encounter_json(encounter)}
            for encounter in separation.unresolved
        ]
        + [{"code": "times_not_known", "uavs": [uav], "missions": [mission]} for mission, uav in untimed],
    }


def _encounter_json(encounter: Encounter) -> Mapping[str, Any]:
    return {
        "metres": round(encounter.metres, 1),
        "vertical_m": None if encounter.vertical_m is None else round(encounter.vertical_m, 1),
        "seconds": round(encounter.seconds, 1),
        "uavs": list(encounter.uavs),
        "missions": list(encounter.missions),
        "legs": list(encounter.legs),
        "at_s": [round(moment, 1) for moment in encounter.at_s],
        "position": [round(encounter.position.lon, 7), round(encounter.position.lat, 7)],
    }
