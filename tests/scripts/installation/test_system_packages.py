"""What ./run and ./check find missing on a machine, and what they do about it."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from scripts.installation import install, postgresql_installations, system_packages
from scripts.places import PROJECT_DIR


def test_without_apt_the_line_for_root_is_printed_and_the_exit_code_is_3(tmp_path: Path) -> None:
    environment = {"PATH": str(tmp_path), "PYTHONPATH": str(PROJECT_DIR), "DATABASE_URL": "postgis://elsewhere/spanwise"}
    answer = subprocess.run(
        [sys.executable, "-m", "scripts.installation.install", "check-fast"], env=environment, capture_output=True, text=True, check=False
    )
    assert answer.returncode == 3
    line = answer.stderr.splitlines()[-1]
    assert line.startswith("  apt-get update && apt-get install -y --no-install-recommends ")
    assert line.endswith("redis-server")
    assert "postgresql" not in line


def test_who_is_not_root_installs_nothing(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(system_packages, "missing_packages", lambda purpose: ["redis-server", "nginx-light"])
    monkeypatch.setattr(system_packages, "install", lambda purpose: pytest.fail("installed something"))
    monkeypatch.setattr(os, "geteuid", lambda: 1000)
    assert install.main("run") == 3
    assert "install -y --no-install-recommends redis-server nginx-light\n" in capsys.readouterr().err


def test_the_servers_of_the_environment_need_no_server_packages(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("DATABASE_URL", "postgis://elsewhere/spanwise")
    monkeypatch.setenv("REDIS_URL", "redis://elsewhere")
    monkeypatch.setattr(system_packages, "installed_servers", list)
    monkeypatch.setattr(system_packages, "find_program", lambda name: None)
    monkeypatch.setattr("ctypes.util.find_library", lambda name: "here" if name == "geos_c" else None)
    monkeypatch.setattr(system_packages, "_available", lambda subject: {"gdal": "libgdal32"}[subject])
    assert system_packages.missing_packages("run") == ["libgdal32", "nginx-light"]


def test_postgis_is_asked_for_in_the_version_of_the_server_that_is_there(monkeypatch: pytest.MonkeyPatch) -> None:
    server = postgresql_installations.PostgreSQL(version=17, programs=Path("/usr/lib/postgresql/17/bin"), has_postgis=False)
    monkeypatch.delenv("DATABASE_URL", raising=False)
    monkeypatch.setattr(system_packages, "installed_servers", lambda: [server])
    monkeypatch.setattr(system_packages, "find_program", lambda name: "/found")
    assert system_packages.missing_packages("run") == ["postgresql-17-postgis-3", "postgresql-17-postgis-3-scripts"]


def test_no_package_starts_a_service_while_it_is_installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    policy = tmp_path / "policy-rc.d"
    monkeypatch.setattr(system_packages, "POLICY_FILE", policy)
    with system_packages.no_service_starts():
        assert subprocess.run([str(policy)], check=False).returncode == 101
    assert not policy.exists()


def test_a_machines_own_policy_file_is_left_as_it_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    policy = tmp_path / "policy-rc.d"
    policy.write_text("#!/bin/sh\nexit 104\n")
    monkeypatch.setattr(system_packages, "POLICY_FILE", policy)
    with system_packages.no_service_starts():
        assert policy.read_text() == "#!/bin/sh\nexit 104\n"
    assert policy.read_text() == "#!/bin/sh\nexit 104\n"


def test_a_policy_file_that_an_interrupted_set_up_left_is_removed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    policy = tmp_path / "policy-rc.d"
    policy.write_text(f"#!/bin/sh\n{system_packages.POLICY_MARK}\nexit 101\n")
    monkeypatch.setattr(system_packages, "POLICY_FILE", policy)
    with system_packages.no_service_starts():
        pass
    assert not policy.exists()


def _make_server(folder: Path, version: int) -> Path:
    programs = folder / str(version) / "bin"
    programs.mkdir(parents=True)
    for name in ("initdb", "postgres"):
        (programs / name).write_text(f"#!/bin/sh\necho '{name} (PostgreSQL) {version}.3'\n")
        (programs / name).chmod(0o755)
    return programs


def test_the_newest_server_with_postgis_is_taken_and_an_old_one_is_not_seen(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for version in (14, 15, 16, 17):
        _make_server(tmp_path / "lib", version)
    for version in (14, 15, 16):  # 17 is newer, and has none
        extension = tmp_path / "share" / str(version) / "extension"
        extension.mkdir(parents=True)
        (extension / "postgis.control").touch()
    monkeypatch.setattr(postgresql_installations, "DEBIAN_PROGRAMS", tmp_path / "lib")
    monkeypatch.setattr(postgresql_installations, "DEBIAN_SHARED", tmp_path / "share")
    monkeypatch.setenv("PATH", "/nowhere")
    assert [(server.version, server.has_postgis) for server in postgresql_installations.installed_servers()] == [
        (16, True),
        (15, True),
        (17, False),
    ]


def test_a_data_folder_is_opened_by_the_version_that_made_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    servers = [postgresql_installations.PostgreSQL(version, tmp_path, has_postgis=True) for version in (17, 15)]
    monkeypatch.setattr(postgresql_installations, "installed_servers", lambda: servers)
    assert postgresql_installations.server_for(tmp_path) == servers[0]
    (tmp_path / "PG_VERSION").write_text("15\n")
    assert postgresql_installations.server_for(tmp_path) == servers[1]
    (tmp_path / "PG_VERSION").write_text("16\n")
    assert postgresql_installations.server_for(tmp_path) is None


def test_a_python_that_does_not_run_is_passed_over(tmp_path: Path) -> None:
    broken = tmp_path / "python"
    broken.write_text("#!/bin/sh\nexit 1\n")
    broken.chmod(0o755)
    environment = {**os.environ, "SPANWISE_PYTHON": str(broken)}
    found = subprocess.run([str(PROJECT_DIR / "scripts" / "find-python")], env=environment, capture_output=True, text=True, check=True)
    assert found.stdout.strip() not in {"", str(broken)}
