"""What kind of vehicle it is: version and capabilities."""

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.frames import Message
from simulation.vehicle_protocol.flavour import Flavour

CAPABILITIES = (
    mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_FLOAT | mavlink.MAV_PROTOCOL_CAPABILITY_PARAM_FLOAT
    | mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_INT | mavlink.MAV_PROTOCOL_CAPABILITY_COMMAND_INT
    | mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_FENCE | mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_RALLY
    | mavlink.MAV_PROTOCOL_CAPABILITY_MAVLINK2
)  # fmt: skip
DEVELOPMENT = 0  # of the firmware's types: one that is no release is not compared with the latest release
VERSIONS = {Flavour.PX4: (1, 15, 0), Flavour.ARDUPILOT: (4, 6, 0)}
VENDOR, PRODUCT = 0x5350, 0x5349


def version(flavour: Flavour, system: int) -> Message:
    """Its unique id is its system id, with letters before it that tell a simulated UAV."""
    major, minor, patch = VERSIONS[flavour]
    firmware = major << 24 | minor << 16 | patch << 8 | DEVELOPMENT
    nothing = [0] * 8
    unique = int.from_bytes(b"SIMUAV\0\0", "big") | system
    return mavlink.MAVLink_autopilot_version_message(
        CAPABILITIES, firmware, firmware, 0, 0, nothing, nothing, nothing, VENDOR, PRODUCT, unique
    )
