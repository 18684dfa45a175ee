"""Tools that know more of these files than we do. Where one is missing, its test says how to get it."""

import shutil
import subprocess
from pathlib import Path

import pytest

from tests.deploy.conftest import DEPLOY, OVERLAYS, rendered_text

PROJECT = DEPLOY.parent


def tool(name: str) -> str:
    """From .deploy-tools, else from the PATH."""
    own = PROJECT / ".deploy-tools" / "bin" / name
    found = str(own) if own.exists() else shutil.which(name)
    if found is None:
        pytest.skip(f"{name} is not installed: deploy/tools installs it")
    return found


def finds_nothing(*command: str | Path) -> None:
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False, cwd=PROJECT)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize("overlay", OVERLAYS)
def test_kubernetes_knows_every_field(overlay: str, tmp_path: Path) -> None:
    path = tmp_path / "objects.yaml"
    path.write_text(rendered_text(overlay))
    finds_nothing(tool("kubernetes-validate"), "--strict", "--quiet", "--no-warn", path)


def test_a_misspelt_field_would_be_found(tmp_path: Path) -> None:
    path = tmp_path / "objects.yaml"
    path.write_text(rendered_text("small").replace("readinessProbe:", "readynessProbe:", 1))
    validate = tool("kubernetes-validate")
    with pytest.raises(AssertionError, match="readynessProbe"):
        finds_nothing(validate, "--strict", "--quiet", "--no-warn", path)


@pytest.mark.parametrize("overlay", ["small", "production-keda"])
def test_policies_for_clusters_find_nothing_that_is_not_waived(overlay: str, tmp_path: Path) -> None:
    path = tmp_path / "objects.yaml"
    path.write_text(rendered_text(overlay))
    finds_nothing(tool("checkov"), "--config-file", DEPLOY / "checkov.yaml", "--framework", "kubernetes", "--file", path)


def test_policies_for_images_find_nothing_that_is_not_waived() -> None:
    finds_nothing(tool("checkov"), "--config-file", DEPLOY / "checkov.yaml", "--framework", "dockerfile", "--file", DEPLOY / "Dockerfile")


def test_the_dockerfile_is_clean() -> None:
    finds_nothing(tool("hadolint"), DEPLOY / "Dockerfile")


@pytest.mark.parametrize(
    ("schema", "path"),
    [
        ("vendor.compose-spec", "deploy/compose.yaml"),
        ("vendor.gitlab-ci", ".gitlab-ci.yml"),
        ("vendor.github-workflows", ".github/workflows/pipeline.yml"),
        ("vendor.renovate", "renovate.json"),
    ],
)
def test_files_fit_their_schemas(schema: str, path: str) -> None:
    transform = ["--data-transform", "gitlab-ci"] if schema == "vendor.gitlab-ci" else []
    finds_nothing(tool("check-jsonschema"), "--builtin-schema", schema, *transform, path)
