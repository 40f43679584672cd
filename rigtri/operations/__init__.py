"""One module or package for each command that edits a rig, called after the command.

An operation takes a rig of `rigtri.model` and its options, and returns a new rig; what it did goes into the
report. Beside the commands lives what several of them share: the `operation` decorator, the kinds of
options, joint selection, axis presets, aim targets, and the nodes that rigtri adds. Nothing here reads or
writes files, knows a format, prints, or compares rigs: that is for `rigtri.formats`, `rigtri.pipeline`
and `rigtri.verification`. Mathematics of poses lives in `rigtri.evaluation`, changes of frames in
`rigtri.frames`.
"""
