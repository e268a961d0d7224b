"""The link: transfer of scans between agents, with limits of range, time, loss and budget."""

from mjforage.mission.link.radio import Radio, exchange_of

__all__ = ["Radio", "exchange_of"]
