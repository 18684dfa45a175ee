"""Libraries are installed by the locked uv, from where pip is configured to take them."""

import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from scripts.installation import python_libraries
from scripts.installation.python_libraries import CannotInstall, find_uv, is_installed, settings_of_pip

PROJECT_DIR = Path(__file__).resolve().parents[3]
BASES = {  # each lock adds to one
    "requirements.txt": None,
    "requirements-dev.txt": "requirements.txt",
    "requirements-benchmarks.txt": "requirements-dev.txt",
    "requirements-s3.txt": "requirements.txt",
    "requirements-tracing.txt": "requirements.txt",
    "requirements-deploy.txt": None,
}


def pinned(lock: str) -> list[str]:
    """Names in a lock and in those it adds to."""
    lines = (PROJECT_DIR / lock).read_text().splitlines()
    names = [re.split(r"==|\[", line)[0] for line in lines if "==" in line]
    base = BASES[lock]
    return names + (pinned(base) if base else [])


def normal(name: str) -> str:
    return re.sub(r"[-_.]+", "-", re.split(r"[\[<>= ]", name)[0]).lower()


# --- locks ------------------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("lock", BASES)
def test_a_lock_adds_to_its_base_and_pins_each_library_once_with_digests(lock):
    text = (PROJECT_DIR / lock).read_text()
    assert re.findall(r"^-r (.*)$", text, re.MULTILINE) == ([BASES[lock]] if BASES[lock] else [])
    assert len(pinned(lock)) == len(set(pinned(lock)))
    entry = r"[a-z0-9][a-z0-9._-]*(\[[a-z,]+\])?==\S+( ; [^\\\n]+)?( \\\n    --hash=sha256:[0-9a-f]{64})+\n"
    assert re.fullmatch(rf"(-r \S+\n)?({entry})+", text)
    assert "://" not in text


def test_the_locks_hold_what_pyproject_names():
    project = tomllib.loads((PROJECT_DIR / "pyproject.toml").read_text())
    wanted = {"requirements.txt": project["project"]["dependencies"]}
    groups = project["dependency-groups"]
    wanted |= {
        f"requirements-{group}.txt": [
            name for entry in entries for name in ([entry] if isinstance(entry, str) else groups[entry["include-group"]])
        ]
        for group, entries in groups.items()
    }
    assert set(wanted) == set(BASES)
    for lock, names in wanted.items():
        assert {normal(name) for name in names} <= set(map(normal, pinned(lock)))


# --- uv ---------------------------------------------------------------------------------------------------------------------------


@pytest.fixture
def lock(tmp_path: Path) -> Path:
    path = tmp_path / "requirements.txt"
    path.write_text(f"urllib3==2.0 \\\n    --hash=sha256:{'0' * 64}\nuv==1.2.3 \\\n    --hash=sha256:{'1' * 64}\nvine==1.0\n")
    return path


def program(path: Path, says: str) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"#!/bin/sh\necho '{says}'\n")
    path.chmod(0o755)
    return path


@pytest.fixture(autouse=True)
def _nothing_shared(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setenv("PATH", f"{tmp_path}/path:/usr/bin:/bin")


def test_the_uv_of_the_venv_is_used(tmp_path, lock):
    own = program(tmp_path / "venv" / "bin" / "uv", "uv 1.2.3 (linux)")
    assert find_uv(tmp_path / "venv", "/no/python", lock) == str(own)


def test_a_uv_of_the_locked_version_on_the_path_is_used(tmp_path, lock):
    program(tmp_path / "venv" / "bin" / "uv", "uv 1.2.2")
    found = program(tmp_path / "path" / "uv", "uv 1.2.3")
    assert find_uv(tmp_path / "venv", "/no/python", lock) == str(found)


def test_the_uv_of_another_checkout_is_copied(tmp_path, lock):
    (tmp_path / "venv" / "bin").mkdir(parents=True)
    program(tmp_path / "shared" / "uv", "uv 1.2.3")
    python_libraries.user_cache.publish(tmp_path / "shared", python_libraries.SHARED_KIND, "1.2.3")
    assert find_uv(tmp_path / "venv", "/no/python", lock) == str(tmp_path / "venv" / "bin" / "uv")


def test_else_pip_installs_the_locked_one_and_verifies_it(tmp_path, lock):
    """This Python makes a folder whose pip notes what it is asked for."""
    (tmp_path / "venv" / "bin").mkdir(parents=True)
    python = tmp_path / "python"
    python.write_text(
        "#!/bin/sh\n"
        'folder="$3"; mkdir -p "$folder/bin"\n'
        "cat >\"$folder/bin/python\" <<'END'\n"
        "#!/bin/sh\n"
        f'echo "$@" >{tmp_path}/asked; while [ $# -gt 1 ]; do shift; done; cat "$1" >{tmp_path}/lock; '
        'printf "#!/bin/sh\\necho uv 1.2.3\\n" >"${0%python}uv"; chmod +x "${0%python}uv"\n'
        "END\n"
        'chmod +x "$folder/bin/python"\n'
    )
    python.chmod(0o755)
    assert find_uv(tmp_path / "venv", str(python), lock) == str(tmp_path / "venv" / "bin" / "uv")
    assert {"--require-hashes", "--no-deps"} <= set((tmp_path / "asked").read_text().split())
    assert (tmp_path / "lock").read_text() == f"uv==1.2.3 \\\n    --hash=sha256:{'1' * 64}\n"


def test_a_failure_says_what_the_program_said(tmp_path, lock):
    (tmp_path / "venv" / "bin").mkdir(parents=True)
    python = program(tmp_path / "python", "ensurepip is missing")
    python.write_text(f"{python.read_text()}exit 1\n")
    with pytest.raises(CannotInstall, match="ensurepip is missing"):
        find_uv(tmp_path / "venv", str(python), lock)


# --- .venv ------------------------------------------------------------------------------------------------------------------------


def test_a_venv_is_good_with_the_stamp_of_this_place_and_these_locks(tmp_path):
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin" / "python").symlink_to(sys.executable)
    assert not is_installed(tmp_path, ["/here", "digest of one"])
    (tmp_path / "spanwise-stamp").write_text("/here\ndigest of one\ndigest of another\n")
    assert is_installed(tmp_path, ["/here", "digest of one"])
    assert not is_installed(tmp_path, ["/there", "digest of one"])
    assert not is_installed(tmp_path, ["/here", "digest of a third"])
    (tmp_path / "bin" / "python").unlink()
    program(tmp_path / "bin" / "python", "broken").write_text("#!/bin/sh\nexit 1\n")
    assert not is_installed(tmp_path, ["/here", "digest of one"])


# --- settings of pip --------------------------------------------------------------------------------------------------------------


def test_the_places_that_pip_is_configured_with_are_those_of_uv(tmp_path):
    (tmp_path / ".config" / "pip").mkdir(parents=True)
    (tmp_path / ".config" / "pip" / "pip.conf").write_text(
        "[global]\nindex-url = https://mirror.example/simple\nextra-index-url =\n  https://more.example/simple\n  file:///disk\n"
        "[install]\nfind-links = /wheels /others\ntrusted-host = mirror.example\n"
    )
    environment = {"HOME": str(tmp_path), "XDG_CONFIG_DIRS": "/nonexistent", "PIP_CERT": "/certificates.pem", "PIP_DEFAULT_TIMEOUT": "9"}
    assert settings_of_pip(environment) == {
        "UV_SYSTEM_CERTS": "1",
        "UV_DEFAULT_INDEX": "https://mirror.example/simple",
        "UV_INDEX": "https://more.example/simple",
        "UV_INDEX_STRATEGY": "unsafe-best-match",
        "UV_FIND_LINKS": "/wheels,/others",
        "UV_INSECURE_HOST": "mirror.example",
        "UV_HTTP_TIMEOUT": "9",
        "SSL_CERT_FILE": "/certificates.pem",
    }


def test_variables_win_over_files_and_those_of_uv_over_both(tmp_path):
    (tmp_path / "pip.conf").write_text("[global]\nindex-url = https://file.example\n")
    environment = {"PIP_CONFIG_FILE": str(tmp_path / "pip.conf"), "XDG_CONFIG_DIRS": "/nonexistent"}
    assert settings_of_pip(environment)["UV_DEFAULT_INDEX"] == "https://file.example"
    environment["PIP_INDEX_URL"] = "https://variable.example"
    assert settings_of_pip(environment)["UV_DEFAULT_INDEX"] == "https://variable.example"
    environment["UV_DEFAULT_INDEX"] = "https://own.example"
    assert "UV_DEFAULT_INDEX" not in settings_of_pip(environment)


def test_a_file_that_cannot_be_read_is_left_out(tmp_path):
    (tmp_path / "pip.conf").write_text("index-url without a section\n")
    assert "UV_DEFAULT_INDEX" not in settings_of_pip({"PIP_CONFIG_FILE": str(tmp_path / "pip.conf"), "XDG_CONFIG_DIRS": "/nonexistent"})


# --- the Python it is made with ---------------------------------------------------------------------------------------------------


def found_python(tmp_path: Path, **environment: str) -> str:
    """What a checkout without .venv finds."""
    script = tmp_path / "checkout" / "scripts" / "find-python"
    script.parent.mkdir(parents=True, exist_ok=True)
    script.write_text((PROJECT_DIR / "scripts" / "find-python").read_text().replace(" /usr/bin/python3 ", " "))
    return subprocess.run(
        ["/bin/bash", str(script)],
        env={"PATH": f"{tmp_path}/path:/usr/bin:/bin", **environment},
        capture_output=True,
        text=True,
        check=False,
    ).stdout.strip()


def test_an_optimised_python_is_preferred(tmp_path):
    program(tmp_path / "path" / "python3", "plain")
    program(tmp_path / "path" / "python3.14", "unusable")
    program(tmp_path / "path" / "python3.13", "optimised")
    program(tmp_path / "path" / "python3.12", "optimised")
    assert found_python(tmp_path) == f"{tmp_path}/path/python3.13"


def test_the_first_python_is_used_where_none_is_optimised(tmp_path):
    for version in ("3", "3.14", "3.13", "3.12", "3.11"):
        program(tmp_path / "path" / f"python{version}", "plain")
    assert found_python(tmp_path) == f"{tmp_path}/path/python3"


def test_that_of_the_venv_and_the_one_that_is_asked_for_are_not_left(tmp_path):
    program(tmp_path / "path" / "python3", "optimised")
    own = program(tmp_path / "checkout" / ".venv" / "bin" / "python", "9000")
    assert found_python(tmp_path) == str(own)
    asked = program(tmp_path / "asked" / "python", "9000")
    assert found_python(tmp_path, SPANWISE_PYTHON=str(asked)) == str(asked)
