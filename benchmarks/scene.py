"""The 3D view over real regions: draw calls, script time of a frame, and memory while it plays.

    python -m benchmarks.scene [--minutes 10] [--regions columbus nepal funen] [--write]

For each region a whole installation (./run) is started over its OpenStreetMap file, with a planned mission of eight UAVs whose targets lie
so far apart that a thousand towers stand in the picture. Chromium draws without a graphics card here, so that no frame rate says anything:
counted are the draw calls of a frame (three.js), the milliseconds of processor time that scripts (our own code and three.js) take for it
in the page's main thread, and after each half minute of a playing view the heap after a collection and what the graphics hold. With
--write the table goes to docs/performance.md. Exits with 1 where a bar is missed.
"""

import argparse
import json
import os
import shutil
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from datetime import date, timedelta
from pathlib import Path
from typing import Any

import numpy as np
from playwright.sync_api import Browser, CDPSession, Page, sync_playwright

from benchmarks.report import machine, table, write_section
from scripts.installation.system_packages import BROWSERS
from scripts.places import Places
from tests.browser.chromium import CHROMIUM_FLAGS
from tests.browser.operator_map import unlimited_type

PROJECT_DIR = Path(__file__).resolve().parents[1]
DATA = PROJECT_DIR.parent / "shared" / "data" / "osm"
REGIONS = {
    "columbus": "columbus-ohio.osm.pbf",
    "nepal": "nepal-power-2025.osm.pbf",
    "funen": "funen-power-nodes-2019.osm.pbf",  # more towers within a picture than the others have, but none of their wires
}
BAR_CALLS, BAR_SCRIPT_MS = 60, 8.0
BAR_TOWERS = 1_000
NEARLY_ALL = 0.85  # of a box that has fewer
BAR_GROWTH = 1.05  # of the heap from the first third of the time to the last
BESIDE_DEG = (0.002, 0.002)  # of a target a UAV starts
HALF_BOX_DEG = 0.16  # of the latitude, round the middle of the densest part
TARGETS = 8
SAMPLE_S = 30.0
WARM_UP_S = 20.0
SLOWER = 3
TIMEOUT_MS = 180_000
VIEWPORT: Any = {"width": 960, "height": 600}  # what a frame costs the script does not go with its pixels
VIEWS = {"all of it": ("f",), "from above": ("t", "f"), "from behind": ("c",), "round a target": ("o",)}


@dataclass
class Measured:
    region: str
    of_box: int = 0  # towers in its densest box of about 36 km
    towers: int = 0
    calls: int = 0
    triangles: int = 0
    script_ms: dict[str, float] = field(default_factory=dict)
    heap_mb: list[float] = field(default_factory=list)
    held: list[tuple[int, int]] = field(default_factory=list)  # geometries, textures

    @property
    def growth(self) -> float:
        third = max(1, len(self.heap_mb) // 3)
        return float(np.mean(self.heap_mb[-third:]) / np.mean(self.heap_mb[:third])) if self.heap_mb else 1.0

    @property
    def is_passed(self) -> bool:
        is_flat = self.growth <= BAR_GROWTH and len(set(self.held)) <= 1
        is_quick = max(self.script_ms.values()) <= BAR_SCRIPT_MS
        is_full = self.towers >= min(BAR_TOWERS, NEARLY_ALL * self.of_box)
        return is_full and self.calls <= BAR_CALLS and is_quick and is_flat


@contextmanager
def installation(osm_file: Path) -> Iterator[tuple[str, str]]:
    """Address and the password of its administrator."""
    state = Path(tempfile.mkdtemp(prefix="sw-", dir="/tmp"))  # short enough for sockets
    environment = {name: value for name, value in os.environ.items() if name not in {"DATABASE_URL", "REDIS_URL"}}
    environment |= {"SPANWISE_VAR": str(state), "SPANWISE_BASE_MAP_TILES": "", "SPANWISE_GATEWAY_UDP": "", "SPANWISE_GATEWAY_TCP": ""}
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = int(probe.getsockname()[1])

    def run(*options: str) -> None:
        done = subprocess.run(["./run", *options], cwd=PROJECT_DIR, env=environment, capture_output=True, text=True, check=False)
        if done.returncode:
            raise SystemExit(f"{done.stdout}\n{done.stderr}")

    try:
        run("--detach", "--port", str(port), "--osm", str(osm_file))
        yield f"http://127.0.0.1:{port}", (state / "demo_password").read_text().strip()
    finally:
        run("--stop")
        shutil.rmtree(Places(state).data, ignore_errors=True)  # as root the database may stand outside the state folder
        shutil.rmtree(state, ignore_errors=True)


def signed_in(browser: Browser, address: str, password: str) -> Page:
    context = browser.new_context(base_url=address, viewport=VIEWPORT, reduced_motion="no-preference")
    page = context.new_page()
    page.set_default_timeout(TIMEOUT_MS)
    page.goto("/sign-in")
    page.get_by_label("User name").fill("demo")
    page.get_by_label("Password").fill(password)
    page.get_by_role("button", name="Sign in").click()
    page.locator("html[data-loaded]").wait_for(state="attached")
    return page


def asks(page: Page, path: str) -> Any:
    answer = page.request.get(path if path.startswith("/api") else f"/api/v1{path}", timeout=TIMEOUT_MS)
    if not answer.ok:
        raise SystemExit(f"{path}: {answer.status} {answer.text()[:300]}")
    return answer.json()


def posts(page: Page, path: str, body: dict[str, Any]) -> Any:
    token = next(cookie["value"] for cookie in page.context.cookies() if cookie["name"] == "csrftoken")
    answer = page.request.post(f"/api/v1{path}", data=body, headers={"X-CSRFToken": token}, timeout=TIMEOUT_MS)
    if not answer.ok:
        raise SystemExit(f"{path}: {answer.status} {answer.text()[:300]}")
    return answer.json()


def towers_of(page: Page) -> tuple[list[int], np.ndarray]:
    ids: list[int] = []
    places: list[list[float]] = []
    address = "/assets?kind=tower&limit=1000"
    while address:
        found = asks(page, address)
        for feature in found["features"]:
            ids.append(feature["id"])
            places.append(feature["geometry"]["coordinates"][:2])
        address = found.get("next")
    return ids, np.array(places)


def spread_targets(places: np.ndarray) -> tuple[list[int], int]:
    """Rows of towers in the densest box of the region, each as far as possible from those before; how many towers the box has."""
    squeezed = places * (np.cos(np.radians(np.median(places[:, 1]))), 1.0)
    trials = np.random.default_rng(7).choice(len(places), min(400, len(places)), replace=False)
    counts = [int((np.abs(squeezed - squeezed[trial]).max(axis=1) < HALF_BOX_DEG).sum()) for trial in trials]
    inside = np.flatnonzero(np.abs(squeezed - squeezed[trials[int(np.argmax(counts))]]).max(axis=1) < HALF_BOX_DEG)
    chosen = [int(inside[0])]
    away = np.full(len(inside), np.inf)
    for _ in range(TARGETS - 1):
        away = np.minimum(away, np.linalg.norm(squeezed[inside] - squeezed[chosen[-1]], axis=1))
        chosen.append(int(inside[int(np.argmax(away))]))
    return chosen, len(inside)


def planned_mission(page: Page) -> tuple[str, int]:
    """Its key, and how many towers its box has."""
    ids, places = towers_of(page)
    targets, of_box = spread_targets(places)
    starts = [places[target] + BESIDE_DEG for target in targets]  # each has a UAV of its own: lines need not be connected
    of = unlimited_type(page)
    uavs = [
        posts(page, "/uavs", {"name": f"UAV {number}", "position": start.tolist(), "type": of})["id"] for number, start in enumerate(starts)
    ]
    body = {
        "name": "Benchmark",
        "uavs": [{"id": uav, "most_targets": 1} for uav in uavs],
        "targets": [{"asset": ids[target]} for target in targets],
    }
    departs_at = f"{date.today() + timedelta(days=20)}T15:00:00Z"
    mission = posts(page, "/missions", {**body, "return_to_start": False, "plan": True, "departs_at": departs_at})
    until = time.monotonic() + TIMEOUT_MS / 1_000
    while asks(page, f"/missions/{mission['id']}")["plan"] is None and time.monotonic() < until:
        time.sleep(1)
    return str(mission["id"]), of_box


def figures(page: Page) -> dict[str, float]:
    return dict(json.loads(page.evaluate("JSON.stringify(spanwiseScene.figures())")))


def keeps_playing(page: Page) -> None:
    if page.locator(".scene-play").get_attribute("data-image") == "play":
        page.evaluate("document.querySelector('.scene-play').click()")


def script_s(wire: CDPSession) -> float:
    """Processor time that the page's main thread has spent in scripts."""
    return next(float(metric["value"]) for metric in wire.send("Performance.getMetrics")["metrics"] if metric["name"] == "ScriptDuration")


def heap_mb(wire: CDPSession) -> float:
    wire.send("HeapProfiler.collectGarbage")
    return float(wire.send("Runtime.getHeapUsage")["usedSize"]) / 1e6


def measure(page: Page, region: str, minutes: float) -> Measured:
    found = Measured(region)
    mission, found.of_box = planned_mission(page)
    page.goto(f"/missions/{mission}/3d?source=plan")
    page.locator("html[data-loaded]").wait_for(state="attached")
    page.wait_for_function("() => spanwiseScene.figures()?.frames >= 0")
    wire = page.context.new_cdp_session(page)
    wire.send("Performance.enable", {"timeDomain": "threadTicks"})  # of the processor, however busy the machine is with other things
    for _ in range(SLOWER):
        page.keyboard.press("<")  # so that it plays through a view
    for view, keys in VIEWS.items():
        for key in keys:
            page.keyboard.press(key)
        keeps_playing(page)
        page.wait_for_timeout(WARM_UP_S * 1_000 / 2)  # shaders are built with the first frames
        keeps_playing(page)
        figures(page)
        began_s = script_s(wire)
        page.wait_for_timeout(WARM_UP_S * 1_000)
        reported, ended_s = figures(page), script_s(wire)
        found.towers, found.calls = max(found.towers, int(reported["towers"])), max(found.calls, int(reported["calls"]))
        found.triangles = max(found.triangles, int(reported["triangles"]))
        found.script_ms[view] = (ended_s - began_s) * 1_000 / max(reported["frames"], 1)
        keeps_playing(page)
        print(f"{region}, {view}: {found.script_ms[view]:.2f} ms of script a frame; {reported}", flush=True)
    page.keyboard.press("c")
    wire.send("HeapProfiler.enable")
    for _ in range(round(minutes * 60 / SAMPLE_S)):
        until = time.monotonic() + SAMPLE_S
        while time.monotonic() < until:
            keeps_playing(page)
            page.wait_for_timeout(2_000)
        reported = figures(page)
        found.heap_mb.append(heap_mb(wire))
        found.held.append((int(reported["geometries"]), int(reported["textures"])))
    print(f"{region}: heap [MB] {[round(one, 1) for one in found.heap_mb]}, held {sorted(set(found.held))}", flush=True)
    page.context.close()
    return found


def report(rows: Sequence[Measured], minutes: float) -> str:
    of_views = [f"script ms a frame, {view}" for view in VIEWS]
    head = ["region", "towers in the picture", "draw calls", "triangles", *of_views, "heap after a collection", "geometries, textures"]
    lines = [
        [
            row.region,
            f"{row.towers:,} of {row.of_box:,}",
            str(row.calls),
            f"{row.triangles:,}",
            *(f"{row.script_ms[view]:.1f}" for view in VIEWS),
            f"{row.heap_mb[0]:.1f} to {row.heap_mb[-1]:.1f} MB" if row.heap_mb else "–",
            ", then ".join(f"{geometries}, {textures}" for geometries, textures in dict.fromkeys(row.held)) or "–",
        ]
        for row in rows
    ]
    words = (
        f"`python -m benchmarks.scene --minutes {minutes:g}`: regions of OpenStreetMap, a planned mission of eight UAVs, the view "
        f"playing for {minutes:g} min. Bars: {BAR_TOWERS:,} towers in the picture, or nearly all of the densest 36 km of a region; "
        f"{BAR_CALLS} draw calls; {BAR_SCRIPT_MS:g} ms of script a frame (our code and three.js, without the graphics), "
        "of the processor's time; flat memory. Drawn by the processor: no frame rate is told."
    )
    return f"{words}\n\n{table(head, lines)}\n\n{machine('playwright')}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--minutes", type=float, default=10.0, help="of a playing view, in which memory is looked at")
    parser.add_argument("--regions", nargs="+", choices=list(REGIONS), default=list(REGIONS))
    parser.add_argument("--write", action="store_true", help="into docs/performance.md")
    options = parser.parse_args()
    program = next(filter(None, map(shutil.which, BROWSERS)), None)
    rows = []
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=CHROMIUM_FLAGS)
        for region in options.regions:
            with installation(DATA / REGIONS[region]) as (address, password):
                rows.append(measure(signed_in(browser, address, password), region, options.minutes))
        browser.close()
    text = report(rows, options.minutes)
    print(text)
    if options.write:
        write_section("The 3D view", text)
    sys.exit(0 if all(row.is_passed for row in rows) else 1)


if __name__ == "__main__":
    main()
