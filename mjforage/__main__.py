"""`python -m mjforage` is the command `mjforage`."""

from mjforage.cli import main

if __name__ == "__main__":
    main()
