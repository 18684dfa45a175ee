"""From flown states to an assessment: pass, pass with warnings or fail, per route and target, each with its reasons."""
