"""How often Python looks for garbage."""

import gc


def collect_rarely() -> None:
    """A start makes hundreds of thousands of objects that stay; walking through them again and again is a third of its time."""
    gc.set_threshold(50_000, 20, 50)
