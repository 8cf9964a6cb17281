"""Faces in a photograph: where they are, how they are turned, and their landmarks.

`finder` finds them, with `_detector` (BlazeFace) for places and `_face_mesh` for landmarks;
`framing` places a square around a head, and `_turned_square` cuts turned squares. `models/`
holds the networks, with their licence.
"""
