"""``rigtri bake``: controls and constraints evaluated into joint keys, or joints' motion given to controls.

`bake` leads; each module beside it does one thing for it: reducing tracks, what depends on joints
(rivets, pose readers), warnings. Evaluation itself is in `rigtri.evaluation`.
"""
