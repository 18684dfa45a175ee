"""Find PostgreSQL's programs on this machine, and whether PostGIS is installed for them. Needs only Python."""

import os
import re
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

OLDEST_VERSION = 15
DEBIAN_PROGRAMS = Path("/usr/lib/postgresql")
DEBIAN_SHARED = Path("/usr/share/postgresql")


@dataclass(frozen=True)
class PostgreSQL:
    """One installed PostgreSQL server."""

    version: int
    programs: Path
    has_postgis: bool

    def program(self, name: str) -> str:
        return str(self.programs / name)


def _major_version(initdb: Path) -> int:
    answer = subprocess.run([str(initdb), "--version"], capture_output=True, text=True, check=False).stdout
    match = re.search(r"(\d+)", answer)
    return int(match.group(1)) if match else 0


def _shared_folders(programs: Path, version: int) -> list[Path]:
    """Return the possible extension folders of a server with these programs, Debian's first."""
    folders = [DEBIAN_SHARED / str(version)]
    folders += [programs.parent / "share" / name for name in (f"postgresql{version}", f"postgresql-{version}", "postgresql", "pgsql", ".")]
    if (pg_config := programs / "pg_config").is_file():
        answer = subprocess.run([str(pg_config), "--sharedir"], capture_output=True, text=True, check=False).stdout.strip()
        folders += [Path(answer)] if answer else []
    return folders


def installed_servers() -> list[PostgreSQL]:
    """Return every server of version 15 or newer: those with PostGIS first, then the newest first."""
    folders = [entry / "bin" for entry in DEBIAN_PROGRAMS.glob("[0-9]*")]
    if found := shutil.which("initdb"):
        folders.append(Path(found).resolve().parent)
    servers = []
    for folder in dict.fromkeys(folders):
        initdb = folder / "initdb"
        if not (os.access(initdb, os.X_OK) and os.access(folder / "postgres", os.X_OK)):
            continue
        version = _major_version(initdb)
        if version >= OLDEST_VERSION:
            has_postgis = any((shared / "extension" / "postgis.control").is_file() for shared in _shared_folders(folder, version))
            servers.append(PostgreSQL(version=version, programs=folder, has_postgis=has_postgis))
    return sorted(servers, key=lambda server: (server.has_postgis, server.version), reverse=True)


def server_for(data: Path) -> PostgreSQL | None:
    """Return the server that can open this data folder; for a new folder, the newest one with PostGIS."""
    servers = [server for server in installed_servers() if server.has_postgis]
    marker = data / "PG_VERSION"
    if marker.exists():
        version = int(marker.read_text().strip())
        servers = [server for server in servers if server.version == version]
    return servers[0] if servers else None
