"""Install the hash-pinned Python libraries into .venv by uv, which shares its cache among checkouts. Needs only Python.

Sources of uv: .venv itself, another checkout of this user, a uv of the same version on the PATH, or the package registry through pip.
"""

import configparser
import os
import re
import shutil
import subprocess
import tempfile
from collections.abc import Mapping
from pathlib import Path

from scripts.installation import user_cache

SHARED_KIND = "uv"


class CannotInstall(Exception):
    """Raised when an installing program has failed, with its output."""


def is_installed(venv: Path, wanted: list[str]) -> bool:
    """Return whether the stamp in .venv has these lines: the path of the checkout, and a digest of each lock."""
    try:
        lines = (venv / "spanwise-stamp").read_text().splitlines()
    except OSError:
        return False
    python = [str(venv / "bin" / "python"), "-c", ""]
    return set(wanted) <= set(lines) and subprocess.run(python, capture_output=True, check=False).returncode == 0


def install(venv: Path, base_python: str, lock: Path, wanted: list[str]) -> None:
    """Create .venv unless it belongs to this checkout, and install a lock into it. Raises CannotInstall."""
    stamp = venv / "spanwise-stamp"
    # Missing, incomplete, or made elsewhere: create it again.
    is_ours = stamp.exists() and wanted[0] in stamp.read_text().splitlines()
    if not is_ours or subprocess.run([venv / "bin" / "python", "-c", ""], capture_output=True, check=False).returncode:
        _run([base_python, "-m", "venv", "--without-pip", "--clear", str(venv)])
    stamp.unlink(missing_ok=True)
    uv = find_uv(venv, base_python, lock.with_name("requirements.txt"))
    command = [uv, "pip", "install", "--quiet", "--no-deps", "--require-hashes", "--python", str(venv / "bin" / "python"), "-r", str(lock)]
    environment = {**os.environ, **settings_of_pip(os.environ)}
    offline = subprocess.run([*command, "--offline"], env=environment, capture_output=True, check=False)
    if offline.returncode:  # the cache is incomplete
        _run(command, environment)
    stamp.write_text("".join(f"{line}\n" for line in wanted))
    own = venv / "bin" / "uv"
    if own.exists() and (version := _version(str(own))):
        with tempfile.TemporaryDirectory() as folder:
            shutil.copy2(own, folder)
            user_cache.publish(Path(folder), SHARED_KIND, version)


def find_uv(venv: Path, base_python: str, lock: Path) -> str:
    """Return the path of a uv of the locked version, installed into .venv if there is none. Raises CannotInstall."""
    block = re.search(r"^uv==(\S+)(?: \\\n +--hash=\S+)+$", lock.read_text(), re.MULTILINE)
    if block is None:
        raise CannotInstall(f"{lock.name} does not name uv")
    version = block[1]
    own = venv / "bin" / "uv"
    for candidate in (str(own), shutil.which("uv")):
        if candidate and _version(candidate) == version:
            return candidate
    with tempfile.TemporaryDirectory() as folder:
        if user_cache.fetch(SHARED_KIND, version, Path(folder) / "shared"):
            shutil.copy2(Path(folder) / "shared" / "uv", own)
            if _version(str(own)) == version:
                return str(own)
        # pip comes with Python, is installed separately, and verifies uv's digest.
        (Path(folder) / "uv.txt").write_text(f"{block[0]}\n")
        _run([base_python, "-m", "venv", f"{folder}/pip"])
        pip = [f"{folder}/pip/bin/python", "-m", "pip", "install", "--quiet", "--no-input", "--disable-pip-version-check"]
        _run([*pip, "--no-deps", "--require-hashes", "-r", f"{folder}/uv.txt"])
        shutil.copy2(f"{folder}/pip/bin/uv", own)
    return str(own)


def settings_of_pip(environment: Mapping[str, str]) -> dict[str, str]:
    """Return uv's environment variables for pip's configuration, so that a private mirror is set once; uv's own ones take precedence.

    pip reads its variables first, then the user's file and the machine's. Certificates are those of the system.
    """
    found: dict[str, str] = {}
    home = Path(environment.get("HOME") or "/nonexistent")
    machine = [Path(folder) / "pip" / "pip.conf" for folder in environment.get("XDG_CONFIG_DIRS", "/etc/xdg").split(":")]
    own = [home / ".pip" / "pip.conf", Path(environment.get("XDG_CONFIG_HOME") or home / ".config") / "pip" / "pip.conf"]
    for path in [*machine, Path("/etc/pip.conf"), *own, Path(environment.get("PIP_CONFIG_FILE") or "/dev/null")]:
        parser = configparser.RawConfigParser()
        try:
            parser.read(path)
        except (configparser.Error, UnicodeDecodeError):
            continue
        for section in ("global", "install"):
            if parser.has_section(section):
                found |= dict(parser.items(section))
    for name, value in environment.items():
        if name.startswith("PIP_"):
            found[name.removeprefix("PIP_").lower().replace("_", "-")] = value
    extra = [place for place in found.get("extra-index-url", "").split() if place.startswith("http")]
    settings = {
        "UV_SYSTEM_CERTS": "1",
        "UV_DEFAULT_INDEX": found.get("index-url", ""),
        "UV_INDEX": " ".join(extra),
        "UV_INDEX_STRATEGY": "unsafe-best-match" if extra else "",  # as pip does; the digests decide what is accepted
        "UV_FIND_LINKS": ",".join(found.get("find-links", "").split()),
        "UV_NO_INDEX": "1" if found.get("no-index", "").lower() in {"1", "true", "yes", "on"} else "",
        "UV_INSECURE_HOST": " ".join(found.get("trusted-host", "").split()),
        "UV_HTTP_TIMEOUT": found.get("timeout") or found.get("default-timeout", ""),
        "SSL_CERT_FILE": found.get("cert", ""),
    }
    return {name: value for name, value in settings.items() if value and name not in environment}


def _version(uv: str) -> str | None:
    try:
        words = subprocess.run([uv, "--version"], capture_output=True, text=True, check=True).stdout.split()
    except (OSError, subprocess.CalledProcessError):
        return None
    return words[1] if len(words) > 1 else None


def _run(command: list[str], environment: Mapping[str, str] | None = None) -> None:
    answer = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    if answer.returncode:
        raise CannotInstall(f"{answer.stdout}{answer.stderr}")
