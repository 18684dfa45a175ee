"""Assessment of flown states: pass, pass with warnings or fail, by route and target, with reasons."""
