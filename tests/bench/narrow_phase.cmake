# The peer: libccd.
pkg_check_modules(CCD REQUIRED IMPORTED_TARGET ccd)
target_link_libraries(${bench_target} PRIVATE PkgConfig::CCD)
