"""What an installation holds at one moment: memory and files of each program, connections, Redis, queues, tables."""

import os
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import psycopg
from redis import Redis
from redis.exceptions import RedisError

from deploy.load.usage import families

QUEUES = ("data", "flight", "planning", "proofs", "simulation")
KIB = 1_024


@dataclass(frozen=True)
class Sample:
    """`own_bytes` by program is what it has taken for itself; `shared_bytes` are shared segments: PostgreSQL's buffers.

    Files that are mapped are left out: the system takes them back at will, and a page of a library counts for more when others end.

    `files` by program are those open; `tables` by name are bytes and dead rows.
    """

    at_s: float
    own_bytes: Mapping[str, int]
    shared_bytes: int
    files: Mapping[str, int]
    processes: Mapping[str, int]
    connections: int
    redis_bytes: int
    redis_keys: int
    redis_lasting: int  # keys that never expire
    waiting: int  # in the queues of workers
    open_jobs: int
    tables: Mapping[str, tuple[int, int]]

    @property
    def all_bytes(self) -> int:
        return sum(self.own_bytes.values())

    @property
    def dead_rows(self) -> int:
        return sum(dead for _, dead in self.tables.values())

    @property
    def tables_bytes(self) -> int:
        return sum(size for size, _ in self.tables.values())


def memory_of(pid: int) -> tuple[int, int]:
    """Bytes of anonymous memory and of shared segments, each page divided among those that have it; none of a process that has gone."""
    try:
        text = Path(f"/proc/{pid}/smaps_rollup").read_text()
    except OSError:
        return 0, 0
    reported = {line.split(":")[0]: int(line.split()[1]) * KIB for line in text.splitlines()[1:]}
    return reported.get("Pss_Anon", 0) + reported.get("SwapPss", 0), reported.get("Pss_Shmem", 0)


def files_of(pid: int) -> int:
    try:
        return len(os.listdir(f"/proc/{pid}/fd"))  # noqa: PTH208 (counted, not looked at)
    except OSError:
        return 0


def sample(roots: Mapping[str, int], database_url: str, redis_url: str) -> Sample:
    """`roots` are process ids of programs by name. What a server that is away would say is 0."""
    found = families({name: [pid] for name, pid in roots.items()})
    memory = {name: [memory_of(pid) for pid in pids] for name, pids in found.items()}
    connections, open_jobs, tables = _database(database_url)
    redis_bytes, redis_keys, redis_lasting, waiting = _redis(redis_url)
    return Sample(
        at_s=time.time(),
        own_bytes={name: sum(own for own, _ in parts) for name, parts in memory.items()},
        shared_bytes=sum(shared for parts in memory.values() for _, shared in parts),
        files={name: sum(map(files_of, pids)) for name, pids in found.items()},
        processes={name: len(pids) for name, pids in found.items()},
        connections=connections,
        redis_bytes=redis_bytes,
        redis_keys=redis_keys,
        redis_lasting=redis_lasting,
        waiting=waiting,
        open_jobs=open_jobs,
        tables=tables,
    )


def _database(url: str) -> tuple[int, int, dict[str, tuple[int, int]]]:
    try:
        with psycopg.connect(url.replace("postgis://", "postgres://", 1), connect_timeout=5, autocommit=True) as connection:
            asked = "SELECT count(*) FROM pg_stat_activity WHERE datname = current_database() AND pid <> pg_backend_pid()"
            connections = connection.execute(asked).fetchone()
            jobs = connection.execute("SELECT count(*) FROM workspace_job WHERE state IN ('queued', 'running')").fetchone()
            reported = connection.execute("SELECT relname, pg_total_relation_size(relid), n_dead_tup FROM pg_stat_user_tables").fetchall()
    except psycopg.OperationalError:
        return 0, 0, {}
    return connections[0] if connections else 0, jobs[0] if jobs else 0, {name: (size, dead) for name, size, dead in reported}


def _redis(url: str) -> tuple[int, int, int, int]:
    try:
        with Redis.from_url(url, socket_timeout=5) as asked:
            spaces = asked.info("keyspace").values()
            keys, expiring = sum(space["keys"] for space in spaces), sum(space["expires"] for space in spaces)
            return int(asked.info("memory")["used_memory"]), keys, keys - expiring, sum(int(asked.llen(queue)) for queue in QUEUES)
    except RedisError:
        return 0, 0, 0, 0
