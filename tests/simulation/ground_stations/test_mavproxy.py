"""MAVProxy, unchanged and as it is published, over its standard input: lists, parameters, modes and a flight, with both autopilot types."""

import os
import re
import subprocess
import sys
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

import pytest

from mavlink.vehicle_plan import MissionType
from simulation.flight.plant import FlatGround
from simulation.flight.states import FlightMode
from simulation.vehicle_endpoint.launch import Launch
from simulation.vehicle_protocol.mode_numbers import GUIDED, SimulatedAutopilot
from tests.simulation.fleets import AT, flying, free_port, wait_for

SPEED = 20.0
GROUND_M = 40.0
SYSTEM = 7
WAITS = {SimulatedAutopilot.PX4: "COM_DISARM_PRFLT", SimulatedAutopilot.ARDUPILOT: "DISARM_DELAY"}
HOME = "16 0 0 0 0 0 55.4 10.4 40"
MISSION = ("22 3 0 0 0 0 55.4 10.4 15", "16 3 2 0 0 0 55.4004 10.4 20", "21 3 0 0 0 0 55.4004 10.4 0")
FENCE = ("5001 0 3 0 0 0 55.41 10.39 0", "5001 0 3 0 0 0 55.41 10.41 0", "5001 0 3 0 0 0 55.39 10.4 0")
RALLY = ("5100 3 0 0 0 0 55.401 10.401 40",)
LISTED = re.compile(r"^(\d+) (\d+) (\S+) (\S+) (\S+) p1=(\S+) p2=(\S+) p3=(\S+) p4=(\S+) cur=\d auto=1$", re.MULTILINE)


class MavProxy:
    """`type_line` gives it a line; `reported` waits until it has printed something since the last line."""

    def __init__(self, process: "subprocess.Popen[str]") -> None:
        self._process = process
        self._printed: list[str] = []
        self._mark = 0
        self._reader = threading.Thread(target=self._read)
        self._reader.start()

    def _read(self) -> None:
        assert self._process.stdout is not None
        for line in self._process.stdout:
            self._printed.append(line)

    def type_line(self, line: str) -> None:
        assert self._process.stdin is not None
        self._mark = len(self._printed)
        self._process.stdin.write(line + "\n")
        self._process.stdin.flush()

    def asked(self, line: str, words: str) -> None:
        """Says the line again until it tells so: what the vehicle has told it may not have read yet."""
        for _ in range(10):
            self.type_line(line)
            with suppress(AssertionError):
                wait_for(lambda: words in self.since, words, patience_s=2.0)
                return
        raise AssertionError(f"MAVProxy did not tell {words!r} but:\n{self.since}")

    @property
    def since(self) -> str:
        return "".join(self._printed[self._mark :])

    def reported(self, words: str) -> str:
        try:
            wait_for(lambda: words in self.since, words)
        except AssertionError:
            raise AssertionError(f"MAVProxy did not tell {words!r} but:\n{self.since}") from None
        return self.since

    def join(self) -> None:
        self._reader.join(10)


@contextmanager
def mavproxy(port: int, folder: Path) -> Iterator[MavProxy]:
    program = Path(sys.executable).with_name("mavproxy.py")
    command = [
        sys.executable,
        str(program),
        f"--master=udpin:127.0.0.1:{port}",
        f"--logfile={folder / 'log.tlog'}",
        f"--state-basedir={folder}",
    ]
    pipe, environment = subprocess.PIPE, os.environ | {"HOME": str(folder)}
    with subprocess.Popen(  # noqa: S603
        command, cwd=folder, env=environment, stdin=pipe, stdout=pipe, stderr=subprocess.STDOUT, text=True, bufsize=1
    ) as process:
        station = MavProxy(process)
        try:
            yield station
        finally:
            process.kill()
            process.wait()
            station.join()


def written(path: Path, items: Sequence[str]) -> Path:
    """QGroundControl's text format, which MAVProxy loads for each kind of list."""
    rows = []
    for number, item in enumerate(items):
        command, frame, *figures = item.split()
        rows.append("\t".join([str(number), "0", frame, command, *figures, "1"]))
    path.write_text("QGC WPL 110\n" + "\n".join(rows) + "\n")
    return path


def listed(text: str) -> list[str]:
    """As `MISSION` and the others are written."""
    found = []
    for command, frame, lat, lon, height_m, *parameters in LISTED.findall(text):
        found.append(" ".join([command, frame, *(f"{float(value):g}" for value in (*parameters, lat, lon, height_m))]))
    return found


@pytest.mark.long
@pytest.mark.parametrize("autopilot_type", SimulatedAutopilot)
def test_mavproxy_loads_lists_sets_and_flies(autopilot_type, tmp_path):
    port = free_port()
    launch = Launch(SYSTEM, AT, autopilot_type=autopilot_type, ground=FlatGround(GROUND_M), talks_to=[("127.0.0.1", port)])
    mission = [HOME, *MISSION] if autopilot_type is SimulatedAutopilot.ARDUPILOT else list(MISSION)
    with flying([launch], speed=SPEED) as fleet, mavproxy(port, tmp_path) as station:
        uav, pilot, held = fleet.uavs[0].uav, fleet.uavs[0].endpoint.pilot, fleet.uavs[0].endpoint.missions.held
        station.reported("Saved")  # its parameters: it has asked for all it wants

        for kind, name, items in (
            (MissionType.MISSION, "wp", mission),
            (MissionType.FENCE, "fence", FENCE),
            (MissionType.RALLY, "rally", RALLY),
        ):
            station.type_line(f"{name} load {written(tmp_path / f'{name}.txt', items)}")
            station.reported(f"Got MISSION_ACK: TYPE_{kind.name}: ACCEPTED")
            station.type_line(f"{name} list")
            assert listed(station.reported("Saved")) == list(items)
            assert len(held[kind]) == len(items) - (kind is MissionType.MISSION and autopilot_type is SimulatedAutopilot.ARDUPILOT)
        station.type_line("fence clear")
        station.reported("Got MISSION_ACK: TYPE_FENCE: ACCEPTED")
        assert held[MissionType.FENCE] == ()

        name, value, metres = {
            SimulatedAutopilot.PX4: ("RTL_RETURN_ALT", "33", 33.0),
            SimulatedAutopilot.ARDUPILOT: ("RTL_ALT", "3300", 33.0),
        }[autopilot_type]
        station.type_line(f"param set {name} {value}")
        wait_for(lambda: uav.settings.return_height_m == metres, "the parameter")
        station.asked(f"param show {name}", f"{float(value):.1f}")

        station.type_line(f"param set {WAITS[autopilot_type]} 120")  # simulated seconds on the ground: the machine may be busy
        wait_for(lambda: uav.settings.disarm_on_ground_s == 120.0, "the parameter")
        if autopilot_type is SimulatedAutopilot.ARDUPILOT:
            station.type_line("mode GUIDED")
            station.reported("DO_SET_MODE: ACCEPTED")
            assert pilot.custom_mode == GUIDED
            station.type_line("arm throttle")
            station.reported("ARMED")
            station.type_line("takeoff 12")
            wait_for(lambda: uav.state.altitude_relative_m > 11.5, "the height of take-off")
            station.type_line("mode AUTO")
        else:  # its own `mode` does not know how PX4 numbers modes
            station.type_line("arm throttle")
            station.reported("ARMED")
            station.type_line("long MISSION_START 0 0 0 0 0 0 0")
            wait_for(lambda: uav.state.altitude_relative_m > 5.0, "the take-off")
            station.type_line("long DO_SET_MODE 209 4 3 0 0 0 0")
            station.reported("DO_SET_MODE: ACCEPTED")
            assert uav.state.mode is FlightMode.HOLD
            station.type_line("long DO_SET_MODE 209 4 4 0 0 0 0")
        station.reported("DISARMED")
        assert not uav.state.is_in_air and uav.state.position.lat == pytest.approx(55.4004, abs=2e-5)
