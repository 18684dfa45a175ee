"""MAVProxy and MAVSDK reach a UAV of the pool by the very words that the API tells them."""

import os
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
from mavsdk import ComponentType, Configuration, Mavsdk
from mavsdk.plugins.action import Action
from mavsdk.plugins.telemetry import Telemetry

from simulation.serializers.simulations import connection_json
from simulation.vehicle_endpoint.launch import Launch
from tests.simulation.fleets import AT, flying, free_port, wait_for

HOST = "127.0.0.1"
SPEED = 10.0


def reported(port: int) -> dict[str, str]:
    return {example["program"]: example["command"] for example in connection_json(HOST, port)["examples"]}


@pytest.mark.long
def test_mavproxy_connects_and_arms(tmp_path):
    port = free_port()
    program, *words = shlex.split(reported(port)["MAVProxy"])
    own = [f"--logfile={tmp_path / 'log.tlog'}", f"--state-basedir={tmp_path}"]
    command = [sys.executable, str(Path(sys.executable).with_name(program)), *words, *own]
    pipe, environment = subprocess.PIPE, os.environ | {"HOME": str(tmp_path)}
    with (
        flying([Launch(1, AT, listens_at=(HOST, port))], speed=SPEED) as fleet,
        subprocess.Popen(  # noqa: S603
            command, cwd=tmp_path, env=environment, stdin=pipe, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, text=True, bufsize=1
        ) as process,
    ):
        assert process.stdin is not None
        try:
            wait_for(lambda: fleet.uavs[0].received_count > 3, "MAVProxy", patience_s=60.0)
            process.stdin.write("arm throttle\n")
            wait_for(lambda: fleet.uavs[0].uav.state.is_armed, "arming", patience_s=60.0)
        finally:
            process.kill()
            process.wait()


def test_mavsdk_connects_and_takes_off():
    port = free_port()
    with flying([Launch(1, AT, listens_at=(HOST, port))], speed=SPEED) as fleet:
        mavsdk = Mavsdk(Configuration.create_with_component_type(ComponentType.GROUND_STATION))
        try:
            mavsdk.add_any_connection(reported(port)["MAVSDK"])
            system = mavsdk.first_autopilot(60.0)
            assert system is not None
            action, telemetry = Action(system), Telemetry(system)
            wait_for(lambda: telemetry.health_all_ok(), "health", patience_s=60.0)
            action.arm()
            action.takeoff()
            wait_for(lambda: fleet.uavs[0].uav.state.is_in_air, "take-off", patience_s=60.0)
        finally:
            mavsdk.destroy()
