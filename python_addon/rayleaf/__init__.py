"""Rayleaf: a render engine for smooth geometry."""
