"""How the programs are watched: what they count, what they write down, and whether they can work. It knows no app."""
