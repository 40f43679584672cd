"""orient-joints, in the order in which it runs.

`joints_to_orient` (which, and what they aim at), `bend_planes` and `up_direction` (their up axes),
`joint_frames` (the reorientation of each, and what storage cannot hold is no change) or `frame_sources` (the
same from a file or the other side), `scale_policy` and `constraint_policy` (what the rig allows), `messages`
and `unknown_bodies` (records and warnings); `orient` calls them in a row. Each step returns what it found and
changes nothing that an earlier one has returned. Frames themselves change in `rigtri.frames.reframe` alone.
"""
