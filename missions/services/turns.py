"""Threads of one process work their plans out one after another.

They share one interpreter, and compiled parts let go of it for microseconds at a time. Threads that plan at once take it from each other
each time: a plan then costs half as much again as alone, just when there is most to do. What asks the database is outside of turns,
and nobody waits for a turn between the last look at the zones and the answer.
"""

from threading import Lock

one_at_a_time = Lock()
