"""Bundles of the pages' scripts and style sheets: for each page one of its own, beside chunks that pages share. Built by esbuild."""

import json
import os
import shutil
import subprocess
import tempfile
from collections.abc import Collection, Iterable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import brotli
from django.conf import settings

FOLDER = "bundles"  # of the collected static files; every name in it changes with the content
SOURCES = settings.BASE_DIR / "static"
MAP_LIBRARY = "node_modules/.spanwise/maplibre-gl/maplibre-gl.mjs"
MAP_LIBRARY_ENTRY = "js/shared/map_library.js"
MAP_MODULE = "static/js/map/maplibre.js"  # loads the library
BROTLI_QUALITY = 9  # 11 saves another 8 % and takes 6 s more
MAP_WORKER = "lib/maplibre-gl/maplibre-gl-worker.mjs"
LAZY_ENTRIES = ("js/fleet/fleet_map.js", "js/scene/panel.js")  # imported by pages with a map once they are needed
STANDALONE_ENTRIES = (
    "js/account/passkey_form.js",
    "js/admin/geometry_map.js",
    "js/offline/main.js",
)  # they need little of what others share
OPTIONS = ("--bundle", "--format=esm", "--charset=utf8", "--log-level=warning")
PAGE_OPTIONS = ("--minify", "--sourcemap", "--entry-names=[dir]/[name]-[hash]", "--chunk-names=js/shared/[name]-[hash]")

MAP_PAGES = "pages with a map"

Graph = Mapping[str, Collection[str]]  # of modules: what each imports statically


class BundlesFailed(Exception):
    """The message of esbuild, or that it is not installed."""


class Bundle(NamedTuple):
    """A page's script or style sheet among the collected files, and the chunks that it needs."""

    path: str
    chunks: list[str]
    later: list[str]  # chunks that the page's script itself loads: the map's library


def build(static_root: Path) -> tuple[dict[str, Bundle], set[str]]:
    """Build the bundles of all pages. Return them by the names of their sources, and the paths of all files."""
    folder, entries = static_root / FOLDER, static_root / FOLDER / "entries"
    scripts = {name: SOURCES / name for name in _names("js/*/main.js") if name not in STANDALONE_ENTRIES}
    with tempfile.TemporaryDirectory() as scratch:
        graph = _graph(_esbuild(scripts, Path(scratch), "--splitting")["inputs"])
    pages = [f"static/{name}" for name in scripts]
    shared, with_map = shared_modules(pages, graph), {page for page in pages if MAP_MODULE in _reached(page, graph)}
    for name in (*scripts, *LAZY_ENTRIES):
        scripts[name] = entries / name
        scripts[name].parent.mkdir(parents=True, exist_ok=True)
        imported = (settings.BASE_DIR / path for path in shared.get(f"static/{name}", shared[MAP_PAGES]))
        lines = [*(f'import "{path}";' for path in imported), f'export * from "{SOURCES / name}";']
        scripts[name].write_text("\n".join(lines))
    alone = {name: SOURCES / name for name in (*STANDALONE_ENTRIES, *_names("css/pages/*.css"))}
    alone[MAP_WORKER] = settings.BASE_DIR / Path(MAP_LIBRARY).parent / Path(MAP_WORKER).name
    scripts[MAP_LIBRARY_ENTRY] = settings.BASE_DIR / MAP_LIBRARY  # an entry, so that no other module is in its chunk
    outputs = (
        _esbuild(scripts, folder, "--splitting", *PAGE_OPTIONS, later=entries)["outputs"]
        | _esbuild(alone, folder, *PAGE_OPTIONS)["outputs"]
    )
    shutil.rmtree(entries)

    graph = _graph(outputs)
    names = {os.path.relpath(source, settings.BASE_DIR): name for name, source in (scripts | alone).items()}
    of_root = {path: os.path.relpath(settings.BASE_DIR / path, static_root) for path in outputs}
    library = next(path for path, output in outputs.items() if output.get("entryPoint") == MAP_LIBRARY)
    bundles = {
        names[output["entryPoint"]]: Bundle(
            of_root[path],
            [of_root[chunk] for chunk in _reached(path, graph)],
            [of_root[chunk] for chunk in (library, *_reached(library, graph)) if f"static/{names[output['entryPoint']]}" in with_map],
        )
        for path, output in outputs.items()
        if output.get("entryPoint") in names
    }
    return bundles, {*of_root.values(), *_compressed(static_root, of_root.values())}


def _compressed(static_root: Path, paths: Iterable[str]) -> list[str]:
    """Write the Brotli form of scripts and style sheets beside them, which the proxy sends; main-HASH.js has main-HASH.br.js."""
    found = []
    for path in (static_root / path for path in paths if not path.endswith(".map")):
        target = path.with_suffix(f".br{path.suffix}")
        found.append(str(target.relative_to(static_root)))
        if not target.exists():
            target.write_bytes(brotli.compress(path.read_bytes(), quality=BROTLI_QUALITY))
    return found


def _names(pattern: str) -> list[str]:
    return [str(path.relative_to(SOURCES)) for path in sorted(SOURCES.glob(pattern))]


def shared_modules(pages: Iterable[str], graph: Graph) -> dict[str, list[str]]:
    """Return the modules that each page loads beside its own, so that esbuild makes of them one chunk for all pages and one for maps.

    esbuild makes a chunk for each set of pages that share modules, which are many small ones; a module that all pages load is in one.
    Under MAP_PAGES is what pages with a map load.
    """
    reached = {page: set(_reached(page, graph)) for page in pages}
    with_map = {page for page, modules in reached.items() if MAP_MODULE in modules}
    users: dict[str, set[str]] = {}
    for page, modules in reached.items():
        for module in modules:
            if not module.startswith("node_modules/"):
                users.setdefault(module, set()).add(page)
    several = {module: using for module, using in users.items() if len(using) > 1}
    for_all = sorted(module for module, using in several.items() if using - with_map)
    for_maps = sorted(several)
    return {page: for_maps if page in with_map else for_all for page in reached} | {MAP_PAGES: for_maps}


def _graph(modules: Mapping[str, Any]) -> Graph:
    """Return what each input or output of esbuild's record imports statically, without what is external."""
    return {
        path: [found["path"] for found in module["imports"] if found["kind"] == "import-statement" and found["path"] in modules]
        for path, module in modules.items()
    }


def _reached(start: str, graph: Graph) -> list[str]:
    """Return all that is behind a module, nearest first."""
    found = dict.fromkeys(graph[start])
    waiting = list(found)
    while waiting:
        for target in graph[waiting.pop(0)]:
            if target not in found:
                found[target] = None
                waiting.append(target)
    return list(found)


def _esbuild(entries: Mapping[str, Path], folder: Path, *options: str, later: Path = SOURCES) -> dict[str, Any]:
    """Bundle the entries into the folder, and return esbuild's record of inputs and outputs. Raises BundlesFailed.

    What is imported later is taken from the folder of that name.
    """
    program = next((settings.BASE_DIR / "node_modules" / "@esbuild").glob("*/bin/esbuild"), None)
    if program is None:
        raise BundlesFailed("esbuild is missing; scripts/setup run installs it")
    paths = {"/static/lib/*": ["./node_modules/.spanwise/*"], "/static/js/*": [f"{later}/js/*"]}
    with tempfile.NamedTemporaryFile(suffix=".json") as record:
        named = [f"{name.rpartition('.')[0]}={source}" for name, source in entries.items()]
        addresses = f"--tsconfig-raw={json.dumps({'compilerOptions': {'paths': paths}})}"
        done = subprocess.run(  # noqa: S603
            [program, *named, *OPTIONS, *options, addresses, f"--outdir={folder}", f"--metafile={record.name}"],
            cwd=settings.BASE_DIR, capture_output=True, text=True, check=False,
        )  # fmt: skip
        if done.returncode:
            raise BundlesFailed(done.stderr)
        return dict(json.load(record))
