"""The image's entry point: what it becomes, and what it refuses."""

import re
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

from scripts.container import container, container_health, container_proxy
from scripts.development import sbom
from scripts.installation.system_packages import find_program
from scripts.places import PROJECT_DIR
from scripts.proxy.proxy import site_configuration
from scripts.proxy.served_certificate import ServedCertificate
from tests.deploy.conftest import DEPLOY


@pytest.mark.parametrize("name", sorted(container.PROGRAMS))
def test_every_name_becomes_a_command(name: str) -> None:
    assert container.PROGRAMS[name]()[0] == sys.executable


def test_each_worker_takes_its_own_queue() -> None:
    for queue in ("data", "flight", "planning", "proofs", "simulation"):
        command = container.PROGRAMS[f"worker-{queue}"]()
        assert command[command.index("--queues") + 1] == queue


def test_a_container_without_its_secrets_does_not_start(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    for name in container.SECRETS:
        monkeypatch.delenv(name, raising=False)
        monkeypatch.delenv(f"{name}_FILE", raising=False)
    assert container.main(["web"]) == container.EXIT_WRONG
    assert "SPANWISE_SECRET_KEY" in capsys.readouterr().err


def test_a_name_that_is_no_program_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert container.main(["shell"]) == container.EXIT_WRONG
    assert "worker-planning" in capsys.readouterr().err


def test_sigterm_ends_a_worker_softly() -> None:
    assert container.environment("worker-planning")["REMAP_SIGTERM"] == "SIGQUIT"
    assert "REMAP_SIGTERM" not in container.environment("web")


def test_memory_is_taken_from_two_pools_unless_the_site_says_otherwise(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("MALLOC_ARENA_MAX", raising=False)
    assert container.environment("web")["MALLOC_ARENA_MAX"] == "2"
    monkeypatch.setenv("MALLOC_ARENA_MAX", "8")
    assert container.environment("web")["MALLOC_ARENA_MAX"] == "8"


@pytest.mark.parametrize(
    ("command_line", "program"),
    [
        (b"/usr/bin/tini\0--\0spanwise\0proxy\0", "proxy"),
        (b"/usr/bin/tini\0--\0spanwise\0worker-data\0--loglevel\0INFO\0", "worker-data"),
        (b"/usr/bin/tini\0--\0spanwise\0", "web"),
    ],
)
def test_health_asks_the_program_that_the_container_was_started_as(command_line: bytes, program: str) -> None:
    assert container_health.program(command_line) == program


def test_health_never_asks_the_database(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("SPANWISE_METRICS", raising=False)
    assert container_health.address("web") == "http://127.0.0.1:9464/healthz"
    assert container_health.address("proxy").endswith("/proxy-alive")


@pytest.mark.parametrize(
    ("text", "server"),
    [("search a b\nnameserver 10.0.0.10\nnameserver 10.0.0.11\n", "10.0.0.10"), ("nameserver fd00::a\n", "[fd00::a]"), ("", "")],
)
def test_the_proxy_asks_the_containers_name_server(text: str, server: str) -> None:
    assert container_proxy.name_server(text) == server


def proxy_configuration(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, **settings: str) -> str:
    for name in ("SPANWISE_HTTPS", "SPANWISE_TLS_CERTIFICATE", "SPANWISE_TLS_KEY", "SPANWISE_PROXY_WEB", "SPANWISE_PROXY_RESOLVES"):
        monkeypatch.delenv(name, raising=False)
    for name, value in settings.items():
        monkeypatch.setenv(name, value)
    monkeypatch.setattr(container_proxy, "NAME_SERVERS", tmp_path / "resolv.conf")
    (tmp_path / "resolv.conf").write_text("nameserver 127.0.0.1\n")
    text = site_configuration(container_proxy.site_of_environment(tmp_path))
    nginx = find_program("nginx")
    if nginx is None:
        pytest.skip("nginx is not installed; ./run installs it")
    (tmp_path / "nginx.conf").write_text(text)
    answer = subprocess.run(
        [nginx, "-e", "stderr", "-p", str(tmp_path), "-t", "-c", str(tmp_path / "nginx.conf")], capture_output=True, text=True, check=False
    )
    assert "test is successful" in answer.stderr, answer.stderr
    return text


def test_behind_an_ingress_the_proxy_asks_for_names_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = proxy_configuration(tmp_path, monkeypatch, SPANWISE_HTTPS="1", SPANWISE_PROXY_RESOLVES="1", SPANWISE_PROXY_WEB="web.site:8000")
    assert "set $web web.site:8000;" in text
    assert "proxy_pass http://$web;" in text
    assert "return 308 https://$host$request_uri" in text
    assert "Strict-Transport-Security" in text


def test_the_proxy_asks_the_name_server_that_it_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    reported = {"SPANWISE_PROXY_NAME_SERVER": "127.0.0.1:5353", "SPANWISE_PROXY_RESOLVES": "1", "SPANWISE_PROXY_WEB": "web.site:8000"}
    assert "resolver 127.0.0.1:5353 valid=2s;" in proxy_configuration(tmp_path, monkeypatch, **reported)


def test_with_a_certificate_the_proxy_speaks_nothing_older_than_tls_1_2(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    key, certificate = tmp_path / "tls.key", tmp_path / "tls.crt"
    command = ["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-subj", "/CN=x"]
    subprocess.run([*command, "-keyout", str(key), "-out", str(certificate)], check=True, capture_output=True)
    text = proxy_configuration(
        tmp_path, monkeypatch, SPANWISE_HTTPS="1", SPANWISE_TLS_CERTIFICATE=str(certificate), SPANWISE_TLS_KEY=str(key),
        SPANWISE_PROXY_WEB="10.0.0.1:8000,10.0.0.2:8000", SPANWISE_PROXY_LIVE="10.0.0.3:8001",
    )  # fmt: skip
    assert "ssl_protocols TLSv1.2 TLSv1.3;" in text
    assert "ssl_certificate $served_certificate;" in text
    assert 'server "10.0.0.2:8000"' in text
    assert "X-Forwarded-Proto $scheme;" in text
    assert "default $remote_addr;" in text  # nobody in front of it may say who a visitor is


def test_a_new_certificate_is_noticed_and_half_of_one_is_not(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    certificate, key = tmp_path / "tls.crt", tmp_path / "tls.key"
    certificate.write_text("one")
    key.write_text("one")
    monkeypatch.setenv("SPANWISE_TLS_CERTIFICATE", str(certificate))
    monkeypatch.setenv("SPANWISE_TLS_KEY", str(key))
    site = container_proxy.site_of_environment(tmp_path)
    before = container_proxy.fingerprint(site)
    assert container_proxy.fingerprint(site) == before
    key.unlink()
    assert container_proxy.fingerprint(site) == ()
    key.write_text("another")
    assert container_proxy.fingerprint(site) not in {before, ()}


def test_a_certificate_is_served_as_a_whole_and_half_of_one_never(tmp_path: Path) -> None:
    command = ["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-subj", "/CN=x"]
    pairs = [(tmp_path / f"{number}.crt", tmp_path / f"{number}.key") for number in range(3)]
    for certificate, key in pairs:
        subprocess.run([*command, "-keyout", str(key), "-out", str(certificate)], check=True, capture_output=True)
    named = tmp_path / "tls.crt", tmp_path / "tls.key"
    served = ServedCertificate(tmp_path / "served", *named)
    assert not served.take()  # there is none yet
    for pair in pairs:
        named[0].write_bytes(pair[0].read_bytes())
        assert not served.take(), "a new certificate with the key of the one before, or none"
        named[1].write_bytes(pair[1].read_bytes())
        assert served.take()
        assert (served.certificate.read_bytes(), served.key.read_bytes()) == tuple(path.read_bytes() for path in pair)


def test_everything_that_the_image_takes_is_in_the_checkout() -> None:
    for name in re.findall(r"^!(.+)$", (PROJECT_DIR / ".dockerignore").read_text(), re.MULTILINE):
        assert (PROJECT_DIR / name).exists(), name


def test_compose_starts_every_program_and_gives_none_more_rights_than_it_needs() -> None:
    services = yaml.safe_load((DEPLOY / "compose.yaml").read_text())["services"]
    assert {*container.PROGRAMS, "proxy"} <= set(services)
    for name, service in services.items():
        assert service["read_only"], name
        assert service["cap_drop"] == ["ALL"], name
        assert "no-new-privileges:true" in service["security_opt"], name
        assert service.get("privileged") is None, name
    assert [name for name, service in services.items() if service.get("cap_add")] == ["files", "database"]  # they give new volumes away


def test_a_bill_of_materials_names_what_is_installed() -> None:
    bill = sbom.document([*sbom.python_components(), *sbom.node_components(PROJECT_DIR / "package-lock.json")])
    names = {component["name"].lower() for component in bill["components"]}
    assert {"django", "numba", "maplibre-gl"} <= names
    assert "axe-core" not in names  # a tool of developers
    assert bill["metadata"]["component"]["licenses"] == [{"license": {"id": "Apache-2.0"}}]


def test_debians_packages_are_components_with_addresses() -> None:
    (one,) = sbom.debian_components(["tini 0.19.0-1 amd64"])
    assert one["purl"] == "pkg:deb/debian/tini@0.19.0-1?arch=amd64"
