# odeint's headers warn about themselves.
target_compile_options(${bench_target} PRIVATE -Wno-deprecated-copy -Wno-unused-local-typedefs)
