"""How often Python looks for garbage: rarely while a program starts, and from then on only among what has been made since."""

import gc


def collect_rarely() -> None:
    """A start makes hundreds of thousands of objects that stay; walking through them again and again is a third of its time."""
    gc.set_threshold(50_000, 20, 50)


def keep_what_is_there() -> None:
    """Once a start has ended: what it has made (code, models, graphs) stays, and nobody walks through it again.

    Then a look costs little and comes often, as programs that do little leave little behind: ten circles at each question to the
    database, which at 20,000 a look were half an hour's growth. Python looks at all that is old only when a quarter of it is new, and goes
    on counting what has been frozen until it looks once more. Without that second look some 800,000 objects of the start count, and what a
    request left behind while others were answered waits for 200,000 of its kind: a web program grew by a sixth an hour.
    """
    gc.collect()
    gc.freeze()
    gc.collect()
    gc.set_threshold(2_000, 10, 10)
