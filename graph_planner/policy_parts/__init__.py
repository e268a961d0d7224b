"""Parts that several policies share: auctions, walks, routes and teams that track items."""
