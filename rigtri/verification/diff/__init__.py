"""What differs between two files, as a list of `Change` records.

`rig_diff` compares two rigs with the correspondence of `compare`, in the terms of a rigger; `gltf_file_diff`
and `usd_file_diff` compare what the files store, whether it shows or not. How far two files look apart is not
measured here but in `compare`, whose result `diff.Difference` holds beside the list.
"""
