"""``rigtri export-blender``: a script that sets up controls, IK and constraints of a file in Blender.

`plan` describes in plain data what is to be set up; `setup_in_blender` is the one file that runs inside
Blender, imports nothing of this package, and must stay one file.
"""
