"""Whether an answer is a whole safe plan: every UAV and every target of the request is in it, and no conflict was left.

Reading JSON of 40 kB costs the tester a fifth of what making it costs the tested, and both share one machine. So each answer is looked
at in its bytes, and one of so many is read as a whole.
"""

from typing import Any

import orjson


def plain_fault_of(content: bytes, asked: dict[str, Any]) -> str:
    """As `fault_of`, by what the bytes of a good answer contain: each part is looked through once. Targets without a task do not count."""
    begins = content.find(b'"routes":[')
    if begins < 0 or content.rfind(b'"unassigned":[]') < begins:
        return "targets are left out, or no plan"
    if content.find(b'"unresolved":[]', 0, begins) < 0 or content.find(b'"uav_inside_zone"', 0, begins) >= 0:
        return "UAVs do not keep apart, or stand in a zone"
    if (routes := content.count(b'"end_action":', begins)) != len(asked["uavs"]):
        return f"{routes} routes for {len(asked['uavs'])} UAVs"
    before_tasks = content.split(b',"task":{')[:-1]
    visited = {part[part.rfind(b":") + 1 :] for part in before_tasks if part.endswith(_DIGITS)}
    missing = {b"%d" % number for number in range(len(asked["targets"]))} - visited
    return f"{len(missing)} targets are not visited" if missing else ""


_DIGITS = tuple(b"%d" % digit for digit in range(10))


def fault_of(content: bytes, asked: dict[str, Any]) -> str:
    """What is wrong with the answer to this request; empty for a whole plan in which every target is visited and all UAVs keep apart."""
    try:
        return fault_of_plan(orjson.loads(content), asked)
    except ValueError as error:
        return f"no JSON: {error}"[:100]


def fault_of_plan(plan: Any, asked: dict[str, Any]) -> str:
    """As `fault_of`, of what has been read already."""
    try:
        if plan["unassigned"]:
            return f"{len(plan['unassigned'])} targets are left out"
        if len(plan["routes"]) != len(asked["uavs"]):
            return f"{len(plan['routes'])} routes for {len(asked['uavs'])} UAVs"
        visited = {waypoint["target"] for route in plan["routes"] for waypoint in route["waypoints"]} - {None}
        if visited != set(range(len(asked["targets"]))):
            return f"{len(visited)} of {len(asked['targets'])} targets are visited"
        if plan["separation"]["unresolved"]:
            return "UAVs do not keep apart"
        if any(warning["code"] == "uav_inside_zone" for warning in plan["warnings"]):
            return "a UAV stands in a zone"
    except (KeyError, TypeError) as error:
        return f"no plan: {error!r}"[:100]
    return ""
