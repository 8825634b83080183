"""The only place that makes FMUs: a plant (`fmus.plant`) goes in, an `.fmu` comes out."""
