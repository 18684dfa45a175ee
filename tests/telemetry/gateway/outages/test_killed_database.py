"""PostgreSQL is killed while a gateway stores and carries: nothing that was acknowledged is lost, doubled or out of order."""

import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from urllib.parse import quote

import pytest

from config.private_servers import DATABASE_ROLE
from scripts.installation.database_cluster import prepare_cluster
from scripts.places import prepare_sockets, prepare_state, remove_sockets
from tests.telemetry.gateway.program import PROJECT_DIR


@pytest.mark.long
def test_nothing_is_lost_when_the_database_is_killed(capsys, record_property):
    folder = Path(tempfile.mkdtemp(prefix="spanwise-test-"))
    folder.chmod(0o755)  # for PostgreSQL's user
    places = prepare_state(folder / "state")
    sockets = prepare_sockets(places.state)
    try:
        prepare_cluster(places)
        address = f"postgis://{DATABASE_ROLE}@{quote(str(sockets), safe='')}/postgres"
        own = {"DATABASE_URL": address, "SPANWISE_VAR": str(places.state), "DJANGO_SETTINGS_MODULE": "config.settings"}
        command = [sys.executable, "-m", "tests.telemetry.gateway.outages.killed_database", str(places.state), str(sockets)]
        answer = subprocess.run(  # noqa: S603
            command, env=os.environ | own, cwd=PROJECT_DIR, capture_output=True, text=True, timeout=400, check=False
        )
    finally:
        remove_sockets(places.state)
        shutil.rmtree(folder)
    assert answer.returncode == 0, answer.stderr[-3_000:]
    found = json.loads(answer.stdout.splitlines()[-1])
    record_property(
        "figure",
        f"{found['kills']} kills: of {found['told']:,} records {found['lost']} lost, {found['doubled']} doubled; "
        f"of {found['given']:,} commands {found['out_of_order']} out of order",
    )
    with capsys.disabled():
        print(f"\n{found}")
    assert set(found["ends"]) <= {"applied", "expired superseded"} and sum(found["ends"].values()) == found["given"] > 50
    assert {name: found[name] for name in ("out_of_order", "doubled", "lost", "lost_that_were_stored")} == {
        "out_of_order": 0, "doubled": 0, "lost": 0, "lost_that_were_stored": 0,
    }  # fmt: skip
