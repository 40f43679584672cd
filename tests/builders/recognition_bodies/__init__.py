"""What characters are made of, said by hand, and how far recognition agrees."""
