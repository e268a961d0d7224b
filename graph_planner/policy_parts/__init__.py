"""Parts that several policies share: auctions, routes and teams that track items."""
