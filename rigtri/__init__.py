"""rigtri."""
