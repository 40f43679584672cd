"""A composed stage as a `Rig`: prims with a place, skeletons, animations, meshes, metadata.

`read_source` reads all of it into a `Source`, which also keeps what a writer compares with. Nothing here
writes; names of attributes that are read and written (metadata, ops that reorient) are defined here.
"""
