"""What an operator must know: an ordered list of detectors, one small module each."""
