"""PostgreSQL and Redis for the proof, with TLS and passwords as in a deployment, on this machine's own packages."""

import os
import shutil
import socket
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from scripts.installation.postgresql_installations import installed_servers
from scripts.installation.system_packages import find_program
from scripts.places import DATABASE_USER, PROJECT_DIR

TIMEOUT_S = 60.0


@dataclass(frozen=True)
class Servers:
    """Addresses as a pod uses them: `host` is a name that its certificate is for."""

    database_url: str
    redis_url: str
    secrets: Path


def free_port() -> int:
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return int(listener.getsockname()[1])


def _as_database_user(command: list[str]) -> list[str]:
    return ["runuser", "-u", DATABASE_USER, "--", *command]


def _own(source: Path, target: Path) -> Path:
    """A copy that only PostgreSQL's user reads."""
    shutil.copyfile(source, target)
    shutil.chown(target, DATABASE_USER, DATABASE_USER)
    target.chmod(0o400)
    return target


@contextmanager
def running_servers(folder: Path, subnet: str) -> Iterator[Servers]:
    """Until the end of the block. Only `subnet` is let in. Needs root, as PostgreSQL runs as a user of its own."""
    secrets = folder / "secrets"
    subprocess.run([PROJECT_DIR / "deploy" / "make-secrets", "spanwise.example.org", secrets], check=True, capture_output=True)
    database_port, redis_port = free_port(), free_port()
    server = next(found for found in installed_servers() if found.has_postgis)
    data = folder / "postgresql"
    data.mkdir()
    folder.chmod(0o711)
    shutil.chown(data, DATABASE_USER, DATABASE_USER)
    subprocess.run(
        _as_database_user([server.program("initdb"), "-D", str(data), "-U", "postgres", "-A", "trust", "-E", "UTF8", "--no-sync"]),
        check=True, capture_output=True, cwd="/",
    )  # fmt: skip
    (data / "pg_hba.conf").write_text(f"local all all trust\nhostssl all all {subnet} scram-sha-256\n")
    settings = {
        "listen_addresses": "*", "port": str(database_port), "unix_socket_directories": str(data), "jit": "off", "fsync": "off",
        "max_connections": "200", "ssl": "on", "ssl_min_protocol_version": "TLSv1.2",
        "ssl_cert_file": str(_own(secrets / "postgresql.crt", data / "server.crt")),
        "ssl_key_file": str(_own(secrets / "postgresql.key", data / "server.key")),
    }  # fmt: skip
    options = [word for name, value in settings.items() for word in ("-c", f"{name}={value}")]
    redis_settings = folder / "redis.conf"
    redis_settings.write_text(f"requirepass {(secrets / 'redis-password').read_text()}")
    redis_settings.chmod(0o600)
    redis_options = ["--port", "0", "--tls-port", str(redis_port), "--tls-auth-clients", "no", "--bind", "*", "--save", ""]
    for name, file in (("cert", "redis.crt"), ("key", "redis.key"), ("ca-cert", "ca.crt")):
        redis_options += [f"--tls-{name}-file", str(secrets / file)]
    log = (folder / "servers.log").open("wb")
    database = subprocess.Popen(_as_database_user([server.program("postgres"), "-D", str(data), *options]), stdout=log, stderr=log, cwd="/")
    redis = subprocess.Popen(
        [find_program("redis-server") or "redis-server", str(redis_settings), *redis_options], stdout=log, stderr=log, cwd=folder
    )
    try:
        _make_database(server.program("psql"), data, database_port, (secrets / "database-password").read_text().strip())
        yield Servers(
            (secrets / "database-url").read_text().strip().replace(":5432/", f":{database_port}/"),
            (secrets / "redis-url").read_text().strip().replace(":6379/", f":{redis_port}/"),
            secrets,
        )
    finally:
        for process in (database, redis):
            process.terminate()
        for process in (database, redis):
            process.wait(TIMEOUT_S)
        log.close()


def _make_database(psql: str, sockets: Path, port: int, password: str) -> None:
    """With the very script of the deployment's own PostgreSQL, apart from where it finds the password."""
    script = (PROJECT_DIR / "deploy" / "kubernetes" / "components" / "database" / "make-database.sh").read_text()
    statements = script.partition("<<'SQL'\n")[2].partition("\nSQL")[0]
    end_s = time.monotonic() + TIMEOUT_S
    ready = [psql, "-h", str(sockets), "-p", str(port), "-U", "postgres", "-d", "postgres", "-qc", "SELECT 1"]
    while subprocess.run(ready, capture_output=True, check=False).returncode != 0:
        if time.monotonic() > end_s:
            raise TimeoutError("PostgreSQL does not answer")
        time.sleep(0.1)
    subprocess.run(
        [*ready[:-2], "-q", "--set=ON_ERROR_STOP=1", f"--set=password={password}"],
        input=statements, text=True, check=True, capture_output=True, env=os.environ | {"PGOPTIONS": "-c client_min_messages=warning"},
    )  # fmt: skip
