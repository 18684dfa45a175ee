"""Bring up the loopback interface of a new network namespace, then exec the given program.

unshare --net python -m scripts.test_run.loopback PROGRAM [ARGUMENT...]
"""

import fcntl
import os
import socket
import struct
import sys

GET_FLAGS, SET_FLAGS, UP = 0x8913, 0x8914, 0x1  # SIOCGIFFLAGS, SIOCSIFFLAGS, IFF_UP of linux/sockios.h and linux/if.h
REQUEST = struct.Struct("16sh14x")


def bring_up(interface: bytes = b"lo") -> None:
    """Bring up an interface. Raises OSError where that is not permitted."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as asked:
        _name, flags = REQUEST.unpack(fcntl.ioctl(asked, GET_FLAGS, REQUEST.pack(interface, 0)))
        fcntl.ioctl(asked, SET_FLAGS, REQUEST.pack(interface, flags | UP))


if __name__ == "__main__":
    bring_up()
    os.execvp(sys.argv[1], sys.argv[1:])  # noqa: S606 - no shell
