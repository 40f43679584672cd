"""Whether files look and mean the same, and what is wrong with them.

`compare` measures how far two rigs look apart, over all poses; `checks` finds everything that is wrong with
one file; `diff` lists what differs between two files. They read through `formats` and change nothing; what
to do with a verdict is up to `pipeline` and the commands.
"""
