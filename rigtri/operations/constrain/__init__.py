"""``rigtri constrain``: constraints stored as metadata, with offsets measured, and exported to VRM.

Evaluating a constraint is not here: see `rigtri.evaluation.constraint_solver`.
"""
