"""UAVs that speak MAVLink, all in one process: each says once a second where it is on its way, and takes a new speed when it is told one.

    python -m deploy.load.day.fleet --day FOLDER --udp HOST:PORT [--seconds N]

Heartbeat, attitude, battery and position, evenly spread over the second. A few of them fly by hand for some seconds now and then, so that
there is something to be alerted of. Until SIGTERM or the end it sends; then it writes into the book how many reports each has sent. What
is sent while no gateway listens is lost, as on a radio: nobody has acknowledged it.
"""

import argparse
import math
import os
import signal
import socket
import time
from bisect import bisect_right
from itertools import accumulate, pairwise
from pathlib import Path

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from deploy.load.day import book as kinds
from deploy.load.day.book import Book
from deploy.load.day.site import InAir, Site
from mavlink.signing import FrameWriter

IN_MISSION, BY_HAND = 4 << 16 | 4 << 24, 3 << 16  # PX4's custom modes: automatic, mission; position
BY_HAND_INTERVAL_S, BY_HAND_FOR_S = 900, 12
PER_DEGREE = 1e7
M_PER_DEG = 111_195.0
ARMED_IN_AUTO = 209  # base mode
MAX_DATAGRAM_BYTES = 2_048


class Flying:
    """One UAV that flies its way once and hovers at its end: to and fro would be an alert for each turn, 20,000 an hour."""

    def __init__(self, uav: InAir, number: int) -> None:
        self.uav, self.number = uav, number
        self.writer = FrameWriter(uav.system, 1)
        self.speed_mps = uav.speed_mps
        self.along_m = 0.0
        self.sent = 0
        legs = [self._leg_m(a, b) for a, b in pairwise(uav.way)]
        self.marks_m = [0.0, *accumulate(legs)]

    @staticmethod
    def _leg_m(a: tuple[float, float, float], b: tuple[float, float, float]) -> float:
        east_m = (b[0] - a[0]) * M_PER_DEG * math.cos(math.radians(a[1]))
        return math.hypot(east_m, (b[1] - a[1]) * M_PER_DEG)

    def at(self) -> tuple[float, float, float]:
        """Longitude, latitude, height above take-off."""
        whole_m = self.marks_m[-1]
        if whole_m <= 0.0:
            return self.uav.way[0]
        there_m = min(self.along_m, whole_m)
        leg = min(bisect_right(self.marks_m, there_m), len(self.marks_m) - 1)
        start_m, end_m = self.marks_m[leg - 1], self.marks_m[leg]
        share = (there_m - start_m) / (end_m - start_m) if end_m > start_m else 0.0
        a, b = self.uav.way[leg - 1], self.uav.way[leg]
        return a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]), a[2] + share * (b[2] - a[2])

    def frames(self, boot_ms: int) -> list[bytes]:
        lon, lat, height_m = self.at()
        seconds = boot_ms // 1000 + self.number * 7
        mode = BY_HAND if seconds % BY_HAND_INTERVAL_S < BY_HAND_FOR_S else IN_MISSION
        position = mavlink.MAVLink_global_position_int_message(
            boot_ms, round(lat * PER_DEGREE), round(lon * PER_DEGREE), round((self.uav.ground_amsl_m + height_m) * 1000),
            round(height_m * 1000), 0, round(self.speed_mps * 100), 0, 9_000,
        )  # fmt: skip
        messages = (
            mavlink.MAVLink_heartbeat_message(mavlink.MAV_TYPE_QUADROTOR, mavlink.MAV_AUTOPILOT_PX4, ARMED_IN_AUTO, mode, 4, 3),
            mavlink.MAVLink_attitude_message(boot_ms, 0.1, 0.2, 0.3, 0.0, 0.0, 0.0),
            mavlink.MAVLink_sys_status_message(0, 0, 0, 300, 12_000, 500, 80, 0, 0, 0, 0, 0, 0),
            position,
        )
        self.sent += 1
        return [self.writer.frame_of(message, 0.0) for message in messages]

    def answer(self, message: mavlink.MAVLink_message) -> bytes | None:
        """To a change of speed, which is done when the vehicle says so; other commands are not known here."""
        if message.get_type() not in {"COMMAND_LONG", "COMMAND_INT"}:
            return None
        is_speed = message.command == mavlink.MAV_CMD_DO_CHANGE_SPEED
        if is_speed and message.param2 > 0:
            self.speed_mps = message.param2
        result = mavlink.MAV_RESULT_ACCEPTED if is_speed else mavlink.MAV_RESULT_UNSUPPORTED
        to = {"target_system": message.get_srcSystem(), "target_component": message.get_srcComponent()}
        return bytes(self.writer.frame_of(mavlink.MAVLink_command_ack_message(message.command, result, **to), 0.0))


def play(site: Site, udp: tuple[str, int], seconds: float, book: Book) -> None:
    ends: list[int] = []
    signal.signal(signal.SIGTERM, lambda number, _frame: ends.append(number))
    sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sender.connect(udp)
    sender.setblocking(False)
    fleet = [Flying(uav, number) for number, uav in enumerate(site.in_air)]
    by_system = {one.uav.system: one for one in fleet}
    receives = mavlink.MAVLink(None)
    receives.robust_parsing = True
    every_s, first_s = 1.0 / max(len(fleet), 1), time.monotonic()
    for number in range(int(seconds * len(fleet))):
        time.sleep(max(first_s + number * every_s - time.monotonic(), 0.0))
        if ends:
            break
        one = fleet[number % len(fleet)]
        one.along_m += one.speed_mps
        for frame in one.frames(int((time.monotonic() - first_s) * 1000)):
            _send(sender, frame)
        _answer_all(sender, receives, by_system)
    for one in fleet:
        book.note(kinds.SENT, uav=one.uav.uav, reports=one.sent)


def _send(sender: socket.socket, frame: bytes) -> None:
    try:
        sender.send(frame)
    except OSError:
        return  # nobody listens just now, or the buffer is full: lost


def _answer_all(sender: socket.socket, receives: mavlink.MAVLink, by_system: dict[int, Flying]) -> None:
    while True:
        try:
            received = sender.recv(MAX_DATAGRAM_BYTES)
        except OSError:
            return
        for message in receives.parse_buffer(received) or ():
            one = by_system.get(getattr(message, "target_system", 0))
            frame = one.answer(message) if one else None
            if frame:
                _send(sender, frame)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--day", type=Path, default=os.environ.get("SPANWISE_DAY"))
    parser.add_argument("--udp", required=True, help="HOST:PORT of a gateway")
    parser.add_argument("--seconds", type=float, default=86_400.0)
    options = parser.parse_args()
    host, _, port = options.udp.rpartition(":")
    play(Site.read(options.day), (host, int(port)), options.seconds, Book(options.day))


if __name__ == "__main__":
    main()
