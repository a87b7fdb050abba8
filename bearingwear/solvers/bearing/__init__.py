"""A scene as the solvers take it, and what is known of a bearing before and after a solve."""
