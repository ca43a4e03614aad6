"""What the experiments share: units of work, campaigns, manifests, statistics, pictures, reports."""
