"""What a hostile file could make GDAL do: the child has one driver, its own folder, and no way out of it."""

import socket
import subprocess
import sys
from pathlib import Path

import pytest

from inspection.importers.gdal_process import GdalLimits, GdalRefusal, gdal_process
from tests.inspection.importers.assets.gdal_files import gml, gml_member, gml_point
from tests.runaway import processor_s

ROOT = Path(__file__).resolve().parents[3]
BEGIN = f"""
import sys; sys.path.append({str(ROOT)!r})
import errno, os, socket, subprocess
from inspection.importers.gdal_child.limits import set_limits
def fault_of(call):
    try:
        call()
    except (OSError, MemoryError) as error:
        return type(error).__name__ if isinstance(error, MemoryError) else errno.errorcode[error.errno]
    return "done"
set_limits(256 * 2**20, 1, 1)
"""


def in_the_limits(code: str) -> subprocess.CompletedProcess[str]:
    """Run code as the child runs, after its limits are set."""
    return subprocess.run([sys.executable, "-I", "-S", "-c", BEGIN + code], capture_output=True, text=True, check=False)  # noqa: S603


@pytest.mark.parametrize(
    ("call", "fault"),
    [
        ("socket.socket()", "ENOSYS"),
        ("socket.create_connection(('127.0.0.1', 1))", "ENOSYS"),
        ("os.execv('/bin/true', ['true'])", "ENOSYS"),
        ("os.fork()", "ENOSYS"),
        ("os.kill(os.getppid(), 0)", "ENOSYS"),
        ("os.open('/dev/null', os.O_WRONLY)", "EACCES"),
        ("os.open('made', os.O_CREAT | os.O_RDWR)", "EACCES"),
        ("os.unlink('/nothing')", "ENOSYS"),
        ("os.mkdir('made')", "ENOSYS"),
        ("bytearray(2**30)", "MemoryError"),
        ("os.close(os.open('/dev/null', os.O_RDONLY))", "done"),
    ],
)
def test_the_child_cannot_connect_start_programs_write_or_take_memory(call: str, fault: str) -> None:
    assert in_the_limits(f"print(fault_of(lambda: {call}))").stdout.strip() == fault


@pytest.mark.long
def test_a_child_that_does_not_end_is_ended_after_its_processor_time() -> None:
    began_s = processor_s()
    assert in_the_limits("while True: pass").returncode < 0
    assert processor_s() - began_s < 2.0


def answers(driver: str, path: Path, limits: GdalLimits | None = None) -> list[object]:
    with (
        path.open("rb") as file,
        gdal_process(driver, {f"file.{driver.lower()}": file}, limits or GdalLimits(), layer="", most=10) as process,
    ):
        found = [process.line()]
        while not (isinstance(found[-1], dict) and "features" in found[-1]):
            found.append(process.line())
        return found


@pytest.mark.parametrize("driver", ["GML", "FlatGeobuf", "DXF", "OpenFileGDB", "GTiff"])
def test_the_driver_that_is_named_is_the_only_one(tmp_path: Path, driver: str) -> None:
    path = tmp_path / "a.vrt"
    path.write_text(f'<OGRVRTDataSource><OGRVRTLayer name="a"><SrcDataSource>{tmp_path}</SrcDataSource></OGRVRTLayer></OGRVRTDataSource>')
    with pytest.raises(GdalRefusal):
        answers(driver, path)


def test_what_lies_beside_a_file_is_not_read(tmp_path: Path) -> None:
    """GDAL reads the columns of a GML file from one beside it, and would write one."""
    path = gml(tmp_path / "file.gml", gml_member(gml_point()))
    (tmp_path / "file.gfs").write_text(
        "<GMLFeatureClassList><GMLFeatureClass><Name>hidden</Name><ElementPath>tower</ElementPath></GMLFeatureClass></GMLFeatureClassList>"
    )
    assert answers("GML", path)[0]["layers"] == ["tower"]
    assert sorted(file.name for file in tmp_path.iterdir()) == ["file.gfs", "file.gml"]


def test_a_remote_schema_and_remote_members_are_not_fetched(tmp_path: Path) -> None:
    with socket.socket() as server:
        server.bind(("127.0.0.1", 0))
        server.listen()
        address = f"http://127.0.0.1:{server.getsockname()[1]}"
        path = gml(tmp_path / "a.gml", gml_member(gml_point()) + f'<gml:featureMember xlink:href="{address}/b.gml#T2"/>')
        text = path.read_text().replace(
            "<f:FeatureCollection",
            '<f:FeatureCollection xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" '
            f'xsi:schemaLocation="http://example.org/f {address}/a.xsd"',
        )
        path.write_text(text)
        assert answers("GML", path)[-1] == {"features": 1}
        server.settimeout(0)
        with pytest.raises(BlockingIOError):
            server.accept()


def test_a_file_that_needs_more_processor_time_or_memory_is_refused_with_the_limit(tmp_path: Path) -> None:
    path = gml(tmp_path / "a.gml", "".join(gml_member(gml_point(), f"T{number}") for number in range(300_000)))
    limits = GdalLimits(processor_s=1, processor_s_per_mib=0)
    with (
        pytest.raises(GdalRefusal, match="longer than 1 s"),
        path.open("rb") as file,
        gdal_process("GML", {"a.gml": file}, limits, layer="", most=10**6) as child,
    ):
        while True:
            child.line()
    with pytest.raises(GdalRefusal, match="more than 150 MiB of memory"):
        answers("GML", path, GdalLimits(memory_mib=150))


def test_a_child_that_crashes_is_a_refusal_and_leaves_nothing(tmp_path: Path) -> None:
    path = gml(tmp_path / "a.gml", gml_member(gml_point()))
    with path.open("rb") as file, gdal_process("GML", {"file.gml": file}, layer="", most=1) as process:
        process._process.kill()
        with pytest.raises(GdalRefusal):
            process.line()
    assert process._process.returncode is not None
