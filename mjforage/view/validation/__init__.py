"""The report of `mjforage validate`: a page, its figures, `validation.json`."""

from mjforage.view.validation.writing import check_folder, write_validation

__all__ = ["check_folder", "write_validation"]
