"""MAVLink without sockets, database and clock: frames, missions as items, mission sync, commands and decoding. Pure."""

from mavlink import reasons as reasons
