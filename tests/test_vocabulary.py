"""Names follow the glossary: what docs/glossary.md rejects is used by no name and no module."""

import ast
import re
from collections.abc import Iterator
from fnmatch import fnmatchcase, translate
from functools import cache
from pathlib import Path

import pytest

from tests.test_architecture import ROOT, own_files, relative

GLOSSARY = ROOT / "docs" / "glossary.md"
NAME = re.compile(r"[A-Za-z_$][\w$]*")
STRINGS_AND_COMMENTS = re.compile(r"//[^\n]*|/\*[\s\S]*?\*/|\"(?:[^\"\\\n]|\\.)*\"|'(?:[^'\\\n]|\\.)*'")


def rejected_patterns() -> dict[str, str]:
    """What the table of rejected words has in its first column, with what to write instead."""
    table = GLOSSARY.read_text().split("## Rejected words", 1)[1]
    rows = [line.strip("|").split("|") for line in table.splitlines() if line.startswith("| `")]
    return {pattern: instead.strip() for rejected, instead in rows for pattern in re.findall(r"`([^`]+)`", rejected)}


def python_names(source: str) -> Iterator[str]:
    """Names that are defined, assigned or taken as parameters."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            yield node.name
        elif isinstance(node, ast.Name):
            yield node.id
        elif isinstance(node, ast.arg):
            yield node.arg


def javascript_names(source: str) -> Iterator[str]:
    yield from NAME.findall(STRINGS_AND_COMMENTS.sub(" ", source))


def rejected(names: Iterator[str], patterns: dict[str, str]) -> set[str]:
    any_pattern = matcher(tuple(patterns))
    suspects = [name for name in set(names) if any_pattern.match(name.lstrip("_"))]
    return {
        f"{name}: write {instead}" for name in suspects for pattern, instead in patterns.items() if fnmatchcase(name.lstrip("_"), pattern)
    }


@cache
def matcher(patterns: tuple[str, ...]) -> re.Pattern[str]:
    """One expression for all patterns: names are many."""
    return re.compile("|".join(map(translate, patterns)))


def test_the_table_is_read() -> None:
    patterns = rejected_patterns()
    assert patterns["MOST_*"] == "`MAX_*`"
    assert patterns["carriage"] == "`delivery`, `Delivery`"
    assert rejected(python_names("MOST_ITEMS = 3"), patterns) == {"MOST_ITEMS: write `MAX_*`"}
    assert rejected(javascript_names("const LEAST_M = 3; // MOST_OF_IT"), patterns) == {"LEAST_M: write `MIN_*`"}


@pytest.mark.parametrize(("pattern", "read"), [("*.py", python_names), ("*.js", javascript_names)], ids=["Python", "JavaScript"])
def test_no_name_is_rejected(pattern: str, read) -> None:
    patterns = rejected_patterns()
    paths = [path for path in own_files(pattern) if "migrations" not in path.parts and "vendor" not in path.parts]
    found = {relative(path): names for path in paths if (names := rejected(read(path.read_text()), patterns))}
    assert found == {}


def test_no_module_is_rejected() -> None:
    patterns = rejected_patterns()
    modules = {Path(relative(path)) for path in own_files("*.py", "static/js/*.js")}
    assert [str(path) for path in modules if any(fnmatchcase(path.stem, pattern) for pattern in patterns)] == []
