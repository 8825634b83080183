"""What one paper alone uses, a package for each; the families beside this one hold the rest."""
