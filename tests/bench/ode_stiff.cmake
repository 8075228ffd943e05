# CVODE as a user links it: the peer of bench_ode_stiff.
target_include_directories(${bench_target} PRIVATE ${SUNDIALS_INCLUDE_DIR})
target_compile_definitions(${bench_target} PRIVATE BOOST_UBLAS_NDEBUG)
target_link_libraries(${bench_target} PRIVATE ${SUNDIALS_CVODE_LIBRARY})
