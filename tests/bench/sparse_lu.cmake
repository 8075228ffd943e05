# The library that the program does not have.
target_sources(${bench_target} PRIVATE ${PROJECT_SOURCE_DIR}/engine/math/solvers/sparse/sparse_lu_${sparse_other}.cc)
target_include_directories(${bench_target} PRIVATE ${KLU_INCLUDE_DIR})
target_link_libraries(${bench_target} PRIVATE ${KLU_LIBRARY})
