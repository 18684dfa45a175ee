"""What is read of the log and of links."""
