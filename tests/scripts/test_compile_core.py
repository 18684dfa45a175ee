"""Several processes compile at a time, and none of them overwrites what another one has compiled."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from config.compiled.compiled_core import COMPILER_LIBRARIES, compiler_versions, numba_settings
from scripts import compile_core
from scripts.compile_core import PARTS, index_files, take_over

PROJECT_DIR = Path(__file__).resolve().parent.parent.parent


def add(folder: Path, function: str, index: str, **data: str) -> None:
    (folder / "inspection.network").mkdir(parents=True, exist_ok=True)
    (folder / "inspection.network" / f"{function}.nbi").write_text(index)
    for number, code in data.items():
        (folder / "inspection.network" / f"{function}.{number.strip('_')}.nbc").write_text(code)


def files(folder: Path) -> dict[str, str]:
    return {path.name: path.read_text() for path in folder.rglob("*") if path.is_file()}


def test_only_a_version_of_the_compilers_libraries_asks_for_a_new_core():
    pinned = (PROJECT_DIR / "requirements.txt").read_text()
    versions = compiler_versions(pinned)
    assert [version.partition("==")[0] for version in versions] == list(COMPILER_LIBRARIES)
    assert compiler_versions(pinned + "numba-extras==1.0\nzstandard==0.23.0 \\\n    --hash=sha256:00\n") == versions
    assert compiler_versions(pinned.replace("numba==", "numba==1")) != versions


def test_functions_that_a_part_adds_are_taken_over(tmp_path):
    whole, part = tmp_path / "whole", tmp_path / "part"
    add(whole, "ways._path-1.py311", "int64", _1="code for int64")
    add(part, "ways._path-1.py311", "int64", _1="code for int64")
    before = index_files(part)
    add(part, "ways._path-1.py311", "int64, int32", _2="code for int32")
    add(part, "ways._between-9.py311", "int64", _1="between")
    take_over(part, before, whole)
    assert files(whole) == files(part)


def test_of_two_parts_that_have_compiled_one_function_the_first_is_kept_whole(tmp_path):
    """Both call their code number 1: the index of one with the code of the other would run code for other types."""
    whole, part = tmp_path / "whole", tmp_path / "part"
    part.mkdir()
    before = index_files(part)
    add(part, "ways._path-1.py311", "int32", _1="code for int32")
    add(whole, "ways._path-1.py311", "int64", _1="code for int64")
    take_over(part, before, whole)
    assert files(whole) == {"ways._path-1.py311.nbi": "int64", "ways._path-1.py311.1.nbc": "code for int64"}


def test_what_another_part_has_added_since_is_kept(tmp_path):
    whole, part = tmp_path / "whole", tmp_path / "part"
    add(part, "ways._path-1.py311", "int64", _1="code for int64")
    before = index_files(part)
    add(whole, "ways._path-1.py311", "int64, int32", _1="code for int64", _2="code for int32")
    take_over(part, before, whole)
    assert (whole / "inspection.network" / "ways._path-1.py311.nbi").read_text() == "int64, int32"


def test_a_part_that_fails_fails_the_whole_and_leaves_no_process(tmp_path, monkeypatch):
    started = []

    def start(part, compiled, folder):
        code = "import sys, time; time.sleep(60 * (sys.argv[1] == 'search')); sys.exit(3)"
        process = subprocess.Popen([sys.executable, "-c", code, part.name])
        started.append(process)
        return compile_core._Run(part, folder, 0.0, process)

    monkeypatch.setattr(compile_core, "_start", start)
    (tmp_path / "new").mkdir()
    with pytest.raises(subprocess.CalledProcessError):
        compile_core.compile_parts(tmp_path / "new", processes=2)
    assert len(started) == 2
    assert all(process.poll() is not None for process in started)
    assert [path.name for path in tmp_path.iterdir()] == ["new"]


def test_what_programs_have_compiled_meanwhile_is_replaced(tmp_path, monkeypatch):
    folder = tmp_path / "compiled" / "digest"

    def compile_beside_a_program(new: Path, processes: int) -> None:
        add(new, "ways._path-1.py311", "whole")
        add(folder, "ways._path-1.py311", "of the program")

    monkeypatch.setattr(compile_core, "compiled_directory", lambda: folder)
    monkeypatch.setattr(compile_core, "compiled_stamp", lambda: "stamp")
    monkeypatch.setattr(compile_core, "is_compiled", lambda path: False)
    monkeypatch.setattr(compile_core, "compile_parts", compile_beside_a_program)
    monkeypatch.setattr(compile_core.user_cache, "fetch", lambda *place: False)
    monkeypatch.setattr(compile_core.user_cache, "publish", lambda *place: None)
    assert compile_core.main([]) == 0
    assert files(folder) == {"ways._path-1.py311.nbi": "whole", "stamp": "stamp"}


def test_a_second_process_waits_for_the_first_and_reports_its_progress(tmp_path, monkeypatch, capsys):
    folder = tmp_path / "compiled" / "digest"
    folder.parent.mkdir()
    (folder.parent / "log").write_text("graph, 1 of 4 parts, 23 s\nsearch, 2 of 4 parts, 66 s\n")
    monkeypatch.setattr(compile_core, "compiled_directory", lambda: folder)
    monkeypatch.setattr(compile_core, "is_compiled", lambda path: path.exists())
    monkeypatch.setattr(compile_core, "compile_parts", lambda *arguments: pytest.fail("compiled twice"))
    monkeypatch.setattr(compile_core, "REPORT_INTERVAL_S", 0.0)
    first = (
        "import fcntl, sys, time, pathlib\n"
        "parent = pathlib.Path(sys.argv[1])\n"
        "lock = (parent / 'lock').open('w')\n"
        "fcntl.flock(lock, fcntl.LOCK_EX)\n"
        "print('locked', flush=True)\n"
        "time.sleep(0.5)\n"
        "(parent / 'digest').mkdir()\n"
    )
    with subprocess.Popen([sys.executable, "-c", first, str(folder.parent)], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout.readline() == "locked\n"
        compile_core.compile_core()
        assert process.wait() == 0
    assert "(search, 2 of 4 parts, 66 s)" in capsys.readouterr().out


def test_of_older_code_the_newest_is_kept_for_programs_that_run(tmp_path):
    for age, name in enumerate(("newest", "older", "oldest")):
        (tmp_path / name).mkdir()
        os.utime(tmp_path / name, (1_000.0 - age, 1_000.0 - age))
    (tmp_path / "lock").touch()
    compile_core.remove_older(tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["lock", "newest"]


def test_parts_come_after_those_they_call():
    names = [part.name for part in PARTS]
    assert all(names.index(earlier) < names.index(part.name) for part in PARTS for earlier in part.after)


@pytest.mark.long
def test_code_compiled_in_one_checkout_is_read_in_another_one(tmp_path):
    """The same package in two places; the locator is told that each is the project."""
    for name in ("first", "second"):
        package = tmp_path / name / "core"
        package.mkdir(parents=True)
        (package / "doubled.py").write_text("from numba import njit\n\n@njit(cache=True)\ndef doubled(x):\n    return 2 * x\n")
    (tmp_path / "program.py").write_text(
        "import sys, pathlib, json\n"
        "from config.compiled import compiled_places\n"
        "compiled_places.PROJECT_DIR = pathlib.Path(sys.argv[1])\n"
        "sys.path.insert(0, sys.argv[1])\n"
        "from core.doubled import doubled\n"
        "print(json.dumps([doubled(21), sum(doubled.stats.cache_hits.values())]))\n"
    )
    environment = {**os.environ, **numba_settings(tmp_path / "compiled"), "PYTHONPATH": str(PROJECT_DIR)}

    def run(name: str) -> list[int]:
        command = [sys.executable, str(tmp_path / "program.py"), str(tmp_path / name)]
        return json.loads(subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout)

    assert run("first") == [42, 0]
    assert run("second") == [42, 1]
    assert [path.name for path in (tmp_path / "compiled").iterdir()] == ["core"]
    (tmp_path / "second" / "core" / "doubled.py").write_text(
        "from numba import njit\n\n@njit(cache=True)\ndef doubled(x):\n    return 3 * x\n"
    )
    assert run("second") == [63, 0]
