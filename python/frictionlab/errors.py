"""What is raised: the sentences are those of the command `frictionlab`."""


class FrictionlabError(Exception):
    """Everything that this package raises by itself."""


class BadInput(FrictionlabError, ValueError):  # noqa: N818 - as the command names it
    """Something that was given cannot be used; the sentence says what was expected."""


class Failure(FrictionlabError, RuntimeError):  # noqa: N818
    """The machine failed at the work, or this package did."""
