"""The map page over 200,000 assets: its tiles over HTTP, its first load in Chromium, and the script time of a frame while somebody pans.

    python -m benchmarks.map_page [--assets 200000] [--state FOLDER]

A whole installation (./run) is started over a made region, the same in every run, and stopped again. With --state it is left in that
folder, and a second run does not import again. Tiles are asked for through the proxy as the browser does, each one twice: the first
answer is made from the database, the second may come from the cache of far zooms.
"""

import argparse
import http.client
import os
import shutil
import socket
import subprocess
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
import osmium
from playwright.sync_api import Browser, Page, Request, sync_playwright

from benchmarks.network.large_region import tile_of, write_region
from scripts.installation.system_packages import BROWSERS
from scripts.places import Places
from tests.browser.chromium import CHROMIUM_FLAGS

PROJECT_DIR = Path(__file__).resolve().parents[1]
SIDE_DEG = 4.5  # some 500 by 360 km: the lines stand as close as in the region of a million
ZOOMS = range(16)
TILES_A_ZOOM = 30
LOADS = 5
PAN_ZOOMS = (6, 8, 10, 11, 12.8, 14)
DRAGS, STEPS, STEP_PX = 4, 30, 9
PLACES_EVERY = 499  # one node of so many is a place to look at

# In every page, before its own scripts: when it could be used, and how long the callbacks of each frame took.
WATCH = """
(() => {
  const watched = { usable: null, drawn: null, frames: new Map() };
  window.watched = watched;
  const look = () => {
    if (document.documentElement?.dataset.loaded) watched.usable ??= performance.now();
    if (document.getElementById("map")?.dataset.idle) watched.drawn ??= performance.now();
    if (watched.usable === null || watched.drawn === null) setTimeout(look, 4);
  };
  look();
  const ask = window.requestAnimationFrame.bind(window);
  window.requestAnimationFrame = (act) =>
    ask((at) => {
      const began = performance.now();
      act(at);
      watched.frames.set(at, (watched.frames.get(at) ?? 0) + performance.now() - began);
    });
})();
"""


@dataclass(frozen=True)
class Installation:
    address: str
    port: int
    password: str


@contextmanager
def installation(state: Path, osm_file: Path, assets: int, keeps: bool) -> Iterator[Installation]:
    environment = {name: value for name, value in os.environ.items() if name not in {"DATABASE_URL", "REDIS_URL"}}
    environment |= {"SPANWISE_VAR": str(state), "SPANWISE_BASE_MAP_TILES": ""}
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = int(probe.getsockname()[1])

    def run(*options: str) -> None:
        done = subprocess.run(["./run", *options], cwd=PROJECT_DIR, env=environment, capture_output=True, text=True, check=False)
        if done.returncode:
            raise SystemExit(f"{done.stdout}\n{done.stderr}")

    is_new = not osm_file.exists()
    if is_new:
        write_region(osm_file, assets, SIDE_DEG)
    try:
        run("--detach", "--port", str(port), *(["--osm", str(osm_file)] if is_new else []))
        yield Installation(f"http://127.0.0.1:{port}", port, (state / "demo_password").read_text().strip())
    finally:
        run("--stop")
        if not keeps:
            shutil.rmtree(Places(state).data, ignore_errors=True)  # as root the database may stand outside the state folder


def places_in(osm_file: Path) -> np.ndarray:
    """Longitude and latitude of some nodes of the file: where something stands."""
    nodes = (node for node in osmium.FileProcessor(str(osm_file), osmium.osm.NODE))
    return np.array([(node.location.lon, node.location.lat) for index, node in enumerate(nodes) if index % PLACES_EVERY == 0])


def measure_tiles(site: Installation, cookie: str, places: np.ndarray) -> None:
    connection = http.client.HTTPConnection("127.0.0.1", site.port, timeout=60)
    rng = np.random.default_rng(11)
    print("zoom  tiles   made: p50 ms   p95   asked again: p50 ms   p95   largest kB, compressed")
    every_time: list[list[float]] = [[], []]
    for zoom in ZOOMS:
        wanted = sorted({tile_of(zoom, *places[index]) for index in rng.integers(0, len(places), TILES_A_ZOOM * 3)})[:TILES_A_ZOOM]
        times: list[list[float]] = [[], []]
        sizes = []
        for column, row in wanted:
            for of_this_turn in times:
                began = time.perf_counter()
                connection.request("GET", f"/api/v1/tiles/{zoom}/{column}/{row}", headers={"Cookie": cookie, "Accept-Encoding": "gzip"})
                answer = connection.getresponse()
                body = answer.read()
                of_this_turn.append((time.perf_counter() - began) * 1_000)
                if answer.status != http.client.OK:
                    raise SystemExit(f"tile {zoom}/{column}/{row}: {answer.status}")
            sizes.append(len(body) / 1_000)
        for all_turns, of_zoom in zip(every_time, times, strict=True):
            all_turns += of_zoom
        print(f"{zoom:4}  {_percentiles(times)}  {max(sizes):10.0f}")
    print(f" all  {_percentiles(every_time)}")


def _percentiles(times: list[list[float]]) -> str:
    made, again = ([np.percentile(of_turn, share) for share in (50, 95)] for of_turn in times)
    return f"{len(times[0]):5}  {made[0]:12.1f}  {made[1]:4.1f}  {again[0]:19.1f}  {again[1]:4.1f}"


def sign_in(browser: Browser, site: Installation) -> dict[str, Any]:
    """The browser's state with a session, so that each page can be opened with nothing in its cache."""
    context = browser.new_context(base_url=site.address)
    page = context.new_page()
    page.goto("/sign-in")
    page.get_by_label("User name").fill("demo")
    page.get_by_label("Password").fill(site.password)
    page.get_by_role("button", name="Sign in").click()
    page.locator("html[data-loaded]").wait_for(state="attached")
    state = context.storage_state()
    context.close()
    return state  # type: ignore[return-value]


def open_map(browser: Browser, site: Installation, state: dict[str, Any], view: str = "") -> tuple[Page, list[Request]]:
    """The page, and what it fetched."""
    context = browser.new_context(base_url=site.address, storage_state=state, viewport={"width": 1440, "height": 900})  # type: ignore[arg-type]
    context.add_init_script(WATCH)
    page = context.new_page()
    fetched: list[Request] = []
    page.on("requestfinished", lambda request: fetched.append(request))  # those of workers too
    page.goto(f"/missions/new{view}")
    page.wait_for_function("() => watched.usable !== null && watched.drawn !== null", timeout=60_000)
    return page, fetched


def _kilobytes(request: Request) -> float:
    """As they came over the wire, compressed."""
    sizes = request.sizes()
    return (sizes["responseHeadersSize"] + sizes["responseBodySize"]) / 1_000


def measure_first_load(browser: Browser, site: Installation, state: dict[str, Any]) -> None:
    usable, drawn, library, tiles, own, files = [], [], 0.0, 0.0, 0.0, 0
    for _ in range(LOADS):
        page, fetched = open_map(browser, site, state)
        times = page.evaluate("({ usable: watched.usable, drawn: watched.drawn })")
        usable.append(times["usable"])
        drawn.append(times["drawn"])
        sizes = [(request.url, _kilobytes(request)) for request in fetched]
        library = sum(size for address, size in sizes if "/maplibre-gl/" in address)
        tiles = sum(size for address, size in sizes if "/api/v1/tiles/" in address)
        own = sum(size for _, size in sizes) - library - tiles
        files = len(fetched)
        page.context.close()
    print(f"first load: {files} files; {own:.0f} kB and {tiles:.0f} kB of tiles besides {library:.0f} kB of MapLibre, all as sent")
    print(f"usable after {median(usable):.0f} ms, everything drawn after {median(drawn):.0f} ms (middle of {LOADS}, empty cache)")
    context = browser.new_context(base_url=site.address, storage_state=state, viewport={"width": 1440, "height": 900})  # type: ignore[arg-type]
    context.add_init_script(WATCH)
    again = []
    for _ in range(LOADS):
        page = context.new_page()
        page.goto("/missions/new")
        page.wait_for_function("() => watched.usable !== null && watched.drawn !== null", timeout=60_000)
        again.append(page.evaluate("watched.usable"))
        page.close()
    context.close()
    print(f"usable after {median(again[1:]):.0f} ms with the files in the cache")


def measure_panning(browser: Browser, site: Installation, state: dict[str, Any], places: np.ndarray) -> None:
    lon, lat = np.median(places, axis=0)
    near = places[np.argmin(np.abs(places - (lon, lat)).sum(axis=1))]
    print("zoom  frames  script ms a frame, mean   callbacks of a frame, p50   p95")
    for zoom in PAN_ZOOMS:
        page, _ = open_map(browser, site, state, f"#map={zoom}/{near[1]:.5f}/{near[0]:.5f}")
        wire = page.context.new_cdp_session(page)
        wire.send("Performance.enable")
        box = page.locator("#map").bounding_box()
        if box is None:
            raise SystemExit("the page has no map")
        middle = (box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
        page.mouse.move(*middle)
        page.evaluate("watched.frames.clear()")
        before = _script_s(wire)
        for drag in range(DRAGS):
            side = 1 if drag % 2 else -1
            start = (middle[0] - side * STEPS * STEP_PX / 2, middle[1])
            page.mouse.move(*start)
            page.mouse.down()
            page.mouse.move(start[0] + side * STEPS * STEP_PX, start[1] + STEPS, steps=STEPS)
            page.mouse.up()
        after = _script_s(wire)
        frames = page.evaluate("[...watched.frames.values()]")
        mean_ms = (after - before) * 1_000 / len(frames)
        print(f"{zoom:4}  {len(frames):6}  {mean_ms:23.1f}  {np.percentile(frames, 50):26.1f}  {np.percentile(frames, 95):4.1f}")
        page.context.close()


def _script_s(wire: Any) -> float:
    """Seconds that the page's main thread has spent in scripts."""
    return next(float(metric["value"]) for metric in wire.send("Performance.getMetrics")["metrics"] if metric["name"] == "ScriptDuration")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--assets", type=int, default=200_000)
    parser.add_argument("--state", type=Path, help="folder that keeps the installation for another run")
    parser.add_argument("--chromium", default=next(filter(None, map(shutil.which, BROWSERS)), None))
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        state = options.state or Path(folder) / "state"
        state.mkdir(parents=True, exist_ok=True)
        osm_file = state / "region.osm.pbf"
        with installation(state, osm_file, options.assets, keeps=options.state is not None) as site, sync_playwright() as playwright:
            print(f"load of the machine before: {os.getloadavg()[0]:.1f}")
            browser = playwright.chromium.launch(executable_path=options.chromium, args=CHROMIUM_FLAGS)
            session = sign_in(browser, site)
            places = places_in(osm_file)
            cookie = "; ".join(f"{kept['name']}={kept['value']}" for kept in session["cookies"])
            measure_first_load(browser, site, session)
            measure_panning(browser, site, session, places)
            measure_tiles(site, cookie, places)
            browser.close()
            print(f"load of the machine after: {os.getloadavg()[0]:.1f}")


if __name__ == "__main__":
    main()
