"""From files to files: read, apply, write beside, compare, rename.

`edit` does one file; `files` is the same in parts for the library, and `pygltflib` for rigs that other
programs hold in memory. `rigspec` reads the steps of a spec and applies them, `batch` does many files.
Nothing here computes anything about rigs or formats: that is for the rooms below. Nothing here parses
command lines or prints; that is for `rigtri.cli`.
"""
