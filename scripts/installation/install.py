"""Install what is missing: Debian packages, .venv, the pages' libraries, the compiled core. Needs only Python.

python -m scripts.installation.install run|check|check-fast|image      (scripts/setup calls it, one at a time in a checkout)

Independent steps run in parallel. Each reports its duration, and its progress while it runs.
"""

import hashlib
import os
import platform
import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass, field
from pathlib import Path

from scripts.installation import python_libraries, system_packages
from scripts.installation.python_libraries import CannotInstall
from scripts.installation.world_outline import write_outline

PROJECT_DIR = Path(__file__).resolve().parents[2]
VENV = PROJECT_DIR / ".venv"
NODE_MODULES = PROJECT_DIR / "node_modules"
CORE = "Planners' core"
WORTH_REPORTING_S = 5.0  # shorter set-ups are not announced
TERMINAL_INTERVAL_S, LOG_INTERVAL_S = 0.5, 15.0  # between two progress lines


@dataclass
class Step:
    """A step. Its durations were measured on two cores, with downloads."""

    text: str
    about_s: float
    run: Callable[["Step"], None]
    after: list[str] = field(default_factory=list)
    detail: str = ""  # current progress
    began_s: float = 0.0


class Progress:
    """Progress lines on the terminal or in a log."""

    def __init__(self, about_s: float) -> None:
        self._about_s = about_s
        self._began_s = time.monotonic()
        self._reported_s = self._began_s
        self._is_terminal = sys.stdout.isatty()

    def done(self, step: Step) -> None:
        self._print(f"{step.text} … {time.monotonic() - step.began_s:.1f} s\n")

    def going_on(self, steps: list[Step]) -> None:
        now = time.monotonic()
        if now - self._reported_s < (TERMINAL_INTERVAL_S if self._is_terminal else LOG_INTERVAL_S):
            return
        self._reported_s = now
        names = ", ".join(step.text + (f" ({step.detail})" if step.detail else "") for step in steps)
        text = f"{now - self._began_s:.0f} s of about {self._about_s:.0f} s: {names}"
        self._print(text[: shutil.get_terminal_size().columns - 1] if self._is_terminal else f"{text}\n")

    def _print(self, text: str) -> None:
        print(("\r\x1b[K" if self._is_terminal else "") + text, end="", flush=True)


# --- what is missing ------------------------------------------------------------------------------------------------------------------


def _digests(*names: str) -> list[str]:
    """Return lines as sha256sum prints them."""
    return [f"{hashlib.sha256((PROJECT_DIR / name).read_bytes()).hexdigest()}  {name}" for name in names]


def steps_to_do(purpose: str, base_python: str) -> list[Step]:
    """Return what this purpose still needs."""
    is_check = purpose.startswith("check")
    steps = []
    if packages := system_packages.missing_packages(purpose):
        about_s = 30.0
        steps.append(Step(f"Debian packages {' '.join(packages)}", about_s, lambda step: system_packages.install_and_verify(purpose)))

    locks = ["requirements.txt", "requirements-dev.txt"] if is_check else ["requirements.txt"]
    wanted = [str(PROJECT_DIR), *_digests(*locks)]
    libraries = "Python libraries"
    if not python_libraries.is_installed(VENV, wanted):
        lock = PROJECT_DIR / locks[-1]
        steps.append(Step(libraries, 15.0, lambda step: python_libraries.install(VENV, base_python, lock, wanted)))
    if not _page_libraries_are_there(is_check):
        steps.append(Step("Page libraries", 8.0, lambda step: _install_page_libraries(is_check), [libraries]))
    is_new = any(step.text == libraries for step in steps)
    if is_new or subprocess.run([_python(), "-m", "scripts.compile_core", "--check"], cwd=PROJECT_DIR, check=False).returncode:
        if purpose == "run":  # scripts.prepare waits for it, once the database is there
            steps.append(Step(f"{CORE}, begun in the background", 1.0, lambda step: _compile_core(step, "--detach"), [libraries]))
        else:
            steps.append(Step(CORE, 70.0, _compile_core, [libraries]))
    if not _texts_are_compiled():
        steps.append(
            Step(
                "Texts in other languages", 1.0, lambda step: _call([_python(), "-m", "scripts.development.texts", "compile"]), [libraries]
            )
        )
    return steps


def _texts_are_compiled() -> bool:
    """Whether scripts/development/texts.py has compiled the texts of server and pages since they last changed."""
    for source in (PROJECT_DIR / "locale").glob("*/LC_MESSAGES/*.po"):
        code = source.parts[-3].lower().replace("_", "-")
        target = source.with_suffix(".mo") if source.stem == "django" else PROJECT_DIR / "static" / "js" / "locale" / f"{code}.js"
        if not target.exists() or target.stat().st_mtime < source.stat().st_mtime:
            return False
    return True


def _python() -> str:
    return str(VENV / "bin" / "python")


def _page_stamp(is_check: bool) -> list[str]:
    icons = sorted(str(path.relative_to(PROJECT_DIR)) for path in (PROJECT_DIR / "static/img/icons").iterdir())
    programs = ["scripts/installation/install.py", "scripts/installation/world_outline.py", "scripts/development/build_icons.py"]
    names = ["package.json", "package-lock.json", *programs, *icons]
    return [*_digests(*names), *(["with what checks need"] if is_check else [])]


def _page_libraries_are_there(is_check: bool) -> bool:
    stamp = NODE_MODULES / ".stamp"
    return stamp.exists() and set(_page_stamp(is_check)) <= set(stamp.read_text().splitlines())


# --- steps ----------------------------------------------------------------------------------------------------------------------------


def _call(command: list[str], on_line: Callable[[str], None] | None = None) -> None:
    """Run a command. Raises CannotInstall with its output."""
    environment = {**os.environ, "PATH": f"{VENV / 'bin'}:{os.environ.get('PATH', '')}"}
    with subprocess.Popen(
        command, cwd=PROJECT_DIR, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace"
    ) as process:
        lines = []
        for line in process.stdout or ():
            lines.append(line)
            if on_line:
                on_line(line.strip())
    if process.returncode:
        raise CannotInstall("".join(lines[-60:]))


def _install_page_libraries(is_check: bool) -> None:
    stamp, served = NODE_MODULES / ".stamp", NODE_MODULES / ".spanwise"
    stamp.unlink(missing_ok=True)
    scope = [] if is_check else ["--omit=dev"]
    _call(["npm", "ci", *scope, "--prefer-offline", "--loglevel=error", "--ignore-scripts", "--no-audit", "--no-fund"])
    # Libraries of pages, served from here as /static/lib/…
    for folder, names in {
        "maplibre-gl": [
            *(f"dist/maplibre-gl{part}.mjs" for part in ("", "-shared", "-worker")), "dist/maplibre-gl.css", "LICENSE.txt",
        ],
        "three": ["build/three.module.min.js", "build/three.core.min.js", "LICENSE"],
        "world-atlas": ["LICENSE"],
    }.items():  # fmt: skip
        (served / folder).mkdir(parents=True, exist_ok=True)
        for name in names:
            shutil.copy2(NODE_MODULES / folder / name, served / folder)
    write_outline(NODE_MODULES / "world-atlas" / "countries-50m.json", served / "world-atlas" / "outline.json")
    _call([_python(), "scripts/development/build_icons.py"])
    shutil.copy2(NODE_MODULES / "lucide-static" / "LICENSE", served / "icons-LICENSE.txt")
    stamp.write_text("\n".join(_page_stamp(is_check)) + "\n")


def _compile_core(step: Step, *options: str) -> None:
    def note(line: str) -> None:
        step.detail = line

    _call([_python(), "-m", "scripts.compile_core", *options], note)


# --- all of them ----------------------------------------------------------------------------------------------------------------------


def about_s(steps: list[Step]) -> float:
    """Return how long the longest chain of steps takes."""
    by_text = {step.text: step for step in steps}

    def ends_s(step: Step) -> float:
        return step.about_s + max((ends_s(by_text[text]) for text in step.after if text in by_text), default=0.0)

    return max(map(ends_s, steps), default=0.0)


def carry_out(steps: list[Step]) -> None:
    """Run all steps, each as soon as its predecessors are done. After all have ended, raises the first failure."""
    expected_s = about_s(steps)
    progress = Progress(expected_s)
    if expected_s >= WORTH_REPORTING_S:
        print(f"To be set up, about {expected_s:.0f} s, less after another checkout: {', '.join(step.text for step in steps)}", flush=True)
    waiting, done = list(steps), set[str]()
    known = {step.text for step in steps}
    running: dict[Future[None], Step] = {}
    failure: BaseException | None = None
    with ThreadPoolExecutor(len(steps) or 1) as pool:
        while running or (waiting and not failure):
            for step in [step for step in waiting if not failure and done.issuperset(known.intersection(step.after))]:
                waiting.remove(step)
                step.began_s = time.monotonic()
                running[pool.submit(step.run, step)] = step
            finished, _ = wait(running, timeout=TERMINAL_INTERVAL_S, return_when=FIRST_COMPLETED)
            for future in finished:
                step = running.pop(future)
                if error := future.exception():
                    print(f"{step.text} … failed after {time.monotonic() - step.began_s:.1f} s\n{error}", file=sys.stderr, flush=True)
                    failure = failure or error
                    continue
                done.add(step.text)
                progress.done(step)
            progress.going_on(list(running.values()))
    if failure:
        raise failure


def main(purpose: str) -> int:
    if problem := system_packages.refusal(purpose):
        print(problem, file=sys.stderr)
        return system_packages.EXIT_MISSING
    if VENV.is_symlink():
        print(".venv is a link, and setting up would empty what it leads to. Take the link away first.", file=sys.stderr)
        return 2
    base_python = _base_python()
    if not (VENV / "spanwise-stamp").exists():
        print(f"Python {platform.python_version()} for .venv: {base_python}", flush=True)
    try:
        carry_out(steps_to_do(purpose, base_python))
    except (CannotInstall, OSError):
        return 1
    return 0


def _base_python() -> str:
    """Return the Python that runs this; a .venv cannot be its own base."""
    return str(getattr(sys, "_base_executable", sys.executable))


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1]))
    except KeyboardInterrupt:
        sys.exit(130)
