"""Arguments of the solvers made from a scene, and values of a bearing before and after a solve."""
