"""What mirror does: each kind of thing that has a side, and how far the two sides are apart."""
