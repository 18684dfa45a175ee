"""Paths of one installation's state: everything in its state folder, sockets in a short folder of their own."""

import hashlib
import os
import pwd
import shutil
import stat
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

from config.private_servers import PROJECT_DIR, socket_directory

SOCKET_PATH_LIMIT = 107  # bytes, sun_path of Linux
DATABASE_USER = "postgres"  # PostgreSQL refuses to run as root
DEMO_USER = "demo"
WEB_PROGRAMS = ("web-1", "web-2")  # pages and API, each with a socket of its own
SERVING_PROGRAMS = (*WEB_PROGRAMS, "uav-link", "live")  # behind the proxy
PROGRAMS_WITH_METRICS = (  # each with a metrics socket of its own
    *WEB_PROGRAMS, "uav-link", "live", "worker-data", "worker-flight", "worker-planning", "worker-proofs", "worker-simulation", "gateway",
    "estimator", "simulator", "beat",
)  # fmt: skip


class CannotStart(Exception):
    """Raised when this machine prevents the start; the message gives the reason."""


@dataclass(frozen=True)
class Places:
    """Paths of one state folder."""

    state: Path

    @property
    def data(self) -> Path:
        """Return PostgreSQL's data folder."""
        inside = self.state / "postgresql"
        if os.geteuid() != 0 or (inside / "PG_VERSION").exists() or database_user_reaches(self.state):
            return inside
        digest = hashlib.sha256(str(self.state).encode()).hexdigest()[:10]
        return Path(pwd.getpwnam(DATABASE_USER).pw_dir) / f"spanwise-{digest}"

    @property
    def redis(self) -> Path:
        return self.state / "redis"

    @property
    def logs(self) -> Path:
        return self.state / "log"

    @property
    def generated(self) -> Path:
        """Return the folder of configuration files, which are rewritten at every start."""
        return self.state / "generated"

    @property
    def static(self) -> Path:
        return self.state / "static"

    @property
    def instance(self) -> Path:
        """Return the file with the port of the running installation."""
        return self.state / "instance.json"

    @property
    def first_load(self) -> Path:
        """Return the file that exists during the first load of data, so that an interrupted load is repeated."""
        return self.state / "first_load.json"

    @property
    def demo_password(self) -> Path:
        return self.state / "demo_password"

    @property
    def lock(self) -> Path:
        return self.state / "lock"

    def process(self, program: str) -> Path:
        """Return the working folder of a program. It belongs to that program only: processes in it may be ended."""
        return self.state / "processes" / program


def health_socket(sockets: Path, program: str) -> Path:
    """Return the metrics socket of a program; the proxy combines all of them on one port."""
    return sockets / f"{program}.told.sock"


def database_user_id() -> int:
    """Return the user id that runs PostgreSQL: our own, or that of `postgres` when we are root."""
    if os.geteuid() != 0:
        return os.geteuid()
    try:
        return pwd.getpwnam(DATABASE_USER).pw_uid
    except KeyError:
        raise CannotStart("PostgreSQL does not run as root, and this machine has no user `postgres`") from None


def database_user_reaches(folder: Path) -> bool:
    """Whether the user that runs PostgreSQL can pass through every folder down to this one."""
    answer = subprocess.run(
        ["test", "-x", str(folder)], user=database_user_id(), group=_database_group_id(), extra_groups=[], cwd="/", check=False
    )
    return answer.returncode == 0


def _database_group_id() -> int:
    return pwd.getpwuid(database_user_id()).pw_gid


def prepare_state(state: Path) -> Places:
    """Create the folders of a state. Raises CannotStart if this user may not write there."""
    places = Places(state)
    try:
        if places.lock.exists() and (owner := places.lock.stat().st_uid) != os.geteuid():
            raise CannotStart(f"{state} belongs to user id {owner}: start Spanwise as that user, or choose another folder with --var")
        for folder in (state, places.redis, places.logs, places.generated):
            folder.mkdir(parents=True, exist_ok=True)
        for folder in (places.redis, places.logs):
            folder.chmod(0o700)
        state.chmod(0o711 if os.geteuid() == 0 else 0o700)  # as root: passable for the database's and the proxy's users
        places.lock.touch()
    except OSError as error:
        raise CannotStart(f"this user cannot write in {state} ({error.strerror}); choose another folder with --var") from None
    return places


def _is_ours(sockets: Path, state: Path) -> bool:
    """Whether it is a real folder, owned by us (or by the database's user when we are root), that was made for this state."""
    try:
        found = sockets.lstat()
        made_for = (sockets / "state").read_text()
    except OSError:
        return False
    return stat.S_ISDIR(found.st_mode) and found.st_uid in {os.geteuid(), database_user_id()} and made_for == str(state)


def prepare_sockets(state: Path) -> Path:
    """Return the folder of this state's sockets, created if missing, closed to other users, and stored in the state."""
    note = state / "socket_directory"
    digest = hashlib.sha256(str(state).encode()).hexdigest()[:10]
    sockets = Path(note.read_text().strip()) if note.exists() else Path(tempfile.gettempdir()) / f"spanwise-{digest}"
    if not _is_ours(sockets, state):
        parent = Path(tempfile.gettempdir())
        if len(os.fsencode(parent)) > SOCKET_PATH_LIMIT - len("/spanwise-0123456789/supervisor.sock.4194304"):
            parent = Path("/tmp")  # noqa: S108 - the folder in it is checked for its owner and closed
        sockets = parent / f"spanwise-{digest}"
        try:
            sockets.mkdir(mode=0o700)
        except FileExistsError:
            if not _is_ours(sockets, state):  # it belongs to another user or state
                sockets = Path(tempfile.mkdtemp(prefix="spanwise-", dir=parent))
        (sockets / "state").write_text(str(state))
    sockets.chmod(0o700)
    if os.geteuid() == 0:
        shutil.chown(sockets, database_user_id(), _database_group_id())
    draft = note.with_suffix(".new")
    draft.write_text(f"{sockets}\n")
    draft.replace(note)
    return sockets


def remove_sockets(state: Path) -> None:
    """Remove the socket folder of a state on which nothing runs any more."""
    sockets = socket_directory(state)
    if _is_ours(sockets, state):
        shutil.rmtree(sockets, ignore_errors=True)


__all__ = [
    "DATABASE_USER",
    "DEMO_USER",
    "PROJECT_DIR",
    "CannotStart",
    "Places",
    "database_user_id",
    "prepare_sockets",
    "prepare_state",
    "remove_sockets",
]
