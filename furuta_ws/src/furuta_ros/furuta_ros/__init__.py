"""What the nodes of the graph share: topics, messages, parameters, executor."""
