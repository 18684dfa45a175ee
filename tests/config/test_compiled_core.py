"""Every process finds what set-up has compiled, also where the checkout is read-only."""

import os
from pathlib import Path

import pytest

from config.compiled import compiled_core
from config.compiled.compiled_core import STAMP, STAMP_LETTERS, compiled_directory, compiled_stamp, is_compiled


@pytest.fixture
def shipped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A compiled core as set-up leaves it, and a state of its own."""
    folder = tmp_path / "checkout" / "compiled" / compiled_stamp()[:STAMP_LETTERS]
    folder.mkdir(parents=True)
    (folder / "ways.nbi").write_text("compiled")
    (folder / STAMP).write_text(compiled_stamp())
    monkeypatch.setattr(compiled_core, "SHIPPED", folder.parent)
    monkeypatch.setenv("SPANWISE_VAR", str(tmp_path / "state"))
    return folder


def make_read_only(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "access", lambda path, mode: False)  # as root nothing else is


def test_it_is_used_where_set_up_has_put_it(shipped):
    assert compiled_directory() == shipped
    assert is_compiled(shipped)


def test_a_read_only_checkout_is_copied_to_the_state_once(shipped, tmp_path, monkeypatch):
    make_read_only(monkeypatch)
    own = compiled_directory()
    assert own == tmp_path / "state" / "compiled" / shipped.name
    assert (own / "ways.nbi").read_text() == "compiled"
    (own / "more.nbi").write_text("made since")
    assert (compiled_directory() / "more.nbi").exists()


def test_a_copy_that_was_never_finished_is_replaced(shipped, tmp_path, monkeypatch):
    own = tmp_path / "state" / "compiled" / shipped.name
    own.mkdir(parents=True)
    (own / "ways.nbi").write_text("half")
    make_read_only(monkeypatch)
    assert compiled_directory() == own
    assert (own / "ways.nbi").read_text() == "compiled"
    assert [path.name for path in own.parent.iterdir()] == [shipped.name]


def test_nothing_is_read_that_was_compiled_from_other_sources(shipped, tmp_path, monkeypatch):
    source = tmp_path / "core" / "ways.py"
    source.parent.mkdir()
    source.write_text("from numba import njit")
    monkeypatch.setattr(compiled_core, "SOURCE_FOLDERS", (str(source.parent),))
    before = compiled_directory()
    source.write_text("from numba import njit, prange")
    assert compiled_directory() != before
    make_read_only(monkeypatch)
    assert not compiled_directory().exists()


def test_the_place_and_the_times_of_the_sources_do_not_count(tmp_path, monkeypatch):
    """Another checkout of the same content, made later, may use the same code."""
    stamps = set()
    for name in ("one", "another"):
        for file in ("requirements.txt", "config/compiled/compiled_places.py", "core/ways.py"):
            path = tmp_path / name / file
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text("the same")
            os.utime(path, (len(stamps), len(stamps)))
        monkeypatch.setattr(compiled_core, "PROJECT_DIR", tmp_path / name)
        monkeypatch.setattr(compiled_core, "SOURCE_FOLDERS", ("core",))
        stamps.add(compiled_stamp())
    assert len(stamps) == 1


@pytest.mark.parametrize(
    ("file", "content", "is_another"),
    [
        ("requirements.txt", "numba==2.0", True),
        ("requirements.txt", "zstandard==2.0", False),
        ("config/compiled/compiled_places.py", "another", True),
        ("core/ways.py", "another", True),
    ],
)
def test_what_decides_about_the_code_is_part_of_the_stamp(tmp_path, monkeypatch, file, content, is_another):
    for name in ("requirements.txt", "config/compiled/compiled_places.py", "core/ways.py"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("the same")
    monkeypatch.setattr(compiled_core, "PROJECT_DIR", tmp_path)
    monkeypatch.setattr(compiled_core, "SOURCE_FOLDERS", ("core",))
    before = compiled_stamp()
    (tmp_path / file).write_text(content)
    assert (compiled_stamp() != before) is is_another


def test_a_moved_source_has_another_stamp(tmp_path, monkeypatch):
    monkeypatch.setattr(compiled_core, "SOURCE_FOLDERS", (str(tmp_path),))
    (tmp_path / "ways.py").write_text("the same")
    before = compiled_stamp()
    (tmp_path / "ways.py").rename(tmp_path / "paths.py")
    assert compiled_stamp() != before


def test_options_and_processors_that_change_the_code_have_a_stamp_each(monkeypatch):
    stamps = [compiled_stamp()]
    monkeypatch.setenv("NUMBA_BOUNDSCHECK", "1")
    stamps.append(compiled_stamp())
    monkeypatch.setattr(compiled_core, "_processor", lambda: "another")
    stamps.append(compiled_stamp())
    assert len(set(stamps)) == 3


def test_what_was_compiled_from_other_sources_is_not_taken_for_good(shipped):
    (shipped / STAMP).write_text("other")
    assert not is_compiled(shipped)
    (shipped / STAMP).unlink()
    assert not is_compiled(shipped)


def test_a_place_named_from_outside_is_kept(shipped, monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", "/elsewhere")
    compiled_core.use_compiled_directory()
    assert os.environ["NUMBA_CACHE_DIR"] == "/elsewhere"
    monkeypatch.delenv("NUMBA_CACHE_DIR")
    compiled_core.use_compiled_directory()
    assert os.environ["NUMBA_CACHE_DIR"] == str(shipped)
