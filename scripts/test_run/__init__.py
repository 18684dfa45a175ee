"""Running the steps of ./check, and applying the rules to test reports."""
