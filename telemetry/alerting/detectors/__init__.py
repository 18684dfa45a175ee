"""One cause each: a module finds it and says how patient it is."""
