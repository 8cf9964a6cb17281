from .mitsuba import MitsubaCapture as MitsubaCapture

__all__ = ["MitsubaCapture"]
