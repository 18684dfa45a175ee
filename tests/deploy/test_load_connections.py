"""Locust's client keeps its connections, those with high file descriptors, too; skipped where Locust is not installed."""

import os
import resource
import socket
from collections.abc import Iterator

import pytest

MAX_SELECT_KNOWS = 1_024
NO_LOCUST = "Locust is not installed: requirements-benchmarks.txt has it"


@pytest.fixture
def pair() -> Iterator[tuple[socket.socket, socket.socket]]:
    """Two ends, the first with a file descriptor that select(2) does not know."""
    before = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (max(before[0], 2 * MAX_SELECT_KNOWS), before[1]))
    here, there = socket.socketpair()
    high = socket.socket(fileno=os.dup2(here.detach(), MAX_SELECT_KNOWS + 100))
    with high, there:
        yield high, there
    resource.setrlimit(resource.RLIMIT_NOFILE, before)


def test_an_open_connection_is_kept_and_one_that_has_ended_is_not(
    pair: tuple[socket.socket, socket.socket], monkeypatch: pytest.MonkeyPatch
) -> None:
    ConnectionPool = pytest.importorskip("geventhttpclient.connectionpool", reason=NO_LOCUST).ConnectionPool  # noqa: N806 - a class
    monkeypatch.setattr(ConnectionPool, "_is_socket_alive", ConnectionPool._is_socket_alive)  # brought back afterwards
    pytest.importorskip("deploy.load.kept_connections").keep_all_connections()
    pool = ConnectionPool("localhost", 1, "localhost", 1)
    mine, theirs = pair
    assert pool._is_socket_alive(mine)
    theirs.close()
    assert not pool._is_socket_alive(mine)
    mine.close()
    assert not pool._is_socket_alive(mine)
    assert not pool._is_socket_alive(None)
