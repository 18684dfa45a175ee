"""Metrics of the code base's structure: modules, folders, import chains, names, functions, sizes.

python -m scripts.development.house_figures [COMMIT...]      (of the working tree; commits are checked out beside it and follow as columns)
"""

import argparse
import ast
import json
import subprocess
import sys
import tempfile
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import networkx as nx

PROJECT_DIR = Path(__file__).resolve().parents[2]
APP_FOLDERS = (
    "accounts", "config", "inspection", "mavlink", "missions", "operation", "planning", "results", "simulation", "telemetry", "workspace"
)  # fmt: skip
PLANNER_FOLDERS = ("planning", "missions/routing", "missions/flight_plan", "missions/services")
# The first existing one is the entry point of a plan request.
PLAN_ENTRIES = ("planning.planner", "missions.services.planning.planner", "missions.services.planning")
SMALL_MODULE_LINES = 80
MAX_FOLDER_FILES = 20
MAX_PARAMETERS = 8
FUNCTION_LINES = (40, 80)
JAVASCRIPT_LENGTHS = """
const ts = require("typescript"), fs = require("fs");
for (const name of fs.readFileSync(0, "utf8").split("\\n").filter(Boolean)) {
  const source = ts.createSourceFile(name, fs.readFileSync(name, "utf8"), ts.ScriptTarget.Latest, true);
  const visit = (node) => {
    if (ts.isFunctionLike(node) && node.body) {
      const line = (at) => source.getLineAndCharacterOfPosition(at).line;
      console.log(line(node.end) - line(node.getStart()) + 1);
    }
    ts.forEachChild(node, visit);
  };
  visit(source);
}
"""


@dataclass(frozen=True)
class Module:
    """A Python module of an app, with its dotted name."""

    name: str
    path: Path

    @cached_property
    def text(self) -> str:
        return self.path.read_text()

    @cached_property
    def tree(self) -> ast.Module:
        return ast.parse(self.text)

    @property
    def lines(self) -> int:
        return self.text.count("\n")

    @property
    def package(self) -> str:
        return self.name if self.path.name == "__init__.py" else self.name.rpartition(".")[0]

    def imported(self, known: frozenset[str]) -> set[str]:
        """Return the known modules that it imports, anywhere in its text."""
        found = set()
        for node in ast.walk(self.tree):
            if isinstance(node, ast.Import):
                found |= {alias.name for alias in node.names}
            elif isinstance(node, ast.ImportFrom):
                parent = ".".join(self.package.split(".")[: len(self.package.split(".")) - node.level + 1]) if node.level else ""
                base = ".".join(part for part in (parent, node.module) if part)
                found |= {name if (name := f"{base}.{alias.name}") in known else base for alias in node.names}
        return (found & known) - {self.name}


def _functions(modules: Iterable[Module]) -> Iterator[ast.FunctionDef | ast.AsyncFunctionDef]:
    for module in modules:
        yield from (node for node in ast.walk(module.tree) if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef))


def _lines_of(node: ast.FunctionDef | ast.AsyncFunctionDef) -> int:
    return (node.end_lineno or node.lineno) - node.lineno + 1


def _parameters(node: ast.FunctionDef | ast.AsyncFunctionDef) -> int:
    arguments = node.args
    return len(arguments.posonlyargs) + len(arguments.args) + len(arguments.kwonlyargs)


class CodeBase:
    """A checkout of the project, measured."""

    def __init__(self, root: Path) -> None:
        self.root = root
        listed = subprocess.run(["git", "ls-files"], cwd=root, capture_output=True, text=True, check=True).stdout
        self.files = [path for name in listed.splitlines() if (path := root / name).is_file()]
        self.modules = [
            Module(".".join(path.relative_to(root).with_suffix("").parts).removesuffix(".__init__"), path)
            for path in self.files
            if path.suffix == ".py" and path.relative_to(root).parts[0] in APP_FOLDERS and "migrations" not in path.parts
        ]

    @cached_property
    def imports(self) -> "nx.DiGraph[str]":
        known = frozenset(module.name for module in self.modules)
        graph: nx.DiGraph[str] = nx.DiGraph()
        graph.add_nodes_from(known)
        graph.add_edges_from((module.name, name) for module in self.modules for name in module.imported(known))
        return graph

    def _of(self, *parts: str, suffixes: tuple[str, ...]) -> list[Path]:
        return [path for path in self.files if path.suffix in suffixes and path.relative_to(self.root).as_posix().startswith(parts)]

    def _javascript_lengths(self) -> list[int]:
        names = "\n".join(str(path) for path in self._of("static/js/", suffixes=(".js",)))
        command = [str(Path(sys.executable).with_name("node")), "-e", JAVASCRIPT_LENGTHS]
        printed = subprocess.run(command, cwd=PROJECT_DIR, input=names, capture_output=True, text=True, check=True).stdout
        return [int(line) for line in printed.split()]

    def _planner_names(self) -> set[str]:
        folders = tuple(folder.replace("/", ".") + "." for folder in PLANNER_FOLDERS)
        return {module.name for module in self.modules if f"{module.name}.".startswith(folders)}

    def longest_planner_chain(self) -> int:
        """Return the number of modules on the longest import chain of the planner; a cycle counts as one."""
        contracted = nx.condensation(self.imports.subgraph(self._planner_names()))
        return len(nx.dag_longest_path(contracted)) if contracted else 0

    def entered_by_a_plan(self) -> int:
        """Return the number of the planner's modules that the entry point of a plan request reaches."""
        planner = self.imports.subgraph(self._planner_names())
        entry = next(name for name in PLAN_ENTRIES if name in planner)
        return 1 + len(nx.descendants(planner, entry))

    def figures(self) -> dict[str, int]:
        """Return the metrics by name."""
        measured = [module for module in self.modules if module.lines]
        single = [
            m for m in measured if m.lines < SMALL_MODULE_LINES and self.imports.in_degree(m.name) == 1 and m.path.name != "__init__.py"
        ]
        folders = Counter(path.parent for path in self.files if path.suffix in {".py", ".js"})
        by_part: defaultdict[str, int] = defaultdict(int)
        for folder, files in folders.items():
            by_part["tests" if "tests" in folder.relative_to(self.root).parts else "app"] += files > MAX_FOLDER_FILES
        classes = Counter(node.name for module in measured for node in module.tree.body if isinstance(node, ast.ClassDef))
        python = [_lines_of(node) for node in _functions(measured)]
        parameters = [_parameters(node) for node in _functions(measured)]
        javascript = self._javascript_lengths()
        scripts = self._of("static/js/", suffixes=(".js",))
        tests = self._of("tests/", suffixes=(".py", ".js", ".mjs"))
        found = {
            "Python modules": len(measured),
            f"modules under {SMALL_MODULE_LINES} lines with one importer": len(single),
            f"folders of the apps over {MAX_FOLDER_FILES} files": by_part["app"],
            f"folders of tests over {MAX_FOLDER_FILES} files": by_part["tests"],
            "longest import chain in the planner": self.longest_planner_chain(),
            "planner modules that a plan request can enter": self.entered_by_a_plan(),
            "class names defined more than once": sum(times > 1 for times in classes.values()),
        }
        for most in FUNCTION_LINES:
            found[f"Python functions over {most} lines"] = sum(lines > most for lines in python)
            found[f"JavaScript functions over {most} lines"] = sum(lines > most for lines in javascript)
        return found | {
            f"Python functions with over {MAX_PARAMETERS} parameters": sum(count > MAX_PARAMETERS for count in parameters),
            "lines of Python in the apps": sum(module.lines for module in measured),
            "lines of JavaScript": sum(path.read_text().count("\n") for path in scripts),
            "lines of tests": sum(path.read_text().count("\n") for path in tests),
        }


def _figures_of(commit: str) -> dict[str, int]:
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run(["git", "clone", "--quiet", "--shared", "--no-checkout", str(PROJECT_DIR), folder], check=True)
        subprocess.run(["git", "checkout", "--quiet", commit], cwd=folder, check=True)
        return CodeBase(Path(folder)).figures()


def main(arguments: list[str]) -> None:
    parser = argparse.ArgumentParser(prog="python -m scripts.development.house_figures", description=(__doc__ or "").split("\n", 1)[0])
    parser.add_argument("commits", nargs="*", metavar="COMMIT", help="commits to compare the working tree with")
    parser.add_argument("--json", action="store_true", help="print JSON instead of a table")
    options = parser.parse_args(arguments)
    columns = {commit: _figures_of(commit) for commit in options.commits} | {"now": CodeBase(PROJECT_DIR).figures()}
    if options.json:
        print(json.dumps(columns, indent=2))
        return
    names = {name for figures in columns.values() for name in figures}
    width = max(map(len, names))
    print(f"{'':<{width}}", *(f"{name[:10]:>10}" for name in columns))
    for name in columns["now"]:
        print(f"{name:<{width}}", *(f"{figures.get(name, 0):>10,}" for figures in columns.values()))


if __name__ == "__main__":
    main(sys.argv[1:])
