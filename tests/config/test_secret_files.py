"""Secrets by their files, and addresses with TLS as they reach the libraries."""

from pathlib import Path

import dj_database_url
import pytest
from redis import ConnectionPool, SSLConnection

from config.environment import SecretUnreadable, secret
from config.private_servers import broker_url


def test_a_secret_may_come_from_a_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "key"
    path.write_text("from a file\n")
    monkeypatch.setenv("SPANWISE_TOLD_FILE", str(path))
    assert secret("SPANWISE_TOLD") == "from a file"
    monkeypatch.setenv("SPANWISE_TOLD", "from the environment")
    assert secret("SPANWISE_TOLD") == "from the environment"
    assert secret("SPANWISE_NOT_TOLD", "a default") == "a default"


def test_a_file_that_cannot_be_read_is_no_default(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SPANWISE_TOLD_FILE", str(tmp_path / "nothing"))
    with pytest.raises(SecretUnreadable, match="SPANWISE_TOLD_FILE"):
        secret("SPANWISE_TOLD", "a default")


def test_a_database_with_a_verified_certificate_is_asked_for_in_its_address() -> None:
    found = dj_database_url.parse("postgis://spanwise:x@postgresql:5432/spanwise?sslmode=verify-full&sslrootcert=/run/trust/ca.crt")
    assert found["OPTIONS"] == {"sslmode": "verify-full", "sslrootcert": "/run/trust/ca.crt"}


def test_redis_with_a_verified_certificate_is_asked_for_in_its_address() -> None:
    address = "rediss://:x@redis:6379/0?ssl_cert_reqs=required&ssl_ca_certs=/run/trust/ca.crt"
    pool = ConnectionPool.from_url(address)
    assert pool.connection_class is SSLConnection
    assert pool.connection_kwargs["ssl_ca_certs"] == "/run/trust/ca.crt"
    assert broker_url(address) == address
