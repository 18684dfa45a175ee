"""Replicas for the load tests: the programs of ./run, each with what is its own."""

import os
import signal
import ssl
import subprocess
import sys
from pathlib import Path

from deploy.load.certificates import make_authority, make_certificate
from deploy.load.scaling.replicas import at_address, kind_of, name_of, replicas
from deploy.load.usage import usage
from scripts.places import WEB_PROGRAMS, Places
from scripts.supervision.programs import web_programs

SOCKETS = Path("/sockets")
OWN = ("SPANWISE_GATEWAY", "SPANWISE_ESTIMATOR", "SPANWISE_SIMULATOR")  # names and ports that ./run leaves to chance


def test_the_first_replicas_are_those_of_run(tmp_path: Path) -> None:
    shipped = {program.name: program for program in web_programs(Places(tmp_path), SOCKETS)}
    counts = dict.fromkeys(map(kind_of, shipped), 1) | {"web": len(WEB_PROGRAMS), "proxy": 0}
    for program in replicas(Places(tmp_path), SOCKETS, counts):
        first = shipped.pop(program.name)
        assert (program.command, program.folder, program.stop_signal) == (first.command, first.folder, first.stop_signal)
        assert {name: value for name, value in program.environment.items() if not name.startswith(OWN)} == first.environment
    assert list(shipped) == ["proxy"]


def test_a_further_replica_shares_nothing_with_the_first(tmp_path: Path) -> None:
    programs = {one.name: one for one in replicas(Places(tmp_path), SOCKETS, {"web": 3, "live": 2, "worker-planning": 2, "gateway": 2})}
    assert list(programs) == ["web-1", "web-2", "web-3", "live", "live-2", "worker-planning", "worker-planning-2", "gateway", "gateway-2"]
    assert len({program.folder for program in programs.values()}) == len(programs)
    assert len({program.environment["SPANWISE_METRICS"] for program in programs.values()}) == len(programs)
    assert programs["web-3"].stale_files == [SOCKETS / "web-3.sock"]
    assert str(SOCKETS / "web-3.sock") in programs["web-3"].command
    assert "planning-2@%h" in programs["worker-planning-2"].command
    assert programs["worker-planning-2"].environment["PROMETHEUS_MULTIPROC_DIR"].endswith("worker-planning-2/metrics")
    first, second = (programs[name].environment["SPANWISE_GATEWAY_UDP"] for name in ("gateway", "gateway-2"))
    assert first != second


def test_names_lead_to_kinds_and_back() -> None:
    for kind, number, name in (
        ("web", 1, "web-1"),
        ("live", 1, "live"),
        ("worker-planning", 2, "worker-planning-2"),
        ("proxy", 1, "proxy"),
    ):
        assert (name_of(kind, number), kind_of(name)) == (name, kind)


def test_a_replica_at_an_address_listens_as_in_a_container(tmp_path: Path) -> None:
    (program,) = replicas(Places(tmp_path), SOCKETS, {"live": 1})
    moved = at_address(program, "127.0.0.9", 8_001)
    place = moved.command.index("--host")
    assert moved.command[place : place + 4] == ["--host", "127.0.0.9", "--port", "8001"]
    assert "--uds" not in moved.command
    assert moved.stale_files == []


def test_the_certificate_is_good_for_this_machine_alone(tmp_path: Path) -> None:
    authority = make_authority(tmp_path)
    before = make_certificate(tmp_path)[0].read_text()
    certificate, key = make_certificate(tmp_path)
    assert certificate.read_text() != before
    assert key.stat().st_mode & 0o777 == 0o600
    command = ["openssl", "verify", "-CAfile", str(authority), str(certificate)]
    reported = subprocess.run(command, capture_output=True, text=True, check=True)
    assert "OK" in reported.stdout
    assert make_authority(tmp_path).read_text() == authority.read_text()
    ssl.create_default_context(cafile=str(authority))


def test_usage_counts_a_process_with_those_below_it() -> None:
    command = [sys.executable, "-c", "import subprocess, sys; subprocess.run([sys.executable, '-c', 'input()'])"]
    with subprocess.Popen(command, stdin=subprocess.PIPE, start_new_session=True) as parent:
        try:
            while (found := usage({"parent": [parent.pid], "gone": []}))["parent"].processes < 2:
                assert parent.poll() is None
            assert found["parent"].resident_bytes > 0
            assert found["gone"].processes == 0
        finally:
            os.killpg(parent.pid, signal.SIGKILL)
