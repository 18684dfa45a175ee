"""Checkouts of one user share only what nobody else could have written."""

import os
import time
from pathlib import Path

import pytest

from scripts.installation import user_cache


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    return tmp_path / "cache" / "spanwise"


@pytest.fixture
def compiled(tmp_path: Path) -> Path:
    folder = tmp_path / "compiled"
    (folder / "inspection.network").mkdir(parents=True)
    (folder / "inspection.network" / "ways.nbi").write_text("compiled")
    return folder


def test_an_entry_is_copied_in_place_of_the_target(cache, compiled, tmp_path):
    user_cache.publish(compiled, "compiled", "0123")
    target = tmp_path / "other" / "compiled"
    target.mkdir(parents=True)
    (target / "half").touch()
    assert user_cache.fetch("compiled", "0123", target)
    assert [path.name for path in target.rglob("*")] == ["inspection.network", "ways.nbi"]
    assert [path.name for path in target.parent.iterdir()] == ["compiled"]
    (target / "inspection.network" / "ways.nbi").write_text("changed here")
    assert (cache / "compiled" / "0123" / "inspection.network" / "ways.nbi").read_text() == "compiled"


def test_the_folder_is_closed_to_other_users(cache):
    assert user_cache.user_cache() == cache
    assert cache.stat().st_mode & 0o777 == 0o700


@pytest.mark.parametrize("mode", [0o777, 0o770, 0o702])
def test_a_folder_that_others_may_write_to_is_not_used(cache, compiled, tmp_path, mode):
    user_cache.publish(compiled, "compiled", "0123")
    cache.chmod(mode)
    assert user_cache.user_cache() is None
    assert not user_cache.fetch("compiled", "0123", tmp_path / "target")
    assert not (tmp_path / "target").exists()


def test_a_folder_of_another_user_is_not_used(cache, monkeypatch):
    assert user_cache.user_cache() == cache
    monkeypatch.setattr(os, "geteuid", lambda: cache.stat().st_uid + 1)
    assert user_cache.user_cache() is None


def test_a_link_is_not_used(cache, tmp_path):
    (tmp_path / "elsewhere").mkdir()
    cache.parent.mkdir()
    cache.symlink_to(tmp_path / "elsewhere")
    assert user_cache.user_cache() is None


def test_without_a_place_nothing_is_shared_and_nothing_fails(tmp_path, compiled, monkeypatch):
    (tmp_path / "file").touch()
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    user_cache.publish(compiled, "compiled", "0123")
    assert not user_cache.fetch("compiled", "0123", tmp_path / "target")


def test_an_entry_that_is_not_there_leaves_the_target(cache, compiled):
    assert not user_cache.fetch("compiled", "0123", compiled)
    assert (compiled / "inspection.network").exists()


def test_the_least_used_entries_beyond_the_number_are_removed(cache, compiled):
    for number in range(user_cache.MAX_ENTRIES + 2):
        user_cache.publish(compiled, "compiled", str(number))
        os.utime(cache / "compiled" / str(number), (time.time() - 1_000.0 + number,) * 2)
    assert sorted(path.name for path in (cache / "compiled").iterdir()) == ["2", "3", "4", "5", "6", "7"]


def test_entries_unused_for_long_and_drafts_of_interrupted_copies_are_removed(cache, compiled):
    user_cache.publish(compiled, "compiled", "unused")
    (cache / "compiled" / ".draft-interrupted").mkdir()
    old_s = time.time() - user_cache.MAX_AGE_S - 10.0
    for name in ("unused", ".draft-interrupted"):
        os.utime(cache / "compiled" / name, (old_s, old_s))
    user_cache.publish(compiled, "compiled", "new")
    assert [path.name for path in (cache / "compiled").iterdir()] == ["new"]
