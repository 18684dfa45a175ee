"""A UAV that a browser test flies: it speaks to the installation over the HTTP link, as a companion computer does."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from itertools import pairwise
from typing import Any

from examples.companion.link import HttpLink

METRES_A_DEGREE = 111_195.0


def _apart_m(one: Sequence[float], other: Sequence[float]) -> tuple[float, float]:
    """East and north."""
    shrink = math.cos(math.radians(one[1]))
    return (other[0] - one[0]) * METRES_A_DEGREE * shrink, (other[1] - one[1]) * METRES_A_DEGREE


@dataclass
class Flyer:
    """`obeys` takes what it is sent and tells that it is done; `reports` tells where it is, by metres along its route."""

    link: HttpLink
    content: dict[str, Any] | None = None
    reported: list[str] = field(default_factory=list)
    sequence: int = 0

    def obeys(self) -> list[str]:
        """Kinds of the commands that came."""
        given = self.link.ask("GET", "route").body
        if not given:
            return []
        done, kinds = [], []
        if given["route"] and self.content is None:
            self.content = given["route"]["content"]
            done.append({"command": given["route"]["command"], "state": "applied", "content_sha256": given["route"]["content_sha256"]})
        for command in given["commands"]:
            kinds.append(command["kind"])
            if command["kind"] != "upload-mission":
                done.append({"command": command["id"], "state": "applied"})
        if done:
            answer = self.link.ask("POST", "acknowledgements", {"acknowledgements": done})
            assert answer.status == 200, answer
        self.reported += kinds
        return kinds

    def reports(self, along_m: float, *, aside_m: float = 0.0, **reported: Any) -> list[float]:
        """aside_m to the right of the route. Where it says that it is."""
        assert self.content is not None
        position, heading_deg, waypoint = self._place(along_m, aside_m)
        height_m = self.content["waypoints"][waypoint]["altitude_relative_m"]
        self._reports({
            "position": position, "altitude_relative_m": height_m,
            "velocity_north_mps": 9.0 * math.cos(math.radians(heading_deg)), "velocity_east_mps": 9.0 * math.sin(math.radians(heading_deg)),
            "heading_deg": heading_deg, "battery_percent": 71.0, "mode": "Mission", "is_armed": True, "is_in_air": True,
            "gps_fix": 3, "satellites": 14, "hdop": 0.8, "waypoint_sequence": waypoint,
        } | reported)  # fmt: skip
        return position

    def stands(self, position: Sequence[float]) -> None:
        """On the ground, with or without a route."""
        self._reports({
            "position": list(position), "altitude_relative_m": 0.0, "battery_percent": 97.0, "mode": "Standby", "is_armed": False,
            "is_in_air": False, "gps_fix": 3,
        })  # fmt: skip

    def _reports(self, values: dict[str, Any]) -> None:
        self.sequence += 1
        record = {"sequence": self.sequence, "measured_at": datetime.now(UTC).isoformat()} | values
        answer = self.link.ask("POST", "telemetry", {"stream": "boot-1", "records": [record]})
        assert answer.status == 200 and answer.body["stored"] == 1, answer

    def _place(self, along_m: float, aside_m: float) -> tuple[list[float], float, int]:
        assert self.content is not None
        points = [waypoint["position"] for waypoint in self.content["waypoints"]]
        left_m = along_m
        for number, (start, end) in enumerate(pairwise(points), 1):
            east_m, north_m = _apart_m(start, end)
            length_m = math.hypot(east_m, north_m)
            if left_m <= length_m and length_m > 0:
                share = left_m / length_m
                heading = math.atan2(east_m, north_m)
                shrink = math.cos(math.radians(start[1]))
                longitude = start[0] + (end[0] - start[0]) * share + aside_m * math.cos(heading) / (METRES_A_DEGREE * shrink)
                latitude = start[1] + (end[1] - start[1]) * share - aside_m * math.sin(heading) / METRES_A_DEGREE
                return [round(longitude, 7), round(latitude, 7)], math.degrees(heading) % 360.0, number
            left_m -= length_m
        return list(points[-1]), 0.0, len(points) - 1
