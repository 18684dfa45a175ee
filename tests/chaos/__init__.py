"""./check --chaos: the fault table, row by row: what is broken on purpose, a figure of what became of it, and the target.

It stands among the tests, not among the load tests of deploy/, since most of its rows are tests of the house that run in their long form.
"""
