"""Rig specs: files that list the steps by which a character gets its rig.

Needs the extra ``rigtri[spec]`` (pydantic and ruamel.yaml); nothing else of rigtri does.
"""
