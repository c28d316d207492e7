"""How sure a tuning is over rigs that are known only roughly."""
