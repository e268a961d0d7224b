"""Safetensors files of training: whole or absent, and equal bytes for equal content."""

from collections.abc import Mapping
from pathlib import Path

from safetensors import SafetensorError
from safetensors.torch import save_file
from torch import Tensor

from mjforage.core.whole_files import whole


def save_tensors(path: Path, tensors: Mapping[str, Tensor], note: tuple[str, str]) -> None:
    """Write tensors through a temporary file.

    Parameters
    ----------
    note : key and text for the header; one only, as safetensors puts several in any order

    Raises
    ------
    UserError
        If the file cannot be written.
    """
    with whole(path, SafetensorError) as beside:
        save_file(dict(tensors), beside, metadata=dict([note]))
        beside.chmod(0o644)  # safetensors leaves it to the owner alone
