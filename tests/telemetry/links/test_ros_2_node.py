"""The ROS 2 node of docs/uav-link.md, run without ROS: what it makes of a route, and that it refuses what was not taken as it came."""

import re
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest

from examples.companion.autopilot import Refused
from examples.companion.content import content_sha256
from tests.missions.flights import an_operator, dispatched
from tests.missions.worlds import UAV_AT, world
from tests.telemetry.links.uav_clients import linked_uav

PAGE = Path(__file__).resolve().parents[3] / "docs" / "uav-link.md"
FLY_TO, RETURN, TAKE_OFF = 16, 20, 22
GLOBAL, RELATIVE = 0, 3


class Service:
    """Answers at once; `taken` gets what a push of waypoints brings."""

    def __init__(self, name: str, taken: list[Any]) -> None:
        self.srv_name, self._taken = name, taken

    def call_async(self, request: Any) -> Any:
        self._taken[:] = getattr(request, "waypoints", self._taken)
        return SimpleNamespace(done=lambda: True, result=lambda: SimpleNamespace(success=True, mode_sent=True))


class Node:
    """What the node uses of rclpy's."""

    def __init__(self, _name: str) -> None:
        self.taken: list[Any] = []

    def create_subscription(self, *_: Any) -> None:
        """Topics are set by the test."""

    def create_client(self, _type: Any, name: str) -> Service:
        return Service(name, self.taken)


def _module(name: str, **content: Any) -> ModuleType:
    module = ModuleType(name)
    vars(module).update(content)
    return module


@pytest.fixture
def node_class(monkeypatch: pytest.MonkeyPatch) -> Any:
    """MavrosAutopilot of the page, on stand-ins for the packages of ROS."""
    message, service = SimpleNamespace, SimpleNamespace(Request=SimpleNamespace)
    messages = {"State": message, "Waypoint": message, "WaypointList": message}
    services = dict.fromkeys(("CommandBool", "SetMode", "WaypointClear", "WaypointPush"), service)
    for module in (
        _module("rclpy"),
        _module("rclpy.node", Node=Node),
        _module("rclpy.qos", qos_profile_sensor_data=None),
        _module("mavros_msgs"),
        _module("mavros_msgs.msg", **messages),
        _module("mavros_msgs.srv", **services),
        _module("sensor_msgs"),
        _module("sensor_msgs.msg", BatteryState=message, NavSatFix=message),
    ):
        monkeypatch.setitem(sys.modules, module.__name__, module)
    section = PAGE.read_text().partition("## A ROS 2 node")[2]
    [program] = re.findall(r"```python\n(.*?)```", section, re.DOTALL)
    names: dict[str, Any] = {"__name__": "spanwise_bridge"}
    exec(compile(program, str(PAGE), "exec"), names)  # noqa: S102 - the page's own program
    return names["MavrosAutopilot"]


@pytest.fixture
def content(db: None) -> dict[str, Any]:
    """Of a route that a UAV was given by the link."""
    here, kite = world(), linked_uav("Kite", is_simulated=True)
    dispatched(an_operator(), [kite.uav], here.towers[:2])
    found: dict[str, Any] = kite.get("route").json()["route"]["content"]
    assert found["end_action"] == "return"
    return found


def held_by(node: Any) -> Any:
    """The list on board is what was pushed."""
    node.held = SimpleNamespace(waypoints=node.taken)
    return node


def test_the_list_begins_with_home_and_take_off(node_class: Any, content: dict[str, Any]) -> None:
    node = held_by(node_class())
    assert content_sha256(node.load(content, 0.0)) == content_sha256(content)
    home, take_off, *flown, end = node.taken
    first = content["waypoints"][0]
    assert (home.command, home.frame, home.z_alt) == (FLY_TO, GLOBAL, content["take_off"]["altitude_amsl_m"] or 0.0)
    assert (take_off.command, take_off.frame, take_off.z_alt) == (TAKE_OFF, RELATIVE, first["altitude_relative_m"])
    for item in (home, take_off):
        assert (item.y_long, item.x_lat) == pytest.approx(UAV_AT), "longitude is first in the route alone"
    assert [(item.y_long, item.x_lat, item.z_alt) for item in flown] == [
        (*point["position"], point["altitude_relative_m"]) for point in content["waypoints"]
    ]
    assert {item.command for item in flown} == {FLY_TO}
    assert end.command == RETURN


def test_a_px4_gets_no_home(node_class: Any, content: dict[str, Any]) -> None:
    node = held_by(node_class(is_ardupilot=False))
    node.load(content, 0.0)
    assert [item.command for item in node.taken][:2] == [TAKE_OFF, FLY_TO]
    assert len(node.taken) == len(content["waypoints"]) + 2


def test_home_may_have_moved_but_no_other_item(node_class: Any, content: dict[str, Any]) -> None:
    node = node_class()
    node.held = SimpleNamespace(waypoints=[])
    with pytest.raises(Refused):
        node.load(content, 0.0)
    home, *rest = node.taken
    node.held.waypoints = [SimpleNamespace(**{**vars(home), "x_lat": home.x_lat + 1.0}), *rest]
    node.load(content, 0.0)
    moved = SimpleNamespace(**{**vars(rest[1]), "z_alt": rest[1].z_alt + 1.0})
    node.held.waypoints = [home, rest[0], moved, *rest[2:]]
    with pytest.raises(Refused):
        node.load(content, 0.0)
