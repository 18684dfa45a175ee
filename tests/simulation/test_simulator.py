"""The simulator as a program: a mission is flown through the gateway, its link is lost for a while, and the simulator is killed."""

import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from pymavlink import mavutil

from missions.models import CommandKind, CommandState, Mission, MissionState, TargetState, Uav, UavCommand
from missions.services.commands.commands import queue_command
from missions.services.commands.dispatch import abort_mission, dispatch_mission
from simulation.models import SimulatedVehicle, Simulation, SimulationState
from simulation.services.simulations import change_simulation, end_simulation
from telemetry.models import Alert, AlertLevel, TelemetryRecord, UavLink, UavWatch
from tests.accounts.users import a_user
from tests.missions.flights import approved, fleet, ground
from tests.missions.worlds import world
from tests.simulation.simulations import fresh, pool, stand_ins
from tests.telemetry.gateway.program import PROJECT_DIR, environment, free_port, gateway_program
from tests.telemetry.gateway.station import TIMEOUT_S, wait_for
from tests.telemetry.watch.program import watch_program

pytestmark = pytest.mark.django_db(transaction=True)
LONG_S = 90.0


@contextmanager
def simulator_program(gateway_port: int, log_dir: Path, *, name: str = "test") -> Iterator[subprocess.Popen[str]]:
    """At work when it is given out; killed at the end unless it has ended by itself."""
    command = [sys.executable, "manage.py", "run_simulator", "--name", name, "--gateway", f"127.0.0.1:{gateway_port}"]
    with (log_dir / f"simulator-{name}.log").open("a") as log:
        process = subprocess.Popen(  # noqa: S603
            command, cwd=PROJECT_DIR, env=environment(log_dir), stdout=subprocess.PIPE, stderr=log, text=True
        )
        timer = threading.Timer(3 * TIMEOUT_S, process.kill)
        timer.start()
        try:
            assert process.stdout is not None
            assert "simulating" in process.stdout.readline(), (log_dir / f"simulator-{name}.log").read_text()
            yield process
        finally:
            timer.cancel()
            process.kill()
            process.wait()
            assert process.stdout is not None
            process.stdout.close()


@pytest.fixture
def mission(settings, tmp_path) -> Mission:
    settings.FLIGHT_LOG_DIR = tmp_path
    ground(tmp_path / "hill.tif", 100.0)
    return approved(a_user(), fleet("Tern"), world().towers[:1])[0]


def applied(command: UavCommand) -> None:
    def found() -> bool:
        command.refresh_from_db()
        return command.state in (CommandState.APPLIED, CommandState.FAILED, CommandState.EXPIRED)

    wait_for(found, f"the end of {command.kind}", patience_s=LONG_S)
    assert command.state == CommandState.APPLIED, command.outcome


def sent_and_started(mission: Mission, uav: Uav) -> None:
    (upload,) = dispatch_mission(mission=mission, actor=mission.author)
    applied(upload)
    start = queue_command(
        uav=uav, kind=CommandKind.START, actor=mission.author, mission=mission, approval=upload.approval, parameters={"flight": 1}
    )
    applied(start)


def state_of(mission: Mission) -> str:
    mission.refresh_from_db()
    return mission.state


def is_seen_in_flight(uav: Uav) -> bool:
    return UavWatch.objects.filter(uav=uav, estimated__isnull=False).exists()


def reported(simulation: Simulation, name: str) -> object:
    return simulation.vehicles.get().reported.get(name)


@pytest.mark.long
def test_a_mission_is_flown_by_its_stand_in_and_a_lost_link_comes_back(mission, tmp_path):
    uav, port = Uav.objects.get(), free_port()
    simulation = stand_ins(mission, mission.author, speed=10.0)
    uav.refresh_from_db()
    with gateway_program(port, tmp_path), simulator_program(port, tmp_path), watch_program(tmp_path, name="watch"):
        wait_for(lambda: UavLink.objects.filter(uav=uav).exists(), "the UAV at the gateway", patience_s=LONG_S)
        sent_and_started(mission, uav)
        change_simulation(simulation=simulation, actor=mission.author, faults={"link_lost_for_s": 30.0})
        wait_for(lambda: reported(simulation, "is_link_lost"), "the fault")
        wait_for(lambda: reported(simulation, "is_link_lost") is False, "its end")
        wait_for(lambda: state_of(mission) == MissionState.COMPLETED, "the end of the mission", patience_s=LONG_S)
        assert set(mission.targets.values_list("state", flat=True)) == {TargetState.COMPLETE}
        assert TelemetryRecord.objects.filter(uav=uav, is_in_air=True).exists()
        assert set(Alert.objects.filter(mission=mission).values_list("code", flat=True)) <= {"link-lost"}, "ten times as fast is no fault"
        assert fresh(simulation).step_timing["steps"] > 0
        end_simulation(simulation=simulation, actor=mission.author)
        wait_for(lambda: fresh(simulation).state == SimulationState.ENDED, "its end by hand")
    assert not UavLink.objects.get(uav=uav).losses.get("wrong-signature")


@pytest.mark.long
def test_a_missions_uav_is_lost_with_a_simulator_that_is_killed_in_mid_air(mission, tmp_path):
    """The watch tells of its link; the simulator that comes back does not bring it back; the mission is aborted without it."""
    uav, port = Uav.objects.get(), free_port()
    Mission.objects.update(alert_limits={"link_late_s": 2.0, "link_lost_s": 5.0})
    simulation = stand_ins(mission, mission.author, speed=2.0)
    with gateway_program(port, tmp_path), watch_program(tmp_path, name="watch"):
        with simulator_program(port, tmp_path) as first:
            wait_for(lambda: UavLink.objects.filter(uav=uav).exists(), "the UAV at the gateway", patience_s=LONG_S)
            sent_and_started(mission, uav)
            wait_for(lambda: reported(simulation, "is_in_air"), "take-off", patience_s=LONG_S)
            wait_for(lambda: is_seen_in_flight(uav), "the watch that sees it fly", patience_s=LONG_S)
            first.kill()
        with simulator_program(port, tmp_path):
            wait_for(lambda: fresh(simulation).state == SimulationState.FAILED, "the loss to be told", patience_s=LONG_S)
            lost = Alert.objects.filter(uav=uav, mission=mission, code="link-lost", closed_at=None)
            wait_for(lost.exists, "the alert", patience_s=LONG_S)
            wait_for(lost.filter(level=AlertLevel.CRITICAL).exists, "its rise", patience_s=LONG_S)
    assert SimulatedVehicle.objects.get().reason == "simulator-lost"
    assert state_of(mission) == MissionState.ACTIVE, "what becomes of the mission is for people to say"
    abort_mission(mission=mission, actor=mission.author, why="Its UAV is lost.")
    assert state_of(mission) == MissionState.ABORTED
    assert lost.exists(), "it did not come back"


@pytest.mark.long
def test_a_uav_of_the_pool_is_reached_as_it_says_and_stands_there_anew_after_a_kill(settings, tmp_path):
    port = free_port()
    settings.SIMULATOR_PORTS = f"{port}-{port}"
    simulation = pool(a_user(), 1)
    with simulator_program(free_port(), tmp_path) as first:
        assert received(port, "a heartbeat")
        first.kill()
    with simulator_program(free_port(), tmp_path):
        wait_for(lambda: fresh(simulation).restarts == 1, "that it is taken", patience_s=LONG_S)
        assert received(port, "a heartbeat of the new one")
    assert fresh(simulation).vehicles.get().restarts == 1


def received(port: int, what: str) -> bool:
    """A station that talks first is answered."""
    station = mavutil.mavlink_connection(f"udpout:127.0.0.1:{port}", source_system=255)

    def beats() -> bool:
        station.mav.heartbeat_send(mavutil.mavlink.MAV_TYPE_GCS, mavutil.mavlink.MAV_AUTOPILOT_INVALID, 0, 0, 0)
        return station.recv_match(type="HEARTBEAT", blocking=True, timeout=0.5) is not None

    try:
        return bool(wait_for(beats, what, patience_s=LONG_S))
    finally:
        station.close()
