"""numba for packages of many kernels that call each other: each compiled once, and kept on disk.

`Project` names the package whose kernels are compiled, and the folder for their machine code;
`Decorators` are those that its kernels take. README.md says what is extended, and what that saves.

Nothing here knows what the kernels compute. `kernel`, `code`, `records` and `boxing` build on
numba's internals, and serve the versions that they are tested with (`versions`); any other version
compiles by numba's public interface alone (`plain`), with the same numbers.
"""
