"""The rules of glTF that reading a file and checking it share: each stands here once.

The catalogues have every rule's id, severity and remedy; `nodes`, `skins` and `animations` find what breaks
them. A reader refuses a file at the first violation that it cannot live with (`refuse`), `rigtri check`
lists all of them. Functions here take numbers and JSON and know no file, buffer or rig.
"""
