"""Shared code of the experiments: units of work, campaigns, manifests, statistics, plots, reports."""


class UsageError(Exception):
    """A mistake of the one who runs it; the message says in one line what to do."""
