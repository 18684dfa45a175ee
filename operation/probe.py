"""Probe for programs that serve no requests: python -m operation.probe [live | ready]

Requests /healthz or /readyz from the process at SPANWISE_METRICS (or the address after the word). Exit code 0 yes, 1 no or no response, 2
no address. Needs only the standard library, as it is started every few seconds.
"""

import http.client
import socket
import sys

from operation.address import Address, WrongAddress, address_of, address_of_environment

PATHS = {"live": "/healthz", "ready": "/readyz"}
TIMEOUT_S = 5.0


class _Connection(http.client.HTTPConnection):
    def __init__(self, address: Address) -> None:
        super().__init__("localhost", timeout=TIMEOUT_S)
        self._address = address

    def connect(self) -> None:
        address = self._address
        if address.path:
            self.sock = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
            self.sock.settimeout(TIMEOUT_S)
            self.sock.connect(address.path)
        else:
            host = {"0.0.0.0": "127.0.0.1", "::": "::1"}.get(address.host, address.host)  # noqa: S104 - an address to connect to
            self.sock = socket.create_connection((host, address.port), TIMEOUT_S)


def main(arguments: list[str]) -> int:
    asked, *rest = arguments or ["live"]
    if asked not in PATHS or len(rest) > 1:
        print(__doc__, file=sys.stderr)
        return 2
    try:
        address = address_of(rest[0]) if rest else address_of_environment()
    except WrongAddress as error:
        print(error, file=sys.stderr)
        return 2
    if address is None:
        print("SPANWISE_METRICS is empty: there is nowhere to ask", file=sys.stderr)
        return 2
    try:
        connection = _Connection(address)
        connection.request("GET", PATHS[asked])
        answer = connection.getresponse()
        print(answer.read().decode(errors="replace").strip())
    except (OSError, http.client.HTTPException) as error:
        print(f"no answer at {address}: {error}", file=sys.stderr)
        return 1
    return 0 if answer.status == 200 else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
