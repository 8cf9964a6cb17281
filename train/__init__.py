"""Training of the autoencoder; Lightning lives here and nowhere else."""
