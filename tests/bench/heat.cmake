# Links CVODE, which the benchmark runs as its users do.
target_include_directories(${bench_target} PRIVATE ${SUNDIALS_INCLUDE_DIR})
target_link_libraries(${bench_target} PRIVATE ${SUNDIALS_CVODE_LIBRARY})
