"""The operator's map over 200,000 assets: tiles through the front door, the first load of the page, and what a frame costs while panning.

    python -m benchmarks.map_page [--assets 200000]

A made region (see large_region.py) is served by ./run on a port of its own, with its own database; Chromium does the rest. Software
rendering gives no honest frame rate, so what is measured is the time that scripts take.
"""

import argparse
import os
import shutil
import socket
import subprocess
import tempfile
import time
from collections import defaultdict
from pathlib import Path
from typing import Any

import numpy as np
from playwright.sync_api import Browser, Page, sync_playwright

from benchmarks.large_region import SIDE_DEG, SOUTH, WEST, tile_of, write_region
from scripts.places import DEMO_USER, Places
from tests.browser.conftest import CHROMIUM_FLAGS

ZOOMS = (0, 3, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14)
TILES_A_ZOOM = 24
PANNED_ZOOMS = (7, 9, 11, 13)
PAN_STEPS = 120
# Counts the frames and times what the page does in each: MapLibre draws in them.
COUNT_FRAMES = """() => {
    window.frames_ms = [];
    const ask = window.requestAnimationFrame.bind(window);
    window.requestAnimationFrame = (act) => ask((now) => {
        const began = performance.now();
        act(now);
        window.frames_ms.push(performance.now() - began);
    });
}"""

MIDDLE = """() => {
    const box = document.getElementById("map").getBoundingClientRect();
    return [box.x + box.width / 2, box.y + box.height / 2];
}"""


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def run(environment: dict[str, str], *command: str) -> None:
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    if done.returncode:
        raise SystemExit(f"{' '.join(command)}\n{done.stdout}\n{done.stderr}")


def signs_in(page: Page, password: str) -> None:
    page.goto("/sign-in")
    page.get_by_label("User name").fill(DEMO_USER)
    page.get_by_label("Password").fill(password)
    page.get_by_role("button", name="Sign in").click()
    page.locator("html[data-loaded]").wait_for(state="attached")


def tiles(page: Page, side_deg: float) -> list[tuple[int, int, float, float, float]]:
    """Of each zoom: tiles asked for, p50 and p95 in ms of the second answer, largest in kB as sent."""
    rng = np.random.default_rng(11)
    rows = []
    for zoom in ZOOMS:
        places = rng.random((TILES_A_ZOOM * 3, 2)) * side_deg + (WEST, SOUTH)
        wanted = sorted({tile_of(zoom, lon, lat) for lon, lat in places})[:TILES_A_ZOOM]
        times, sizes = [], []
        for column, row in wanted:
            address = f"/api/v1/tiles/{zoom}/{column}/{row}"
            page.request.get(address)
            began = time.perf_counter()
            answer = page.request.get(address)
            times.append((time.perf_counter() - began) * 1_000)
            if not answer.ok:
                raise SystemExit(f"{address}: {answer.status}")
            sizes.append(int(answer.headers.get("content-length", len(answer.body()))))
        rows.append((zoom, len(times), float(np.percentile(times, 50)), float(np.percentile(times, 95)), max(sizes) / 1_000))
    return rows


def first_load(browser: Browser, address: str, cookies: list[Any], view: str) -> tuple[dict[str, float], float, float]:
    """kB on the wire by what they are, and seconds until the page can be used and until the map is whole; with an empty cache."""
    context = browser.new_context(base_url=address, viewport={"width": 1440, "height": 900})
    context.add_cookies(cookies)
    page = context.new_page()
    session = context.new_cdp_session(page)
    session.send("Network.enable")
    names: dict[str, str] = {}
    sent: dict[str, float] = defaultdict(float)

    def kind(url: str) -> str:
        if "/lib/maplibre-gl/" in url:
            return "MapLibre"
        return "tiles" if "/tiles/" in url else "API" if "/api/" in url else "page, styles, scripts, icons"

    session.on("Network.responseReceived", lambda event: names.update({event["requestId"]: event["response"]["url"]}))
    session.on(
        "Network.loadingFinished",
        lambda event: sent.__setitem__(
            kind(names.get(event["requestId"], "")), sent[kind(names.get(event["requestId"], ""))] + event["encodedDataLength"] / 1_000
        ),
    )
    began = time.perf_counter()
    page.goto(f"/missions/new{view}")
    page.locator("html[data-loaded]").wait_for(state="attached")
    usable_s = time.perf_counter() - began
    page.locator("#map[data-idle]").wait_for(state="attached")
    whole_s = time.perf_counter() - began
    context.close()
    return dict(sent), usable_s, whole_s


def panning(page: Page, zoom: float, lon: float, lat: float) -> tuple[int, float, float, float]:
    """Frames, script ms a frame in all, p95 of the work inside a frame, and the assets in view."""
    page.goto("about:blank")
    page.goto(f"/missions/new#map={zoom}/{lat}/{lon}")
    page.locator("#map[data-idle]").wait_for(state="attached")
    session = page.context.new_cdp_session(page)
    session.send("Performance.enable")

    def script_s() -> float:
        metrics = session.send("Performance.getMetrics")["metrics"]
        return next(metric["value"] for metric in metrics if metric["name"] == "ScriptDuration")

    page.evaluate(COUNT_FRAMES)
    x, y = page.evaluate(MIDDLE)
    page.mouse.move(x, y)
    before = script_s()
    page.mouse.down()
    for step in range(PAN_STEPS):
        page.mouse.move(x - step * 4, y + (step % 20) * 4)
    page.mouse.up()
    spent_ms = (script_s() - before) * 1_000
    frames = page.evaluate("window.frames_ms")
    return len(frames), spent_ms / max(1, len(frames)), float(np.percentile(frames, 50)), float(np.percentile(frames, 95))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--assets", type=int, default=200_000)
    options = parser.parse_args()
    side_deg = SIDE_DEG * (options.assets / 1_000_000) ** 0.5  # as dense as the large region
    environment = {name: value for name, value in os.environ.items() if name not in {"DATABASE_URL", "REDIS_URL"}}
    port = free_port()
    with tempfile.TemporaryDirectory(prefix="spanwise-map-page-") as folder:
        state = Path(folder) / "var"
        region = Path(folder) / "region.osm.pbf"
        write_region(region, options.assets, side_deg)
        environment |= {"SPANWISE_VAR": str(state), "SPANWISE_BASE_MAP_TILES": ""}
        try:
            run(environment, "./run", "--detach", "--port", str(port), "--osm", str(region))
            measure(f"http://127.0.0.1:{port}", Places(state).demo_password.read_text().strip(), options.assets, side_deg)
        finally:
            run(environment, "./run", "--stop")
            shutil.rmtree(Places(state).data, ignore_errors=True)


def measure(address: str, password: str, assets: int, side_deg: float) -> None:
    program = shutil.which("chromium") or shutil.which("google-chrome")
    if not program:
        raise SystemExit("Chromium is missing; ./check installs it")
    centre = (WEST + side_deg / 2, SOUTH + side_deg / 2)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=CHROMIUM_FLAGS)
        page = browser.new_context(base_url=address, viewport={"width": 1440, "height": 900}).new_page()
        signs_in(page, password)
        print(f"{assets:,} assets; load of the machine {os.getloadavg()[0]:.1f}")
        print("zoom  tiles   p50 ms   p95 ms   largest kB")
        for zoom, number, middle, late, largest in tiles(page, side_deg):
            print(f"{zoom:4}  {number:5}  {middle:7.1f}  {late:7.1f}  {largest:10.0f}")
        sent, usable_s, whole_s = first_load(browser, address, page.context.cookies(), f"#map=11/{centre[1]}/{centre[0]}")
        for what, size_kb in sorted(sent.items()):
            print(f"first load: {what:32} {size_kb:7.0f} kB")
        print(f"first load: besides MapLibre and tiles {sum(sent.values()) - sent['MapLibre'] - sent.get('tiles', 0):10.0f} kB")
        print(f"first load: usable after {usable_s:.2f} s, map whole after {whole_s:.2f} s")
        print("zoom  frames  script ms a frame   inside a frame p50, p95 ms")
        for zoom in PANNED_ZOOMS:
            frames, script_ms, middle, late = panning(page, zoom, *centre)
            print(f"{zoom:4}  {frames:6}  {script_ms:17.1f}   {middle:8.1f} {late:8.1f}")
        browser.close()


if __name__ == "__main__":
    main()
