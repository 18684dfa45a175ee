"""From infrastructure to the network and the graph that is clear of zones."""
