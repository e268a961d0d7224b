"""What people look at: reports, films, pictures, the web player."""
