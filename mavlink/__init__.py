"""MAVLink without sockets, database or clock: frames, mission items, mission sync, commands and decoding. Pure."""

from mavlink import reasons as reasons
