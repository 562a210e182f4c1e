"""Area aggregation, the paper's second use case: small areas join larger regions at least cost."""
