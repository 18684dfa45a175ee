"""Infrastructure in three dimensions: forms and arms of supports, wires and their sag, decks of bridges. Pure."""
