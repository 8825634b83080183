"""Takata et al.: augmented automatic choosing control of a generator at an infinite bus."""
