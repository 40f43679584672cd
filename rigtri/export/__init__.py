"""A rig in another form, for people and other programs: text, pictures, pages, scripts, the other format.

`text_description` prints it, `rig_json` is the same for machines, `drawing` makes SVG and PNG, `viewer` a
page, `explain` the steps behind a pole vector, `blender` a script, `conversion` a USD file of a glTF file and
back. Nothing here changes a rig, which an operation does, or measures one, which
`rigtri.verification` does.
"""
