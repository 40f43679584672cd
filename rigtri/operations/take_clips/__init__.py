"""Motion of one file for another: which nodes and clips are one, how keys turn, what has changed."""
