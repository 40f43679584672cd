"""Mutated real files: whatever they hold, the answer is a verified output or an error of ours.

`python -m fuzz` in the folder tests runs it; docs/fuzzing.md says what has been run.
"""
