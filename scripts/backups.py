"""Back up one installation to a folder, and restore it: the database, the secret key, the flight logs, photos and videos.

python -m scripts.backups backup [FOLDER] [--without-key] [--without-media]
python -m scripts.backups restore FOLDER [--replace]

The database is DATABASE_URL's, else the private one of the state folder (SPANWISE_VAR), which is started if it does not run.
"""

import argparse
import hashlib
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from urllib.parse import parse_qsl, unquote, urlencode, urlsplit

import psycopg
from psycopg import sql

from config.private_servers import DATABASE_NAME, private_database_url, state_directory
from operation.version import VERSION
from scripts.installation import database_cluster
from scripts.installation.postgresql_installations import installed_servers, server_for
from scripts.places import CannotStart, Places, prepare_sockets, prepare_state, remove_sockets
from scripts.supervision.programs import database_server
from scripts.supervision.supervision import Supervisor

REFERENCE_SYSTEMS = "spatial_ref_sys"
DUMP, MANIFEST, SUMS, KEY, LOGS, MEDIA = "database.dump", "manifest.json", "SHA256SUMS", "secret_key", "flight-logs", "media"
ORIGINALS = "originals"  # of media: each is named by its SHA-256
WORDS = {LOGS: "flights' logs", MEDIA: "photos and videos"}
PIECE_BYTES = 1024 * 1024
GONE_WITHIN_S = 5.0
OWN_TABLES = """
SELECT format('%I.%I', n.nspname, c.relname) FROM pg_class c JOIN pg_namespace n ON n.oid = c.relnamespace
WHERE n.nspname = 'public' AND c.relkind IN ('r', 'p')
    AND NOT EXISTS (SELECT FROM pg_depend d WHERE d.classid = 'pg_class'::regclass AND d.objid = c.oid AND d.deptype = 'e')
ORDER BY 1
"""  # excludes extensions' tables, such as PostGIS's spatial_ref_sys


class Refused(Exception):
    """Raised before anything was done; the message is the reason and the remedy."""


@dataclass(frozen=True)
class Database:
    """An address as libpq takes it. The password is passed in the environment: other users can read command lines."""

    address: str
    environment: dict[str, str]
    programs: Path | None = None  # folder of its version's pg_dump and pg_restore; None: the newest on this machine

    def connect(self) -> psycopg.Connection[tuple[object, ...]]:
        return psycopg.connect(self.address, password=self.environment.get("PGPASSWORD"), autocommit=True)

    def program(self, name: str) -> str:
        if self.programs is not None:
            return str(self.programs / name)
        found = [server.program(name) for server in sorted(installed_servers(), key=lambda one: one.version, reverse=True)]
        program = next((path for path in found if os.access(path, os.X_OK)), None) or shutil.which(name)
        if program is None:
            raise Refused(f"{name} is not on this machine: install PostgreSQL's client programs")
        return program

    def run(self, name: str, *arguments: str) -> None:
        command = [self.program(name), *arguments]
        answer = subprocess.run(command, env={**os.environ, **self.environment}, capture_output=True, text=True, check=False)
        if answer.returncode != 0:
            raise Refused(f"{name} failed: {answer.stderr.strip()}")


def database_at(url: str, programs: Path | None = None) -> Database:
    """Return the database of an address as in DATABASE_URL."""
    parts = urlsplit(url)
    user, _, place = parts.netloc.rpartition("@")
    name, _, password = user.partition(":")
    query = [(key, value) for key, value in parse_qsl(parts.query) if not key.startswith("options")]
    address = f"postgresql://{name + '@' if name else ''}{place}{parts.path}" + (f"?{urlencode(query)}" if query else "")
    return Database(address, {"PGPASSWORD": unquote(password)} if password else {}, programs)


@contextmanager
def database(places: Places) -> Iterator[Database]:
    """Yield DATABASE_URL's database, else the private one, which is started and stopped again if it does not run."""
    if url := os.environ.get("DATABASE_URL"):
        yield database_at(url)
        return
    prepare_state(places.state)
    sockets = prepare_sockets(places.state)
    supervisor = Supervisor(places, sockets)
    is_ours = not supervisor.is_running()
    if is_ours:
        database_cluster.prepare_cluster(places)
        supervisor.start([database_server(places, sockets)])
    try:
        database_cluster.wait_for_database(sockets)
        if not database_cluster.database_exists(sockets):
            database_cluster.create_database(sockets)
        server = server_for(places.data)
        yield database_at(private_database_url(places.state), None if server is None else server.programs)
    finally:
        if is_ours:
            supervisor.stop()
            remove_sockets(places.state)


def back_up(places: Places, folder: Path, *, with_key: bool = True, with_media: bool = True) -> Path:
    """Write everything to a new folder, readable by its owner only; it appears complete or not at all. Raises Refused."""
    if folder.exists():
        raise Refused(f"{folder} is there already")
    draft = folder.with_name(f".{folder.name}.new")
    shutil.rmtree(draft, ignore_errors=True)
    draft.mkdir(mode=0o700, parents=True)
    with database(places) as source:
        # PostGIS's table of reference systems belongs to the role that created the extension; other roles may not write it.
        leave_out = f"--exclude-table-data=*.{REFERENCE_SYSTEMS}"
        source.run("pg_dump", "--format=custom", "--no-owner", "--no-acl", leave_out, f"--file={draft / DUMP}", source.address)
        migrations = _migrations(source)
    key = places.state / KEY
    has_key = with_key and key.exists()
    if has_key:
        shutil.copy2(key, draft / KEY)
        (draft / KEY).chmod(0o600)
    for name, source_folder in file_folders(places).items():  # after the database, so that all files that it names are included
        if source_folder.is_dir() and (with_media or name != MEDIA):
            shutil.copytree(source_folder, draft / name, copy_function=_link if name == MEDIA else shutil.copy2)
    manifest = {
        "made_at": datetime.now(UTC).isoformat(),
        "version": VERSION,
        "has_key": has_key,
        "has_media": with_media,
        "migrations": migrations,
    }
    (draft / MANIFEST).write_text(json.dumps(manifest, indent=2) + "\n")
    (draft / SUMS).write_text("".join(f"{digest}  {name}\n" for name, digest in _digests(draft, trusts_names=True)))
    draft.rename(folder)
    return folder


def restore(places: Places, folder: Path, *, replaces: bool = False) -> None:
    """Restore everything. Raises Refused before any change: for an incomplete folder, or where data exist already."""
    verify(folder)
    if not os.environ.get("DATABASE_URL") and Supervisor(places, prepare_sockets(places.state)).is_running():
        raise Refused(f"Spanwise runs on {places.state}: end it with ./run --stop first")
    key = places.state / KEY
    brings_key = (folder / KEY).exists()
    if brings_key and key.exists() and key.read_bytes() != (folder / KEY).read_bytes() and not replaces:
        raise Refused(f"{key} is another key than the backup's; --replace puts the backup's in its place")
    folders = {name: there for name, there in file_folders(places).items() if name != MEDIA or (folder / MEDIA).is_dir()}
    for name, there in folders.items():
        if there.is_dir() and any(there.iterdir()) and not replaces:
            raise Refused(f"there are {WORDS[name]} in {there}; --replace removes them")
    with database(places) as target:
        with target.connect() as connection:
            _refuse_if_used(connection)
            if not replaces and (tables := _tables(connection)):
                raise Refused(f"the database is not empty ({len(tables)} tables); --replace empties it first")
            emptying = _emptying(connection)
        with tempfile.TemporaryDirectory(dir=places.state, prefix=".restore-") as drafts:
            statements = Path(drafts) / "database.sql"
            target.run("pg_restore", "--no-owner", "--no-acl", "--no-comments", f"--file={statements}", str(folder / DUMP))
            # In one transaction: existing data are only dropped together with the restore.
            target.run(
                "psql", "--no-psqlrc", "--quiet", "--single-transaction", "--set=ON_ERROR_STOP=1", f"--dbname={target.address}",
                f"--command={emptying}", f"--file={statements}",
            )  # fmt: skip
    if brings_key:
        shutil.copy2(folder / KEY, key)
        key.chmod(0o600)
    for name, there in folders.items():
        shutil.rmtree(there, ignore_errors=True)
        if (folder / name).is_dir():
            shutil.copytree(folder / name, there, copy_function=_link if name == MEDIA else shutil.copy2)
    shutil.rmtree(places.state / "graphs", ignore_errors=True)  # unpacked from the previous database


def verify(folder: Path) -> None:
    """Raise Refused where a file is missing, was added or differs from the manifest."""
    try:
        written = [line.split("  ", 1) for line in (folder / SUMS).read_text().splitlines()]
    except OSError as error:
        raise Refused(f"{folder} is no backup: {error.strerror}") from None
    wanted = {name: digest for digest, name in written}
    found = dict(_digests(folder))
    if wrong := sorted(name for name in wanted.keys() | found.keys() if wanted.get(name) != found.get(name)):
        raise Refused(f"{folder} is damaged: {', '.join(wrong[:5])}")


def file_folders(places: Places) -> dict[str, Path]:
    """Return the folders of files, by their names in a backup."""
    return {
        LOGS: Path(os.environ.get("SPANWISE_LOG_DIR") or places.state / LOGS),
        MEDIA: Path(os.environ.get("SPANWISE_MEDIA_DIR") or places.state / MEDIA),
    }


def _link(source: str, target: str) -> None:
    """Link a file that never changes, so that it takes no room; copy it to another file system. One that was deleted meanwhile is left."""
    try:
        os.link(source, target)
    except FileNotFoundError:
        return
    except OSError:
        shutil.copy2(source, target)


def _digests(folder: Path, *, trusts_names: bool = False) -> Iterator[tuple[str, str]]:
    """Yield the files and their SHA-256. trusts_names: those of photos' and videos' originals are their names, which saves reading them."""
    for path in sorted(path for path in folder.rglob("*") if path.is_file() and path.name != SUMS):
        if trusts_names and path.relative_to(folder).parts[0] == MEDIA and ORIGINALS in path.relative_to(folder).parts:
            yield str(path.relative_to(folder)), path.name
            continue
        digest = hashlib.sha256()
        with path.open("rb") as file:
            while piece := file.read(PIECE_BYTES):
                digest.update(piece)
        yield str(path.relative_to(folder)), digest.hexdigest()


def _migrations(source: Database) -> dict[str, str]:
    """Return the last migration of each app."""
    with source.connect() as connection:
        if not _tables(connection):
            raise Refused("there is nothing in the database to be backed up")
        return dict(connection.execute("SELECT app, max(name) FROM django_migrations GROUP BY app ORDER BY app").fetchall())  # type: ignore[arg-type]


def _tables(connection: psycopg.Connection[tuple[object, ...]]) -> list[str]:
    return [str(name) for (name,) in connection.execute(OWN_TABLES).fetchall()]


def _emptying(connection: psycopg.Connection[tuple[object, ...]]) -> str:
    """Return the statement that drops all tables. Extensions stay: the restoring role may lack the right to create them."""
    tables = _tables(connection)
    return f"DROP TABLE {', '.join(tables)} CASCADE" if tables else "SELECT 1"


def _refuse_if_used(connection: psycopg.Connection[tuple[object, ...]]) -> None:
    """Raise Refused while other clients are connected; programs that have just ended get a moment to disconnect."""
    query = "SELECT count(*) FROM pg_stat_activity WHERE datname = current_database() AND pid <> pg_backend_pid() AND backend_type = {}"
    others = sql.SQL(query).format(sql.Literal("client backend"))
    deadline_s = time.monotonic() + GONE_WITHIN_S
    while (row := connection.execute(others).fetchone()) is not None and row[0]:
        if time.monotonic() > deadline_s:
            raise Refused(f"{row[0]} connections use the database: stop Spanwise's programs first")
        time.sleep(0.1)


def _default_folder(places: Places) -> Path:
    return places.state / "backups" / f"{DATABASE_NAME}-{datetime.now(UTC):%Y-%m-%dT%H-%M-%SZ}"


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(prog="scripts/backup or scripts/restore", description=(__doc__ or "").partition("\n")[0])
    what = parser.add_subparsers(dest="what", required=True)
    backing = what.add_parser("backup", help="write a backup; Spanwise may run meanwhile")
    backing.add_argument("folder", type=Path, nargs="?", help="to be made; by default in the state folder under backups/")
    backing.add_argument("--without-key", action="store_true", help="leave the secret key out, where it is kept somewhere else")
    backing.add_argument("--without-media", action="store_true", help="leave photos and videos out, where their folder is backed up itself")
    restoring = what.add_parser("restore", help="read a backup into an empty database; Spanwise must not run")
    restoring.add_argument("folder", type=Path)
    restoring.add_argument("--replace", action="store_true", help="remove what is there: database, key, flights' logs, photos and videos")
    options = parser.parse_args(arguments)
    places = Places(state_directory())
    try:
        if options.what == "backup":
            folder = (options.folder or _default_folder(places)).resolve()
            made = back_up(places, folder, with_key=not options.without_key, with_media=not options.without_media)
            print(f"backup {made}")
        else:
            restore(places, options.folder.resolve(), replaces=options.replace)
            print(f"restored from {options.folder}")
    except (Refused, CannotStart, psycopg.OperationalError, OSError) as error:
        print(f"nothing was {'backed up' if options.what == 'backup' else 'restored'}: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
