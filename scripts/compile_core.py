"""Compile the planners' core at set-up, so that no request waits for it; does nothing where nothing has changed.

python -m scripts.compile_core [--check]      (--check only says, by its exit code, whether there is nothing to do)
"""

import shutil
import sys

from config.compiled_core import STAMP, compiled_directory, compiled_stamp, is_compiled


def main() -> int:
    folder = compiled_directory()
    if is_compiled(folder):
        return 0
    if "--check" in sys.argv[1:]:
        return 1
    shutil.rmtree(folder.parent, ignore_errors=True)  # with what was compiled from older sources
    folder.mkdir(parents=True)
    # Only now: numba reads where to keep things as it is imported.
    from inspection.graph import rehearsal as of_the_graph  # noqa: PLC0415
    from missions.flight_plan import rehearsal as of_the_drawing  # noqa: PLC0415
    from missions.routing import file_plans  # noqa: PLC0415
    from missions.routing import rehearsal as of_the_solvers  # noqa: PLC0415

    of_the_graph.rehearse()
    of_the_solvers.rehearse()
    of_the_drawing.rehearse()
    file_plans.rehearse()
    (folder / STAMP).write_text(compiled_stamp())
    return 0


if __name__ == "__main__":
    sys.exit(main())
