"""Find missing Debian packages; root installs them, other users get the apt command. Needs only Python."""

import ctypes.util
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from scripts.installation.postgresql_installations import DEBIAN_PROGRAMS, OLDEST_VERSION, installed_servers
from scripts.installation.python_libraries import CannotInstall

EXIT_MISSING = 3
FONT_FOLDERS = [Path("/usr/share/fonts"), Path("/usr/local/share/fonts")]
POLICY_FILE = Path("/usr/sbin/policy-rc.d")
POLICY_MARK = "# Made by Spanwise's scripts/setup for the time of one apt-get call."
# Packages whose names contain a version: the pattern, and the name in Debian 12.
NUMBERED = {
    "postgresql": (r"^postgresql-[0-9]+-postgis-3$", "postgresql-15-postgis-3"),
    "gdal": (r"^libgdal[0-9]+(t64)?$", "libgdal32"),
    "geos": (r"^libgeos-c1[a-z0-9]*$", "libgeos-c1v5"),
}
BROWSERS = ("chromium-headless-shell", "chromium", "chromium-browser", "google-chrome")  # the first one found runs the tests
SERVICES = {"redis-server": "redis-server", "nginx-light": "nginx"}


def find_program(name: str) -> str | None:
    """Return a program's path; servers are in sbin, which may be missing from an ordinary user's PATH."""
    return shutil.which(name) or shutil.which(name, path="/usr/local/sbin:/usr/sbin:/sbin")


def _has_font(pattern: str) -> bool:
    return any(next(folder.rglob(pattern), None) is not None for folder in FONT_FOLDERS if folder.is_dir())


def _available(subject: str) -> str:
    """Return the newest package for a numbered name that apt knows, else its name in Debian 12."""
    pattern, fallback = NUMBERED[subject]
    if not shutil.which("apt-cache"):
        return fallback
    answer = subprocess.run(["apt-cache", "search", "--names-only", pattern], capture_output=True, text=True, check=False).stdout
    names = [line.split()[0] for line in answer.splitlines() if line.strip()]
    return max(names, key=lambda name: [int(number) for number in re.findall(r"\d+", name)], default=fallback)


def _database_packages() -> list[str]:
    servers = installed_servers()
    if any(server.has_postgis for server in servers):
        return []
    debian = [server.version for server in servers if server.programs.is_relative_to(DEBIAN_PROGRAMS)]
    postgis = f"postgresql-{debian[0]}-postgis-3" if debian else _available("postgresql")
    match = re.search(r"-(\d+)-", postgis)
    version = int(match.group(1)) if match else OLDEST_VERSION
    return [*([] if version in debian else [f"postgresql-{version}"]), postgis, f"{postgis}-scripts"]


def _browser_packages() -> list[str]:
    """Return the headless shell, which renders test pages in two thirds of the time; without root any installed browser suffices."""
    if find_program(BROWSERS[0]) or (os.geteuid() != 0 and any(map(find_program, BROWSERS))):
        return []
    return [BROWSERS[0]]


def missing_packages(purpose: str) -> list[str]:
    """Return the Debian packages that this purpose (run, check, check-fast, image) still needs."""
    missing = []
    if not os.environ.get("DATABASE_URL"):
        missing += _database_packages()
    if not missing:  # Debian's PostGIS depends on both libraries
        missing += [
            _available(subject) for subject, library in (("gdal", "gdal"), ("geos", "geos_c")) if not ctypes.util.find_library(library)
        ]
    if not os.environ.get("REDIS_URL") and not find_program("redis-server"):
        missing.append("redis-server")
    if purpose == "run" and not find_program("nginx"):
        missing.append("nginx-light")
    if purpose == "check":
        missing += _browser_packages()
        missing += [] if _has_font("DejaVuSans.ttf") else ["fonts-dejavu-core"]
        missing += [] if _has_font("Inter*.otf") or _has_font("Inter*.ttf") else ["fonts-inter"]
    return missing


def apt_line(packages: list[str]) -> str:
    return f"apt-get update && apt-get install -y --no-install-recommends {' '.join(packages)}"


@contextmanager
def no_service_starts() -> Iterator[None]:
    """Prevent installed packages from starting services; a machine's own policy file is left unchanged."""
    if POLICY_FILE.exists() and POLICY_MARK not in POLICY_FILE.read_text(errors="replace"):
        yield
        return
    POLICY_FILE.write_text(f"#!/bin/sh\n{POLICY_MARK}\nexit 101\n")
    POLICY_FILE.chmod(0o755)
    try:
        yield
    finally:
        POLICY_FILE.unlink(missing_ok=True)


def _new_services(packages: list[str]) -> list[str]:
    """Return the services that these packages will add to a machine without services of their kind."""
    services = [SERVICES[package] for package in packages if package in SERVICES]
    if any(re.fullmatch(r"postgresql-\d+", package) for package in packages) and not any(DEBIAN_PROGRAMS.glob("[0-9]*/bin/postgres")):
        services.append("postgresql")
    return services


def _keep_from_boot(services: list[str]) -> None:
    """Disable the services of our packages at boot: Spanwise starts its own, on its own sockets."""
    if services and shutil.which("systemctl"):
        subprocess.run(["systemctl", "disable", "--quiet", *services], capture_output=True, check=False)


def install(purpose: str) -> None:
    """Install what is missing, as root. Raises CalledProcessError after printing the end of apt's output."""
    environment = {**os.environ, "DEBIAN_FRONTEND": "noninteractive"}
    apt_get = ["apt-get", "-q", "-y", "-o", "DPkg::Lock::Timeout=300", "-o", "Dpkg::Use-Pty=0"]
    with tempfile.TemporaryFile("w+") as words, no_service_starts():
        try:
            subprocess.run([*apt_get, "update"], env=environment, stdout=words, stderr=words, check=True)
            packages = missing_packages(purpose)  # again: apt may know newer names now
            services = _new_services(packages)
            subprocess.run(
                [*apt_get, "install", "--no-install-recommends", *packages], env=environment, stdout=words, stderr=words, check=True
            )
        except subprocess.CalledProcessError:
            words.seek(0)
            print("".join(words.readlines()[-30:]), file=sys.stderr)
            raise
    _keep_from_boot(services)


def refusal(purpose: str) -> str | None:
    """Return the message for a user who may not install missing packages; None if nothing is missing, or root may."""
    missing = missing_packages(purpose)
    if not missing or (os.geteuid() == 0 and shutil.which("apt-get")):
        return None
    return f"Packages are missing. As root, run:\n  {apt_line(missing)}"


def install_and_verify(purpose: str) -> None:
    """Install what is missing, as root. Raises CannotInstall."""
    try:
        install(purpose)
    except subprocess.CalledProcessError as error:
        raise CannotInstall(f"apt-get failed (exit code {error.returncode}); its last words are above") from None
    if missing := missing_packages(purpose):
        raise CannotInstall(f"Still not found after the installation: {' '.join(missing)}")
