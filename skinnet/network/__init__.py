"""The autoencoder: encoder, output activations, decoder and losses. Needs torch."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
