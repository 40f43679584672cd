"""What people and other programs get to see of a rig: text, pictures, pages and scripts.

`text_description` prints it, `rig_json` is the same for machines, `drawing` makes SVG and PNG, `viewer` a
page, `explain` the steps behind a pole vector, `blender` a script. Everything here reads rigs and
documents and writes none: what changes a rig is an operation, and what measures one is in
`rigtri.verification`.
"""
