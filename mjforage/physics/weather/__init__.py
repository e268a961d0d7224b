"""One seeded weather for vessels and debris: wind with gusts and lees, streams and circulation.

A value is a function of (seed, episode, time, place) and of nothing else: no time step, no order
of queries, no batch. `WeatherSettings` says what the weather is like, `Field` answers queries.
"""

from mjforage.physics.weather.field import Field
from mjforage.physics.weather.flow import flow_in
from mjforage.physics.weather.settings import WeatherSettings

__all__ = ["Field", "WeatherSettings", "flow_in"]
