"""Programs that use Spanwise from outside: they know its addresses, and none of its code."""
