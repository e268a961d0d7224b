"""The link: how scans get from agent to agent, where not everybody receives everything at once."""

from mjforage.mission.link.radio import Radio, exchange_of

__all__ = ["Radio", "exchange_of"]
