"""Lay out a character by itself: which joints make its spine, arms, legs and fingers, and why."""
