"""Rendered shading in 3-D views: what a view shows, the thread that renders it, and drawing."""
