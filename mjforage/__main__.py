"""`python -m mjforage` is the command `mjforage`."""

from mjforage.cli import main

main()
