"""Several of each program, with the commands of ./run: a replica has its own name, folder, sockets and ports."""

import socket
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from scripts import commands
from scripts.places import Places, health_socket
from scripts.supervision.programs import Program, web_programs

KINDS = (
    "web",
    "uav-link",
    "live",
    "worker-data",
    "worker-flight",
    "worker-planning",
    "worker-proofs",
    "worker-simulation",
    "gateway",
    "estimator",
    "simulator",
    "beat",
)
PORTS_OF_SIMULATIONS = 200


def free_port(kind: socket.SocketKind = socket.SOCK_STREAM) -> int:
    with socket.socket(type=kind) as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def name_of(kind: str, number: int) -> str:
    """As ./run names them: web-1, web-2; live, live-2."""
    return kind if number == 1 and kind != "web" else f"{kind}-{number}"


def kind_of(name: str) -> str:
    """What `name_of` was made of."""
    return next(
        kind for kind in (*KINDS, "proxy") if name == kind or (name.startswith(f"{kind}-") and name.removeprefix(f"{kind}-").isdigit())
    )


def replicas(places: Places, sockets: Path, counts: Mapping[str, int]) -> list[Program]:
    """So many of each kind as `counts` says, in the order of ./run."""
    shipped = {program.name: program for program in web_programs(places, sockets)}
    return [
        _again(shipped[name_of(kind, 1)], name_of(kind, number), places, sockets)
        for kind in KINDS
        for number in range(1, counts.get(kind, 0) + 1)
    ]


def at_address(program: Program, host: str, port: int) -> Program:
    """The same web, live or uav-link program at a port, as in a container, in place of a unix socket."""
    command = {"web": commands.web, "live": commands.live, "uav-link": commands.uav_link}[kind_of(program.name)]
    return replace(program, command=command("--host", host, "--port", str(port)), stale_files=[])


def _again(first: Program, name: str, places: Places, sockets: Path) -> Program:
    kind = kind_of(name)
    if name == first.name:
        program = first
    else:
        moved = {
            str(sockets / f"{first.name}.sock"): str(sockets / f"{name}.sock"),
            f"{kind.removeprefix('worker-')}@%h": f"{name.removeprefix('worker-')}@%h",
        }
        program = replace(
            first,
            name=name,
            folder=places.process(name),
            command=[moved.get(message, message) for message in first.command],
            stale_files=[Path(moved.get(str(path), str(path))) for path in first.stale_files],
            environment=_reported_as(first.environment, name, places, sockets),
        )
    return replace(program, environment=program.environment | _own_settings(kind, name))


def _reported_as(environment: Mapping[str, str], name: str, places: Places, sockets: Path) -> dict[str, str]:
    own = dict(environment)
    if "SPANWISE_METRICS" in own:
        own |= {"SPANWISE_PROGRAM": name, "SPANWISE_METRICS": f"unix:{health_socket(sockets, name)}"}
    if "PROMETHEUS_MULTIPROC_DIR" in own:
        own["PROMETHEUS_MULTIPROC_DIR"] = str(places.process(name) / "metrics")
    return own


def _own_settings(kind: str, name: str) -> dict[str, str]:
    match kind:
        case "gateway":
            return {
                "SPANWISE_GATEWAY_NAME": name,
                "SPANWISE_GATEWAY_UDP": f"127.0.0.1:{free_port(socket.SOCK_DGRAM)}",
                "SPANWISE_GATEWAY_TCP": f"127.0.0.1:{free_port()}",
            }
        case "estimator":
            return {"SPANWISE_ESTIMATOR_NAME": name}
        case "simulator":
            return {"SPANWISE_SIMULATOR_NAME": name}
    return {}


def ports_of_simulations() -> str:
    """A range of UDP ports that nobody holds just now, below those that the system gives away: FIRST-LAST."""
    for first in range(20_000, 32_000, PORTS_OF_SIMULATIONS):
        try:
            for port in (first, first + PORTS_OF_SIMULATIONS // 2, first + PORTS_OF_SIMULATIONS - 1):
                with socket.socket(type=socket.SOCK_DGRAM) as probe:
                    probe.bind(("127.0.0.1", port))
        except OSError:
            continue
        return f"{first}-{first + PORTS_OF_SIMULATIONS - 1}"
    raise RuntimeError("no range of UDP ports is free")
