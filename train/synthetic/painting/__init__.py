"""Skin on its chart, what covers it, and the colours of all that is not skin.

Parameters of a batch come in, charts and pictures of albedo come out; nothing here is random.
"""
