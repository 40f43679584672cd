"""What a rig spec may contain, as pydantic models: `spec` the whole, `steps` its steps, `values` their
values.

Options are not declared here: their names, types, defaults and help are taken from where commands have
them. Nothing here reads a file or runs a step; that is for `rigtri.pipeline.rigspec`.
"""
