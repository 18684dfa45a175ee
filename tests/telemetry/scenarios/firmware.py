"""An ArduCopter in software in the loop: the user's program, started for one test, with a second link for what the test does to it.

`unshare` gives the tests and the firmware a network of their own (scripts.test_run.loopback), for it listens on all addresses.
"""

import socket
import subprocess
import threading
import time
from collections import Counter, deque
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.frames import frames_of_datagram, message_of
from mavlink.mission_sync.wire import OnboardItem, onboard_item
from mavlink.signing import FrameWriter
from mavlink.vehicle_plan import MissionItem, MissionType
from tests.missions.worlds import UAV_AT
from tests.telemetry.gateway.station import wait_for
from tests.telemetry.scenarios.vehicle import HOME_AMSL_M

SECOND_STATION = (254, mavlink.MAV_COMP_ID_MISSIONPLANNER)
ABSOLUTE_POSITION = 0x10  # of EKF_STATUS_REPORT: it may be armed in GUIDED only then
READY_S = 120.0
ANSWER_S, TRIES = 1.0, 20
LOOP_S = 0.02
REBOOT_IN_FLIGHT = 20_190_226.0  # without this figure it refuses
CALIBRATED = {"ACCOFFS": 0.001, "ACC2OFFS": 0.001, "ACCSCAL": 1.001, "ACC2SCAL": 1.001}  # without, it does not arm
SENSORS = {f"INS_{kind}_{axis}": value for kind, value in CALIBRATED.items() for axis in "XYZ"}


@dataclass
class Firmware:
    """`link` is where its first serial port leads, "udpclient:127.0.0.1:14550" say; `speed` is simulated seconds in a second."""

    binary: Path
    folder: Path
    link: str
    system: int = 7
    at: tuple[float, float] = UAV_AT
    speed: float = 5.0
    instance: int = 0
    parameters: dict[str, float] = field(default_factory=dict)
    stated: list[str] = field(default_factory=list)  # its STATUSTEXTs
    newest: dict[str, Any] = field(default_factory=dict)  # messages by their names

    def __enter__(self) -> "Firmware":
        self.folder.mkdir(parents=True, exist_ok=True)
        usual = {"FRAME_CLASS": 1.0, "SYSID_THISMAV": float(self.system), **SENSORS}
        lines = [f"{name} {value:.10g}\n" for name, value in (usual | self.parameters).items()]
        (self.folder / "vehicle.parm").write_text("".join(lines))
        self._console = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._console.bind(("127.0.0.1", 0))
        self._console.settimeout(LOOP_S)
        self._sender: Any = None
        self._writer = FrameWriter(*SECOND_STATION, 0, None)
        self._answers: deque[Any] = deque(maxlen=10_000)
        self._ends = threading.Event()
        self._process = self._start(wipe=True)
        self._thread = threading.Thread(target=self._listen, name=f"second link of {self.system}")
        self._thread.start()
        wait_for(lambda: self._sender is not None, "that it speaks by its second link")
        return self

    def __exit__(self, *_: object) -> None:
        self._ends.set()
        self._thread.join(10)
        self.kill()
        self._console.close()

    def _start(self, *, wipe: bool) -> "subprocess.Popen[bytes]":
        place = f"{self.at[1]},{self.at[0]},{HOME_AMSL_M:g},90"
        command = [str(self.binary), *(["-w"] if wipe else []), "--model", "+", "--home", place, "--speedup", f"{self.speed:g}"]
        command += ["--instance", str(self.instance), "--serial0", self.link, "--serial2", "none:0", "--defaults", "vehicle.parm"]
        command += ["--serial1", f"udpclient:127.0.0.1:{self._console.getsockname()[1]}"]
        with (self.folder / "firmware.log").open("ab") as log:
            return subprocess.Popen(command, cwd=self.folder, stdin=subprocess.DEVNULL, stdout=log, stderr=log)  # noqa: S603

    def kill(self) -> None:
        """It does not end by SIGTERM while it waits for a reader."""
        self._process.kill()
        self._process.wait()

    def reboot(self) -> None:
        """Somebody insists on it in flight: its simulator begins anew with it, at home."""
        self.command(mavlink.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 1.0, six=REBOOT_IN_FLIGHT)
        wait_for(lambda: not self.is_armed, "that it is switched on again")
        self.newest.clear()

    def lose_power(self) -> None:
        """For a moment: it stands at its home again, with the lists and parameters it had."""
        self.kill()
        self.newest.clear()
        self._process = self._start(wipe=False)

    def _listen(self) -> None:
        next_heartbeat_s = 0.0
        while not self._ends.is_set():
            with suppress(TimeoutError):
                datagram, self._sender = self._console.recvfrom(65_535)
                for message in [message_of(frame) for frame in frames_of_datagram(datagram, Counter())]:
                    self._take(message)
            if self._sender is not None and time.monotonic() >= next_heartbeat_s:
                next_heartbeat_s = time.monotonic() + 1.0
                self.send(mavlink.MAVLink_heartbeat_message(mavlink.MAV_TYPE_GCS, mavlink.MAV_AUTOPILOT_INVALID, 0, 0, 4, 3))
                for number in (mavlink.MAVLINK_MSG_ID_EKF_STATUS_REPORT, mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT):
                    self.command(mavlink.MAV_CMD_SET_MESSAGE_INTERVAL, number, 200_000.0)

    def _take(self, message: Any) -> None:
        if message.get_srcSystem() != self.system:
            return
        name = message.get_type()
        self.newest[name] = message
        if name == "STATUSTEXT":
            self.stated.append(message.text)
        elif name.startswith("MISSION_") or name == "PARAM_VALUE":
            self._answers.append(message)

    def send(self, message: Any) -> None:
        """By the second link, as another ground station."""
        self._console.sendto(self._writer.frame_of(message, time.time()), self._sender)

    def command(self, command: int, one: float, two: float = 0.0, six: float = 0.0) -> None:
        self.send(mavlink.MAVLink_command_long_message(self.system, 1, command, 0, float(one), two, 0, 0, 0, six, 0))

    def asked(self, question: Any, name: str, **values: Any) -> Any:
        """The answer of this name with these values to a question, which is asked again until it comes."""
        for _ in range(TRIES):
            self._answers.clear()
            self.send(question)
            until_s = time.monotonic() + ANSWER_S
            while time.monotonic() < until_s:
                while self._answers:
                    answer = self._answers.popleft()
                    if answer.get_type() == name and all(getattr(answer, key) == value for key, value in values.items()):
                        return answer
                time.sleep(LOOP_S / 2)
        raise AssertionError(
            f"no {name} from vehicle {self.system}: {self.stated[-5:]}; {(self.folder / 'firmware.log').read_text()[-400:]}"
        )

    def set(self, name: str, value: float) -> None:
        message = mavlink.MAVLink_param_set_message(self.system, 1, name.encode(), value, mavlink.MAV_PARAM_TYPE_REAL32)
        reported = self.asked(message, "PARAM_VALUE", param_id=name)
        assert abs(reported.param_value - value) < 1e-3, reported

    def held(self, kind: MissionType) -> list[OnboardItem]:
        """A list as it is read by the second link."""
        ends = (self.system, 1)
        count = self.asked(mavlink.MAVLink_mission_request_list_message(*ends, kind), "MISSION_COUNT", mission_type=kind).count
        asked_for = (mavlink.MAVLink_mission_request_int_message(*ends, number, kind) for number in range(count))
        items = [self.asked(ask, "MISSION_ITEM_INT", seq=ask.seq, mission_type=kind) for ask in asked_for]
        self.send(mavlink.MAVLink_mission_ack_message(*ends, mavlink.MAV_MISSION_ACCEPTED, kind))
        return [onboard_item(item) for item in items]

    def shorten(self) -> None:
        """Another ground station takes the last item off its mission."""
        items = [held.item for held in self.held(MissionType.MISSION)][:-1]
        question: Any = mavlink.MAVLink_mission_count_message(self.system, 1, len(items), MissionType.MISSION)
        for number, item in enumerate(items):
            self.asked(question, "MISSION_REQUEST", seq=number)
            question = _item(self.system, number, item)
        assert self.asked(question, "MISSION_ACK").type == mavlink.MAV_MISSION_ACCEPTED

    @property
    def heartbeat(self) -> Any:
        return self.newest.get("HEARTBEAT")

    @property
    def is_armed(self) -> bool:
        return self.heartbeat is not None and bool(self.heartbeat.base_mode & mavlink.MAV_MODE_FLAG_SAFETY_ARMED)

    @property
    def custom_mode(self) -> int:
        return -1 if self.heartbeat is None else int(self.heartbeat.custom_mode)

    @property
    def height_m(self) -> float:
        """Above its home."""
        reported = self.newest.get("GLOBAL_POSITION_INT")
        return 0.0 if reported is None else reported.relative_alt / 1000.0

    @property
    def place(self) -> tuple[float, float]:
        """Longitude and latitude, as it tells them."""
        reported = self.newest.get("GLOBAL_POSITION_INT")
        return self.at if reported is None else (reported.lon / 1e7, reported.lat / 1e7)

    @property
    def is_ready(self) -> bool:
        """It may be armed in GUIDED, unless something else is wrong."""
        reported = self.newest.get("EKF_STATUS_REPORT")
        return reported is not None and bool(reported.flags & ABSOLUTE_POSITION) and "HOME_POSITION" in self.newest


def _item(system: int, number: int, item: MissionItem) -> Any:
    place = (item.latitude_e7, item.longitude_e7, item.altitude_m)
    return mavlink.MAVLink_mission_item_int_message(
        system, 1, number, item.frame, item.command, 0, 1, *item.parameters, *place, MissionType.MISSION
    )
