"""Plants: one folder each, written once as equations, packaged as FMUs by `fmus.packaging`.

Nothing here knows the harness or the controllers.
"""
