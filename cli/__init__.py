"""The program: parse, call, print. One file per command; shared options in options.py."""
