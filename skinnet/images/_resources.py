"""Photoshop's image resources, which hold IPTC, resolution and thumbnails."""

import struct

_SIGNATURES = (b"8BIM", b"MeSa", b"PHUT", b"AgHg", b"DCSR")
_THUMBNAILS = (1033, 1036)
_IPTC = 1028


def update_resources(resources: bytes) -> bytes:
    """Remove the thumbnails, which show the photograph before the edit; the rest stays."""
    kept, at = b"", 0
    while resources[at : at + 4] in _SIGNATURES and at + 8 <= len(resources):
        start = at
        kind, name_length = struct.unpack_from(">HB", resources, at + 4)
        at += 6 + (name_length + 2) // 2 * 2
        if at + 4 > len(resources):
            return kept
        size = struct.unpack_from(">I", resources, at)[0]
        at += 4 + size + size % 2
        if kind not in _THUMBNAILS:
            kept += resources[start:at]
    return kept


def make_resources(iptc: bytes) -> bytes:
    """Make image resources of IPTC records."""
    return b"8BIM" + struct.pack(">HHI", _IPTC, 0, len(iptc)) + iptc + b"\0" * (len(iptc) % 2)
