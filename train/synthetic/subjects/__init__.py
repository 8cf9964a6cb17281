"""What a picture shows: a whole head, a person, a group, or skin without a face.

Bodies and garments are put together here, and `framing` places a camera before them.
"""
