"""Model exchange: an FMU that brings equations, solved here in compiled code."""

from harness.participants.model_exchange.participant import ModelExchange

__all__ = ["ModelExchange"]
