"""From flown states to a verdict: pass, pass with warnings or fail, per route and target, each with its reasons."""
