"""Create the private PostgreSQL's data folder and database, and wait for the servers."""

import os
import shutil
import subprocess
import time
from pathlib import Path

import psycopg
import redis

from config.private_servers import DATABASE_NAME, DATABASE_ROLE
from scripts.installation.postgresql_installations import server_for
from scripts.places import CannotStart, Places, database_user_id

START_TIMEOUT_S = 60.0


def prepare_cluster(places: Places) -> bool:
    """Create PostgreSQL's data folder if it is missing; returns whether it did. An interrupted attempt leaves nothing usable."""
    data = places.data
    if (data / "PG_VERSION").exists():
        return False
    server = server_for(data)
    if server is None:
        raise CannotStart("no PostgreSQL 15 or newer with PostGIS on this machine")
    draft = data.with_name(f"{data.name}.new")
    shutil.rmtree(draft, ignore_errors=True)
    draft.mkdir(mode=0o700, parents=True)
    user = database_user_id()
    if os.geteuid() == 0:
        os.chown(draft, user, draft.parent.stat().st_gid)
    command = [server.program("initdb"), "-D", str(draft), "-U", DATABASE_ROLE, "-A", "trust", "-E", "UTF8", "--locale=C.UTF-8"]
    # Trust is limited to the socket folder, which other users cannot enter; there is no network socket.
    answer = subprocess.run(
        command, user=user, extra_groups=[] if os.geteuid() == 0 else None, cwd="/", capture_output=True, text=True, check=False
    )
    if answer.returncode != 0:
        raise CannotStart(f"initdb failed:\n{answer.stdout}{answer.stderr}")
    draft.rename(data)
    if not data.is_relative_to(places.state):
        print(f"PostgreSQL's data are in {data}, since its user cannot reach {places.state}", flush=True)
    return True


def wait_for_database(sockets: Path) -> None:
    """Return once PostgreSQL accepts connections, after crash recovery if necessary."""
    deadline = time.monotonic() + START_TIMEOUT_S
    while True:
        try:
            psycopg.connect(host=str(sockets), user=DATABASE_ROLE, dbname="postgres", connect_timeout=5).close()
        except psycopg.OperationalError as error:
            if time.monotonic() > deadline:
                raise CannotStart(f"PostgreSQL does not answer: {error}") from None
            time.sleep(0.05)
        else:
            return


def wait_for_queue(sockets: Path) -> None:
    """Return once Redis responds, after loading its append-only file if necessary."""
    deadline = time.monotonic() + START_TIMEOUT_S
    client = redis.Redis(unix_socket_path=str(sockets / "redis.sock"), socket_timeout=5)
    while True:
        try:
            client.ping()
        except (redis.ConnectionError, redis.TimeoutError) as error:
            if time.monotonic() > deadline:
                raise CannotStart(f"Redis does not answer: {error}") from None
            time.sleep(0.05)
        else:
            client.close()
            return


def database_exists(sockets: Path) -> bool:
    with psycopg.connect(host=str(sockets), user=DATABASE_ROLE, dbname="postgres") as connection:
        return connection.execute("SELECT 1 FROM pg_database WHERE datname = %s", [DATABASE_NAME]).fetchone() is not None


def create_database(sockets: Path) -> None:
    with psycopg.connect(host=str(sockets), user=DATABASE_ROLE, dbname="postgres", autocommit=True) as connection:
        connection.execute(f'CREATE DATABASE "{DATABASE_NAME}"')
