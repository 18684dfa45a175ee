"""PostgreSQL and Redis with TLS as deployments have them: every way to them verifies the certificate, and none goes without it."""

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from deploy.proof.servers import Servers, running_servers
from scripts.places import PROJECT_DIR

pytestmark = pytest.mark.long

LOOPBACK = "127.0.0.1/32"
WAYS_TO_REDIS = ("cached", "queue", "pages", "hints")
WAYS = ("database", "dump", *WAYS_TO_REDIS)


@pytest.fixture(scope="module")
def servers() -> Iterator[Servers]:
    if os.geteuid() != 0:
        pytest.skip("PostgreSQL runs as a user of its own: this needs root")
    with tempfile.TemporaryDirectory(prefix="sw-tls-") as folder, running_servers(Path(folder), LOOPBACK) as servers:
        yield servers


def addresses(servers: Servers, host: str = "localhost", authority: Path | None = None) -> dict[str, str]:
    """As deploy/make-secrets writes them, but for where the servers and the authority's certificate are."""
    authority = authority or servers.secrets / "ca.crt"
    named = {"DATABASE_URL": servers.database_url, "REDIS_URL": servers.redis_url}
    reported = {name: url.replace("/run/secrets/ca-certificate", str(authority)) for name, url in named.items()}
    return {name: url.replace("@postgresql:", f"@{host}:").replace("@redis:", f"@{host}:") for name, url in reported.items()}


def tried(folder: Path, addresses: dict[str, str]) -> dict[str, str]:
    """What came of each way."""
    own = {"SPANWISE_VAR": str(folder), "SPANWISE_SECRET_KEY": "of-the-test", "DJANGO_SETTINGS_MODULE": "config.settings"}
    done = subprocess.run(
        [sys.executable, "-m", "tests.deploy.tls_clients"],
        cwd=PROJECT_DIR, env=os.environ | own | addresses, capture_output=True, text=True, check=False, timeout=600,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    reported: dict[str, str] = json.loads(done.stdout.splitlines()[-1])
    assert set(reported) == set(WAYS)
    return reported


def refused(reported: dict[str, str]) -> set[str]:
    return {way for way, stated in reported.items() if stated.startswith("refused")}


def test_every_way_to_the_servers_speaks_tls(servers: Servers, tmp_path: Path) -> None:
    reported = tried(tmp_path, addresses(servers))
    assert refused(reported) == set(), json.dumps(reported)
    assert reported["database"] in {"TLSv1.2", "TLSv1.3"}


def test_a_server_with_another_name_than_its_certificate_is_refused(servers: Servers, tmp_path: Path) -> None:
    assert refused(tried(tmp_path, addresses(servers, host="127.0.0.1"))) == set(WAYS)


def test_a_server_that_another_authority_has_signed_is_refused(servers: Servers, tmp_path: Path) -> None:
    other = tmp_path / "other.crt"
    make = ["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-subj", "/CN=Another"]
    subprocess.run([*make, "-keyout", str(tmp_path / "other.key"), "-out", str(other)], check=True, capture_output=True)
    assert refused(tried(tmp_path, addresses(servers, authority=other))) == set(WAYS)


def test_nobody_gets_in_without_tls(servers: Servers, tmp_path: Path) -> None:
    plain = addresses(servers)
    plain["DATABASE_URL"] = plain["DATABASE_URL"].partition("?")[0] + "?sslmode=disable"
    plain["REDIS_URL"] = plain["REDIS_URL"].partition("?")[0].replace("rediss://", "redis://")
    assert refused(tried(tmp_path, plain)) == set(WAYS)


def test_a_backup_is_made_and_brought_back_by_a_role_without_rights_of_its_own(servers: Servers, tmp_path: Path) -> None:
    """As in a deployment: the role is no superuser, and PostGIS belongs to somebody else."""
    own = {"SPANWISE_VAR": str(tmp_path), "SPANWISE_SECRET_KEY": "of-the-test", "DJANGO_SUPERUSER_PASSWORD": "nobody-guesses-it-48"}

    def run(*command: str) -> str:
        done = subprocess.run(
            [sys.executable, *command],
            cwd=PROJECT_DIR, env=os.environ | own | addresses(servers), capture_output=True, text=True, check=False, timeout=600,
        )  # fmt: skip
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    def count(*also: str) -> int:
        program = "from workspace.models import User; " + "; ".join(also or ["pass"]) + "; print(User.objects.count())"
        return int(run("manage.py", "shell", "-v", "0", "-c", program).splitlines()[-1])

    run("manage.py", "migrate", "--no-input")
    run("manage.py", "createsuperuser", "--no-input", "--username", "somebody", "--email", "somebody@example.org")
    assert count() == 1
    run("-m", "scripts.backups", "backup", str(tmp_path / "kept"), "--without-key")
    assert count("User.objects.all().delete()") == 0
    run("-m", "scripts.backups", "restore", str(tmp_path / "kept"), "--replace")
    assert count() == 1
