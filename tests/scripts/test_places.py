"""The folders of one state: made where they are missing, refused where they are somebody else's."""

import os
import shutil
import stat
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from config.private_servers import private_database_url, socket_directory
from scripts.places import CannotStart, prepare_sockets, prepare_state, remove_sockets


@pytest.fixture(autouse=True)
def temporary_folder(monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A temporary folder for this test alone, with a path short enough for sockets (pytest's own is not)."""
    folder = Path(tempfile.mkdtemp(prefix="sw-"))
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    yield folder
    shutil.rmtree(folder)


def _make_state(path: Path) -> Path:
    prepare_state(path)
    return path


def test_a_state_is_closed_to_other_users(tmp_path: Path) -> None:
    path = tmp_path / "var"
    path.mkdir(mode=0o755)
    mode = stat.S_IMODE(_make_state(path).stat().st_mode)
    assert mode == (0o711 if os.geteuid() == 0 else 0o700), "as root, PostgreSQL's own user has to pass through it, and sees no list"


def test_the_socket_folder_is_closed_to_others_and_noted_for_every_shell(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    state = _make_state(tmp_path / "var")
    sockets = prepare_sockets(state)
    assert stat.S_IMODE(sockets.stat().st_mode) == 0o700
    monkeypatch.setattr(tempfile, "tempdir", "/elsewhere")
    assert socket_directory(state) == sockets
    assert str(sockets).replace("/", "%2F") in private_database_url(state)


def test_preparing_twice_gives_the_same_folder(tmp_path: Path) -> None:
    state = _make_state(tmp_path / "var")
    assert prepare_sockets(state) == prepare_sockets(state)


def test_two_states_have_two_socket_folders(tmp_path: Path) -> None:
    assert prepare_sockets(_make_state(tmp_path / "one")) != prepare_sockets(_make_state(tmp_path / "two"))


def test_a_copied_state_does_not_share_the_originals_sockets(tmp_path: Path) -> None:
    original, copy = _make_state(tmp_path / "one"), _make_state(tmp_path / "two")
    sockets = prepare_sockets(original)
    (copy / "socket_directory").write_text((original / "socket_directory").read_text())
    assert prepare_sockets(copy) != sockets


def test_a_folder_that_somebody_has_put_in_the_way_is_not_used(tmp_path: Path) -> None:
    state = _make_state(tmp_path / "var")
    expected = socket_directory(state)
    expected.symlink_to(tmp_path)
    sockets = prepare_sockets(state)
    assert sockets != expected
    assert not sockets.is_symlink()
    assert socket_directory(state) == sockets


def test_socket_paths_stay_short_whatever_the_temporary_folder_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tempfile, "tempdir", "/" + "long" * 30)
    state = _make_state(tmp_path / "var")
    sockets = prepare_sockets(state)
    assert len(str(sockets / "supervisor.sock.4194304")) <= 107
    remove_sockets(state)
    assert not sockets.exists()


def test_only_a_folder_that_was_made_for_the_state_is_removed(tmp_path: Path, temporary_folder: Path) -> None:
    state = _make_state(tmp_path / "var")
    prepare_sockets(state)
    other = temporary_folder / "other"
    other.mkdir()
    (state / "socket_directory").write_text(str(other))
    remove_sockets(state)
    assert other.exists()


def test_a_state_of_another_user_is_refused_untouched(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    state = _make_state(tmp_path / "var")
    before = sorted(state.iterdir())
    monkeypatch.setattr(os, "geteuid", lambda: os.getuid() + 1)
    with pytest.raises(CannotStart, match="belongs to user id"):
        prepare_state(state)
    assert sorted(state.iterdir()) == before


def test_a_state_folder_that_cannot_be_made_is_refused(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(CannotStart, match="cannot write"):
        prepare_state(tmp_path / "file" / "var")
