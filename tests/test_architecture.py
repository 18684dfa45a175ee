"""What the house promises and an import contract cannot see: names, sizes, purity, and documents that are true."""

import ast
import functools
import re
import subprocess
import tomllib
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import unquote

import networkx as nx
import pytest
from django.core.management import get_commands

from scripts.development import texts
from workspace.api import api_document

ROOT = Path(__file__).resolve().parents[1]
PURE_PACKAGES = {"planning", "mavlink"}
APPS = ("workspace", "accounts", "inspection", *sorted(PURE_PACKAGES), "missions", "telemetry", "results", "simulation")
MAX_FILE_LINES = 450
UNNAMED = {"utils", "util", "helpers", "helper", "common", "misc"}
CLOCKS = {"datetime.now", "datetime.utcnow", "datetime.today", "date.today", "datetime.datetime.now", "datetime.date.today"}
UNSEEDABLE = {"time", "secrets", "uuid"}
SEEDED = {"Random", "default_rng", "Generator", "PCG64", "SeedSequence"}  # pure when a seed is passed in


@functools.cache
def own_files(*patterns: str) -> list[Path]:
    """Files that git knows or would add: what belongs to the project, without what was installed or generated."""
    command = ["git", "ls-files", "--cached", "--others", "--exclude-standard", "--", *patterns]
    listed = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)  # noqa: S603
    return [path for name in listed.stdout.splitlines() if (path := ROOT / name).is_file()]


def pure_folders() -> list[str]:
    """The folders that mypy checks strictly are the pure ones."""
    overrides = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["mypy"]["overrides"]
    (strict,) = (override for override in overrides if "warn_return_any" in override)
    return [module.removesuffix(".*").replace(".", "/") for module in strict["module"]]


def relative(path: Path) -> str:
    return str(path.relative_to(ROOT))


def dotted(node: ast.expr) -> str:
    """`a.b.c` of an expression, or an empty string if it is anything else."""
    if isinstance(node, ast.Name):
        return node.id
    if isinstance(node, ast.Attribute) and (owner := dotted(node.value)):
        return f"{owner}.{node.attr}"
    return ""


def impurities(source: str) -> Iterator[str]:
    """Calls and imports in a pure module that read a clock or draw numbers nobody seeded."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            yield from (f"line {node.lineno}: imports {alias.name}" for alias in node.names if alias.name.split(".")[0] in UNSEEDABLE)
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            if node.module.split(".")[0] in UNSEEDABLE and [alias.name for alias in node.names] != ["UUID"]:  # reading one draws none
                yield f"line {node.lineno}: imports {node.module}"
            if node.module in {"random", "numpy.random"}:
                yield from (f"line {node.lineno}: imports {alias.name}" for alias in node.names if alias.name not in SEEDED)
        elif isinstance(node, ast.Call):
            owner, _, name = dotted(node.func).rpartition(".")
            if f"{owner}.{name}" in CLOCKS:
                yield f"line {node.lineno}: reads the clock with {owner}.{name}"
            elif owner in {"random", "np.random", "numpy.random"} and name not in SEEDED:
                yield f"line {node.lineno}: draws from the global generator with {owner}.{name}"
            elif name in SEEDED and not node.args and not node.keywords:
                yield f"line {node.lineno}: makes a generator without a seed with {name}"


@pytest.mark.parametrize(
    "source",
    [
        "import time",
        "from random import random",
        "import random\nrandom.shuffle([1, 2])",
        "import random\nrandom.Random()",
        "from datetime import datetime\ndatetime.now()",
        "import numpy as np\nnp.random.uniform(0, 1)",
        "import numpy as np\nnp.random.default_rng()",
    ],
)
def test_the_check_for_purity_finds_each_kind_of_fault(source: str) -> None:
    assert list(impurities(source))


def test_the_check_for_purity_lets_a_seeded_generator_pass() -> None:
    source = (
        "import random\nimport numpy as np\ndef draw(seed):\n    return np.random.default_rng(seed).uniform(), random.Random(seed).random()"
    )
    assert not list(impurities(source))


@pytest.mark.parametrize("folder", pure_folders())
def test_pure_folder_reads_no_clock_and_draws_no_unseeded_number(folder: str) -> None:
    modules = own_files(f"{folder}/*.py")
    assert modules, f"{folder} has no module"
    faults = [f"{relative(path)} {fault}" for path in modules for fault in impurities(path.read_text())]
    assert faults == []


def test_every_pure_folder_is_under_the_strict_type_check() -> None:
    """A folder of an app is pure unless it is Django's own (migrations, management, templatetags) or a layer cut into files."""
    layers = {
        "migrations",
        "management",
        "templatetags",
        "models",
        "services",
        "selectors",
        "views",
        "serializers",
        "admin",
        "tasks",
        "gateway",
        "watch",
        "live",
        "vehicle_endpoint",
        "admin_pages",
        "api",
        "hooks",
        "jobs",
        "pages",
        "sessions",
        "simulator",
    }
    folders = {
        f"{app}/{path.parent.name}"
        for app in APPS
        for path in own_files(f"{app}/*/__init__.py")
        if app not in PURE_PACKAGES and path.parent.parent == ROOT / app and path.parent.name not in layers
    }
    assert folders | PURE_PACKAGES == set(pure_folders())


def test_every_list_of_packages_names_all_of_them() -> None:
    """The image, the digest of the kept OpenAPI document and the search for texts would leave out what their lists lack."""
    packages = {*APPS, "config", "operation"}
    image = re.search(r"^apps=\((.*)\)$", (ROOT / "scripts" / "image_files").read_text(), re.MULTILINE)
    assert image is not None
    assert packages <= set(image.group(1).split())
    assert packages <= {line.lstrip("!") for line in (ROOT / ".dockerignore").read_text().splitlines()}
    assert packages <= set(api_document.APPS)
    assert packages - {"operation"} <= set(texts.APPS)


def test_the_type_check_reads_every_program() -> None:
    checked = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["mypy"]
    assert {*APPS, "config", "scripts", "operation"} <= set(checked["files"])
    assert checked["exclude"] == "/migrations/"
    assert checked["disallow_untyped_defs"] and checked["check_untyped_defs"]
    silenced = [override["module"] for override in checked["overrides"] if override.get("ignore_errors")]
    assert silenced == []


def test_modules_are_named_after_what_they_know() -> None:
    assert [relative(path) for path in own_files("*.py", "*.js") if path.stem in UNNAMED or path.parent.name in UNNAMED] == []


def test_no_file_holds_more_than_one_subject() -> None:
    sources = [path for path in own_files("*.py", "*.js", "*.css", "*.html") if "migrations" not in path.parts]
    lengths = {relative(path): len(path.read_text().splitlines()) for path in sources}
    assert {name: length for name, length in lengths.items() if length > MAX_FILE_LINES} == {}


def test_every_module_opens_with_a_sentence() -> None:
    modules = [path for path in own_files("*.py") if path.read_text().strip() and "migrations" not in path.parts]
    assert [relative(path) for path in modules if not ast.get_docstring(ast.parse(path.read_text()))] == []


def test_nothing_is_left_to_do_later() -> None:
    words = re.compile(r"\b(" + "|".join(["TO" + "DO", "FIX" + "ME", "X" + "XX", "HA" + "CK"]) + r")\b")
    sources = own_files("*.py", "*.js", "*.css", "*.html", "*.md", "run", "check", "scripts/*")
    assert [relative(path) for path in sources if words.search(path.read_text())] == []


# --- the pages' scripts ------------------------------------------------------------------------------------------------------------

SCRIPTS = ROOT / "static" / "js"
SCRIPT_IMPORT = re.compile(r"""^(?:import|export)\s[^;]*?from "(\.[^"]+)";|^import "(\.[^"]+)";|\bimport\("(\.[^"]+)"\)""", re.M)


def script_folder(path: Path) -> str:
    """The folder below static/js that a script belongs to; empty for a root module."""
    return path.relative_to(SCRIPTS).parts[0] if path.parent != SCRIPTS else ""


def folder_imports() -> nx.DiGraph:
    graph = nx.DiGraph()
    for path in own_files("static/js/*.js"):
        for names in SCRIPT_IMPORT.findall(re.sub(r"/\*.*?\*/", "", path.read_text(), flags=re.S)):
            target = (path.parent / next(filter(None, names))).resolve()
            assert target.is_file(), f"{relative(path)} imports {relative(target)}, which does not exist"
            if script_folder(target) != script_folder(path):
                graph.add_edge(script_folder(path), script_folder(target), files=f"{relative(path)} → {relative(target)}")
    return graph


def test_folders_of_scripts_do_not_import_each_other_in_a_circle() -> None:
    graph = folder_imports()
    assert graph.number_of_edges() > 50
    graph.remove_node("")
    assert [" → ".join(cycle) for cycle in nx.simple_cycles(graph)] == []


def test_domain_scripts_know_no_page_and_no_map() -> None:
    graph = folder_imports()
    assert set(graph.successors("domain")) <= {""}


# --- documents ---------------------------------------------------------------------------------------------------------------------

DOCUMENTS = own_files("*.md")
LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)|<(?:img|source)[^>]*\bsrc(?:set)?=\"([^\"]+)\"")


@functools.cache
def text_of(*patterns: str) -> str:
    return "".join(path.read_text() for path in own_files(*patterns))


@functools.cache
def anchors_of(document: Path) -> set[str]:
    """What the headings of a Markdown file are called in a link."""
    headings = re.findall(r"^#+ (.+)$", document.read_text(), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-") for heading in headings}


@pytest.mark.parametrize("document", DOCUMENTS, ids=relative)
def test_links_of_a_document_lead_somewhere(document: Path) -> None:
    broken = []
    for match in LINK.finditer(document.read_text()):
        target = unquote(match[1] or match[2])
        if target.startswith(("https://", "http://", "mailto:")):
            continue
        name, _, anchor = target.partition("#")
        path = (document.parent / name).resolve() if name else document
        is_there = path.exists() and path.is_relative_to(ROOT)
        if not is_there or (anchor and anchor not in anchors_of(path)):
            broken.append(target)
    assert broken == []


@pytest.mark.parametrize("document", DOCUMENTS, ids=relative)
def test_commands_in_a_document_exist(document: Path) -> None:
    text = document.read_text()
    assert set(re.findall(r"manage\.py ([a-z_]+)", text)) <= set(get_commands())
    scripts = set(re.findall(r"(?<![\w/.])\./((?:run|check|scripts/[\w-]+))(?![\w/.-])", text))
    assert [name for name in sorted(scripts) if not (ROOT / name).is_file()] == []


@pytest.mark.parametrize("document", DOCUMENTS, ids=relative)
def test_options_of_run_and_check_in_a_document_exist(document: Path) -> None:
    for name, rest in re.findall(r"\./(run|check)((?: +[^\s`|;&)]+)*)", document.read_text()):
        text = text_of(name, "scripts/*")
        missing = [option for option in re.findall(r"--[a-z-]+", rest) if option not in text]
        assert missing == [], f"./{name} has no such option"


@pytest.mark.parametrize("document", DOCUMENTS, ids=relative)
def test_settings_and_paths_in_a_document_exist(document: Path) -> None:
    text = document.read_text()
    sources = text_of("*.py", "run", "check", "scripts/*", "deploy/*", "*.conf", "*.sh", "*.yaml")
    names = set(re.findall(r"\bSPANWISE_[A-Z_]*[A-Z]\b", text))
    assert sorted(name for name in names if name not in sources) == []
    paths = re.findall(r"`((?:config|workspace|inspection|missions|tests|docs|scripts|templates|static|benchmarks)/[\w./-]*)`", text)
    assert sorted({path for path in paths if not (ROOT / path).exists()}) == []


def test_every_decision_is_in_the_index() -> None:
    index = (ROOT / "docs/decisions/README.md").read_text()
    records = sorted(path.name for path in own_files("docs/decisions/0*.md"))
    assert records
    assert [name for name in records if name not in index] == []
    assert [int(name[:4]) for name in records] == list(range(1, len(records) + 1)), "numbered without a gap"


def test_every_setting_is_described() -> None:
    described = text_of("docs/operations.md", "docs/deployment.md")
    names = set(re.findall(r"\bSPANWISE_[A-Z_]*[A-Z]\b", (ROOT / "config" / "settings.py").read_text()))
    assert sorted(name for name in names if f"`{name}`" not in described) == []
