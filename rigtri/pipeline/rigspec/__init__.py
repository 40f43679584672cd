"""Rig specs: files that list the steps by which a character gets its rig.

Needs pydantic and ruamel.yaml; nothing else of rigtri does.
"""
