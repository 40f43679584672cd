"""From glTF to USD and back: what both formats have in common, read from one and written in the other.

`scene` holds it: a rig with its meshes, materials, cameras, lights and extras. `gltf_scene` and `usd_scene`
read it, the modules whose names begin with ``usd_`` or ``gltf_`` write it, each its subject. What the other
format cannot store is added to `Scene.lost` by whoever finds it.
Files, their verification and what is reported are `rigtri.pipeline.convert`'s.
"""
