"""All pieces, a module for each page or folder of pages; a new one joins by a line here."""

from tests.evidence.piece import Piece
from tests.evidence.pieces import (
    communication,
    learning,
    policies,
    results,
    rules,
    sensing,
    studies,
    tuning,
    whole,
    worlds,
)

PIECES: dict[str, Piece] = {
    piece.name: piece
    for module in (
        results,
        rules,
        communication,
        sensing,
        studies,
        policies,
        learning,
        tuning,
        worlds,
        whole,
    )
    for piece in module.PIECES
}
