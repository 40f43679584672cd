"""Three points explained step by step: numbers, words and a picture.

`explain` makes the steps of three points, `matrix_steps` those of matrices; `limb_points` takes the
points of a limb; `text` and `picture` show the steps. Each step calls `rigtri.maths` and shows its
numbers: nothing is computed here a second way, printed, or written to a file.
"""
