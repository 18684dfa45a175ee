"""Photos as vehicles report them: where and when one was taken, where the camera looked, and how well that is known.

Several messages may report one photo, and each may arrive again. Heights have the reference that the message and its sender give them;
others are unknown. Read in ArduPilot's AP_Camera_Backend.cpp and PX4's CameraFeedback.cpp, 2026-11.
"""

import hashlib
import math
import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from enum import StrEnum
from typing import Any, NamedTuple

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.addressing import AUTOPILOT
from mavlink.autopilot_type import AutopilotType
from mavlink.decoding.boots import FIRST_DAY_S, VehicleTime
from mavlink.decoding.gimbal_attitude import ReportedAttitude, YawFrame, attitude_of_angles, attitude_of_quaternion, gimbal_attitude
from mavlink.decoding.report import E7, is_place
from mavlink.frames import Message

FRESH_S = 3.0  # of values of other messages, by receipt
CLOCK_BOUND_S, UTC_BOUND_S, RECEIPT_BOUND_S = 1.0, 2.0, 5.0
DAY_S = 86_400.0
ASKED_AGAIN_S = 120.0  # longest delay of a photo that was asked for again, for its time to count
WRAP_S = 2**32 / 1e6  # ArduPilot stamps photos with a feedback pin by 32 bits of microseconds
GPS_BOUND_M = 2.9  # radius of 95 %, of 1.16 m per axis as the estimator has it
RANGE_SIGMAS = 2.45  # radius of 95 % over the deviation per axis
SHUTTER_S = 0.2  # until the shutter opens, and between positions
HEIGHTS_M = (-500.0, 12_000.0)
MAX_URL_LENGTH = 205
NO_INDEX = -1
EARTH_M_PER_DEGREE = 111_195.0


class CaptureSource(StrEnum):
    """The message that reported a photo."""

    IMAGE_CAPTURED = "camera-image-captured"
    COMPANION = "companion"
    FEEDBACK = "camera-feedback"
    TRIGGER = "camera-trigger"


class CaptureTimeSource(StrEnum):
    """Whose time a photo has."""

    VEHICLE_CLOCK = "vehicle-clock"  # the autopilot's time since boot
    UTC = "utc"  # the sender's time of day, which agreed with the server's
    UAV = "uav"  # a companion computer's time of day
    RECEIPT = "receipt"


class PositionSource(StrEnum):
    PHOTO = "photo"  # of the photo's own message
    VEHICLE = "vehicle"  # the vehicle's last position before it


class AttitudeSource(StrEnum):
    CAMERA = "camera"
    GIMBAL = "gimbal"
    VEHICLE = "vehicle"  # the airframe's: where the camera looked is unknown


@dataclass(frozen=True, slots=True)
class CaptureMessage:
    """One message about a photo; None is unknown. Repetitions of a message have the same `key`.

    `taken_s` is the server's time. Bounds are those of 95 %: seconds, and the radius of the position in metres. `yaw_deg` is from true
    north, or from the nose where `yaw_frame` says so. `camera` is the component that took it.
    """

    source: CaptureSource
    key: str
    taken_s: float
    time_source: CaptureTimeSource
    time_bound_s: float | None = None
    is_taken: bool = True
    camera: int | None = None
    image_index: int | None = None
    longitude_deg: float | None = None
    latitude_deg: float | None = None
    position_source: PositionSource | None = None
    position_bound_m: float | None = None
    altitude_amsl_m: float | None = None
    altitude_relative_m: float | None = None
    altitude_agl_m: float | None = None
    roll_deg: float | None = None
    pitch_deg: float | None = None
    yaw_deg: float | None = None
    yaw_frame: YawFrame | None = None
    attitude_source: AttitudeSource | None = None
    file_url: str = ""
    sent_at: str = ""  # by a companion's clock

    def to_json(self) -> dict[str, Any]:
        stored = {one.name: getattr(self, one.name) for one in fields(self)}
        return {name: value for name, value in stored.items() if value not in (None, "")}

    @classmethod
    def from_json(cls, stored: Mapping[str, Any]) -> "CaptureMessage":
        values: dict[str, Any] = {name: _ENUMS[name](value) if name in _ENUMS else value for name, value in stored.items()}
        return cls(**values)


_ENUMS: Mapping[str, type[StrEnum]] = {
    "source": CaptureSource, "time_source": CaptureTimeSource, "position_source": PositionSource, "yaw_frame": YawFrame,
    "attitude_source": AttitudeSource,
}  # fmt: skip
_TIMES = list(CaptureTimeSource)
_ATTITUDES = [*AttitudeSource, None]
_POSITIONS = [*PositionSource, None]
_SOURCES = list(CaptureSource)


def combined(reports: Sequence[CaptureMessage]) -> CaptureMessage:
    """Return one photo from all its reports, in any order: of each value the one of the best source.

    Positions that differ widen the bound. A photo that its camera could not take was not taken.
    """
    first, *_ = ordered = sorted(reports, key=lambda report: (_SOURCES.index(report.source), report.key))
    timed = min(ordered, key=lambda report: _TIMES.index(report.time_source))
    placed = min(ordered, key=lambda report: _POSITIONS.index(report.position_source))
    aimed = min(ordered, key=lambda report: _ATTITUDES.index(report.attitude_source))
    by_place = sorted(ordered, key=lambda report: _POSITIONS.index(report.position_source))

    def known(name: str, among: Sequence[CaptureMessage] = ordered) -> Any:
        return next((value for report in among if (value := getattr(report, name)) is not None), None)

    return replace(
        first,
        taken_s=timed.taken_s,
        time_source=timed.time_source,
        time_bound_s=timed.time_bound_s,
        is_taken=all(report.is_taken for report in ordered),
        camera=known("camera"),
        image_index=known("image_index"),
        longitude_deg=placed.longitude_deg,
        latitude_deg=placed.latitude_deg,
        position_source=placed.position_source,
        position_bound_m=_widened(placed, ordered),
        altitude_amsl_m=known("altitude_amsl_m", by_place),
        altitude_relative_m=known("altitude_relative_m", by_place),
        altitude_agl_m=known("altitude_agl_m", by_place),
        roll_deg=aimed.roll_deg,
        pitch_deg=aimed.pitch_deg,
        yaw_deg=aimed.yaw_deg,
        yaw_frame=aimed.yaw_frame,
        attitude_source=aimed.attitude_source,
        file_url=next((report.file_url for report in ordered if report.file_url), ""),
    )


def _widened(placed: CaptureMessage, reports: Sequence[CaptureMessage]) -> float | None:
    if placed.longitude_deg is None or placed.latitude_deg is None or placed.position_bound_m is None:
        return placed.position_bound_m
    bound_m = placed.position_bound_m
    for report in reports:
        if report.position_source is PositionSource.PHOTO and report.longitude_deg is not None and report.latitude_deg is not None:
            east_m = (report.longitude_deg - placed.longitude_deg) * EARTH_M_PER_DEGREE * math.cos(math.radians(placed.latitude_deg))
            bound_m = max(bound_m, math.hypot(east_m, (report.latitude_deg - placed.latitude_deg) * EARTH_M_PER_DEGREE))
    return bound_m


class _Place(NamedTuple):
    received_s: float
    longitude_deg: float
    latitude_deg: float
    amsl_m: float
    relative_m: float
    speed_mps: float


class _Time(NamedTuple):
    taken_s: float
    source: CaptureTimeSource
    bound_s: float | None


@dataclass
class CaptureDecoder:
    """Decodes the photos of one vehicle, from all messages of its components in the order of receipt. now_s: Unix seconds."""

    _place: _Place | None = None
    _attitude: tuple[float, ReportedAttitude] | None = None
    _gps_m: float = GPS_BOUND_M
    _right_clocks: set[tuple[int, CaptureTimeSource]] = field(default_factory=set)  # of components whose messages came on time
    _gimbals: dict[tuple[str, int, int], tuple[float, ReportedAttitude]] = field(default_factory=dict)

    def receive(self, message: Message, clock: VehicleTime, autopilot_type: AutopilotType | None, now_s: float) -> CaptureMessage | None:
        """Return the report of a photo; None for other messages."""
        kind = message.get_type()
        if message.get_srcComponent() == AUTOPILOT and kind in ("GLOBAL_POSITION_INT", "ATTITUDE", "GPS_RAW_INT"):
            self._note(kind, message, now_s)
            return None
        attitude = gimbal_attitude(message, autopilot_type)
        if attitude is not None:
            self._gimbals[kind, message.get_srcComponent(), getattr(message, "gimbal_device_id", 0)] = (now_s, attitude)
            return None
        if kind == "CAMERA_IMAGE_CAPTURED":
            return self._image_captured(message, clock, autopilot_type, now_s)
        if kind == "CAMERA_FEEDBACK" and message.flags != mavlink.CAMERA_FEEDBACK_VIDEO:
            return self._feedback(message, clock, autopilot_type, now_s)
        return self._trigger(message, clock, now_s) if kind == "CAMERA_TRIGGER" else None

    def _note(self, kind: str, message: Message, now_s: float) -> None:
        if kind == "ATTITUDE":
            roll_deg, pitch_deg, yaw_deg = (math.degrees(angle) for angle in (message.roll, message.pitch, message.yaw))
            attitude = attitude_of_angles(roll_deg, pitch_deg, yaw_deg, YawFrame.EARTH)
            self._attitude = None if attitude is None else (now_s, attitude)
        elif kind == "GPS_RAW_INT":
            accuracy_mm = getattr(message, "h_acc", 0)
            self._gps_m = max(accuracy_mm / 1e3 * RANGE_SIGMAS, GPS_BOUND_M) if 0 < accuracy_mm < 0xFFFF_FFFF else GPS_BOUND_M
        elif is_place(message.lat, message.lon):
            speed_mps = math.hypot(message.vx, message.vy, message.vz) / 100.0
            self._place = _Place(
                now_s, message.lon / E7, message.lat / E7, message.alt / 1e3, message.relative_alt / 1e3, speed_mps
            )  # fmt: skip

    def _image_captured(self, message: Message, clock: VehicleTime, autopilot_type: AutopilotType | None, now_s: float) -> CaptureMessage:
        """CAMERA_IMAGE_CAPTURED. That of PX4 itself has the vehicle's attitude, and as its relative height that above the ground, or -1."""
        component = message.get_srcComponent()
        is_own = component == AUTOPILOT
        utc_s, boot_s = message.time_utc / 1e6, message.time_boot_ms / 1e3
        stamp = message.time_utc if utc_s >= FIRST_DAY_S else self._place_stamp(message) or message.time_boot_ms
        relative_m = _height(message.relative_alt / 1e3) if message.relative_alt > 0 or not is_own else None
        is_above_ground = is_own and autopilot_type is AutopilotType.PX4
        is_reference_known = not is_own or autopilot_type in (AutopilotType.PX4, AutopilotType.ARDUPILOT)
        report = CaptureMessage(
            CaptureSource.IMAGE_CAPTURED,
            _key(CaptureSource.IMAGE_CAPTURED, component, message.camera_id, message.image_index, stamp),
            *self._time(clock, now_s, boot_s=boot_s, utc_s=utc_s, component=component),
            is_taken=message.capture_result != 0,
            camera=component,
            image_index=message.image_index if message.image_index > NO_INDEX else None,
            altitude_amsl_m=_height(message.alt / 1e3) if is_place(message.lat, message.lon) else None,
            altitude_relative_m=None if is_above_ground or not is_reference_known else relative_m,
            altitude_agl_m=relative_m if is_above_ground else None,
            file_url=_url(message.file_url),
        )
        own = attitude_of_quaternion(message.q, YawFrame.EARTH)
        return self._placed(
            self._aimed(report, own, AttitudeSource.VEHICLE if is_own else AttitudeSource.CAMERA, now_s), message.lat, message.lon, now_s
        )

    def _feedback(self, message: Message, clock: VehicleTime, autopilot_type: AutopilotType | None, now_s: float) -> CaptureMessage:
        """CAMERA_FEEDBACK. ArduPilot's has the vehicle's attitude, and the time of day, or with a feedback pin microseconds since boot."""
        component = message.get_srcComponent()
        time_s = message.time_usec / 1e6
        is_utc = time_s >= FIRST_DAY_S
        has_place = is_place(message.lat, message.lng)
        report = CaptureMessage(
            CaptureSource.FEEDBACK,
            _key(CaptureSource.FEEDBACK, component, message.cam_idx, message.img_idx, message.time_usec or self._place_stamp(message)),
            *self._time(
                clock, now_s, boot_s=None if is_utc or not time_s else _unwrapped(time_s, clock, now_s), utc_s=time_s if is_utc else 0.0,
                component=component,
            ),
            image_index=message.img_idx,
            altitude_amsl_m=_height(message.alt_msl) if has_place else None,
            altitude_relative_m=_height(message.alt_rel) if has_place else None,
        )  # fmt: skip
        own = attitude_of_angles(message.roll, message.pitch, message.yaw, YawFrame.EARTH)
        is_of_vehicle = autopilot_type is AutopilotType.ARDUPILOT and component == AUTOPILOT
        aimed = self._aimed(report, own, AttitudeSource.VEHICLE if is_of_vehicle else AttitudeSource.CAMERA, now_s)
        return self._placed(aimed, message.lat, message.lng, now_s)

    def _trigger(self, message: Message, clock: VehicleTime, now_s: float) -> CaptureMessage:
        """CAMERA_TRIGGER: a camera was triggered, and when."""
        component, time_s = message.get_srcComponent(), message.time_usec / 1e6
        is_utc = time_s >= FIRST_DAY_S
        boot_s = None if is_utc or not time_s else time_s
        report = CaptureMessage(
            CaptureSource.TRIGGER,
            _key(CaptureSource.TRIGGER, component, 0, message.seq, message.time_usec),
            *self._time(clock, now_s, boot_s=boot_s, utc_s=time_s if is_utc else 0.0, component=component),
            image_index=message.seq if message.seq < 2**31 else None,
        )
        return self._placed(self._aimed(report, None, AttitudeSource.CAMERA, now_s), 0, 0, now_s)

    def _time(self, clock: VehicleTime, now_s: float, *, boot_s: float | None, utc_s: float, component: int) -> _Time:
        """Return the server's time of a photo.

        Components other than the autopilot may have booted at another time, or have no time of day: their clocks count once a message came
        on time, then also for photos that were asked for again.
        """
        is_own = component == AUTOPILOT
        boot = clock.boots[-1] if clock.boots and clock.boots[-1].clock.offset_s is not None else None
        is_day = utc_s >= FIRST_DAY_S
        if is_own and boot is not None and is_day and boot.epoch_s is not None:
            boot_s = utc_s - boot.epoch_s
        if boot is not None and boot_s is not None:
            taken_s = boot.clock.measured_s(boot_s)
            is_late_like_others = is_own and now_s - boot.live_at_s > RECEIPT_BOUND_S
            latest_s = DAY_S if is_late_like_others else self._latest_s(component, CaptureTimeSource.VEHICLE_CLOCK)
            if -CLOCK_BOUND_S <= now_s - taken_s <= latest_s:
                self._note_clock(component, CaptureTimeSource.VEHICLE_CLOCK, now_s - taken_s)
                return _Time(min(taken_s, now_s), CaptureTimeSource.VEHICLE_CLOCK, CLOCK_BOUND_S)
            if is_own and 0.0 <= now_s - taken_s <= DAY_S:  # sent late, or another boot
                return _Time(now_s, CaptureTimeSource.RECEIPT, now_s - taken_s)
        if is_day and -UTC_BOUND_S <= now_s - utc_s <= self._latest_s(component, CaptureTimeSource.UTC):
            self._note_clock(component, CaptureTimeSource.UTC, now_s - utc_s)
            return _Time(min(utc_s, now_s), CaptureTimeSource.UTC, UTC_BOUND_S)
        off_s = now_s - utc_s if is_day and 0.0 <= now_s - utc_s <= DAY_S else 0.0
        return _Time(now_s, CaptureTimeSource.RECEIPT, max(off_s, RECEIPT_BOUND_S))

    def _latest_s(self, component: int, source: CaptureTimeSource) -> float:
        """Return how late a photo may be for its time to count."""
        if component == AUTOPILOT and source is CaptureTimeSource.VEHICLE_CLOCK:
            return RECEIPT_BOUND_S
        return ASKED_AGAIN_S if (component, source) in self._right_clocks else UTC_BOUND_S

    def _note_clock(self, component: int, source: CaptureTimeSource, late_s: float) -> None:
        if late_s <= UTC_BOUND_S:
            self._right_clocks.add((component, source))

    def _aimed(self, report: CaptureMessage, own: ReportedAttitude | None, source: AttitudeSource, now_s: float) -> CaptureMessage:
        """Return the report with the best attitude: the camera's, else the gimbal's, else the vehicle's."""
        heading_deg = self._fresh_attitude(now_s).yaw_deg
        gimbal = self._gimbal(now_s)
        if source is AttitudeSource.VEHICLE and own is not None:
            heading_deg = own.yaw_deg
        if gimbal is not None and (own is None or source is AttitudeSource.VEHICLE):
            own, source = gimbal.in_earth(heading_deg), AttitudeSource.GIMBAL
        if own is None:
            own, source = self._fresh_attitude(now_s), AttitudeSource.VEHICLE
        if own.pitch_deg is None:
            return report
        return replace(
            report, roll_deg=own.roll_deg, pitch_deg=own.pitch_deg, yaw_deg=own.yaw_deg, yaw_frame=own.frame, attitude_source=source
        )

    def _placed(self, report: CaptureMessage, latitude_e7: int, longitude_e7: int, now_s: float) -> CaptureMessage:
        """Return the report with the photo's own position, else with the vehicle's last, whose age widens the bound."""
        place = self._place if self._place is not None and now_s - self._place.received_s <= FRESH_S else None
        speed_mps = 0.0 if place is None else place.speed_mps
        if is_place(latitude_e7, longitude_e7):
            bound_m = self._gps_m + speed_mps * SHUTTER_S
            return replace(
                report, longitude_deg=longitude_e7 / E7, latitude_deg=latitude_e7 / E7, position_source=PositionSource.PHOTO,
                position_bound_m=bound_m,
            )  # fmt: skip
        if place is None:
            return report
        bound_m = self._gps_m + speed_mps * (SHUTTER_S + max(now_s - place.received_s, 0.0) + (report.time_bound_s or 0.0))
        return replace(
            report, longitude_deg=place.longitude_deg, latitude_deg=place.latitude_deg, position_source=PositionSource.VEHICLE,
            position_bound_m=bound_m, altitude_amsl_m=_height(place.amsl_m), altitude_relative_m=_height(place.relative_m),
        )  # fmt: skip

    def _fresh_attitude(self, now_s: float) -> ReportedAttitude:
        is_fresh = self._attitude is not None and now_s - self._attitude[0] <= FRESH_S
        return self._attitude[1] if is_fresh and self._attitude is not None else ReportedAttitude()

    def _gimbal(self, now_s: float) -> ReportedAttitude | None:
        """Return the present attitude of the only gimbal; None with several, as it is unknown which holds the camera."""
        fresh = {who: attitude for who, (at_s, attitude) in self._gimbals.items() if now_s - at_s <= FRESH_S}
        named = {who: attitude for who, attitude in fresh.items() if who[0] == "GIMBAL_DEVICE_ATTITUDE_STATUS"} or fresh
        return next(iter(named.values())) if len(named) == 1 else None

    @staticmethod
    def _place_stamp(message: Message) -> str:
        """Return what distinguishes two photos without a time: where they were taken. Empty without a position."""
        longitude = message.lng if message.get_type() == "CAMERA_FEEDBACK" else message.lon
        if not is_place(message.lat, longitude):
            return ""
        heights = (message.alt_msl,) if message.get_type() == "CAMERA_FEEDBACK" else (message.alt, *message.q)
        return struct.pack(f"<{2 + len(heights)}d", message.lat, longitude, *heights).hex()


def _key(source: CaptureSource, component: int, camera: int, index: int, stamp: int | str) -> str:
    return hashlib.sha256(f"{source} {component} {camera} {index} {stamp}".encode()).hexdigest()[:32]


def _unwrapped(boot_s: float, clock: VehicleTime, now_s: float) -> float:
    """Return the latest time since boot that 32 bits of microseconds show so."""
    if boot_s >= WRAP_S or not clock.boots or clock.boots[-1].clock.offset_s is None:
        return boot_s
    present = clock.boots[-1].clock
    return boot_s + WRAP_S * max(round(((now_s - (present.offset_s or 0.0)) * present.rate - boot_s) / WRAP_S), 0)


def _height(height_m: float) -> float | None:
    """Return a height; None for what none can be, and for exactly 0, which senders without one send."""
    return height_m if math.isfinite(height_m) and height_m != 0.0 and HEIGHTS_M[0] <= height_m <= HEIGHTS_M[1] else None


def _url(text: str | bytes) -> str:
    words = text.decode(errors="replace") if isinstance(text, bytes) else text
    return "".join(letter for letter in words.split("\0", 1)[0] if letter.isprintable())[:MAX_URL_LENGTH]
