"""``rigtri add-rivet``: locators on triangles of a mesh, their motion baked to keys, and baked again.

Points are skinned in `rigtri.evaluation.skinning`, triangles found in `rigtri.model.mesh_triangles`.
"""
