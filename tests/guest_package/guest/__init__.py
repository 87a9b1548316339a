"""A package that is not this project's, with a task, a policy, an embedding and a gate."""
