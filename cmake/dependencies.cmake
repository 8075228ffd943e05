# Every library comes from Debian 12 packages; the script `truestep` installs them.
find_package(Threads REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(Boost 1.81 REQUIRED COMPONENTS json)
find_package(TBB REQUIRED)
find_package(Protobuf 3.21 REQUIRED)
find_package(PNG REQUIRED)
find_package(ZLIB REQUIRED)
find_package(OpenSSL 3.0 REQUIRED COMPONENTS Crypto)
find_package(PkgConfig REQUIRED)
pkg_check_modules(SPDLOG REQUIRED IMPORTED_TARGET spdlog)
pkg_check_modules(HDF5 REQUIRED IMPORTED_TARGET hdf5-serial)
pkg_check_modules(OSMESA REQUIRED IMPORTED_TARGET osmesa)
pkg_check_modules(XXHASH REQUIRED IMPORTED_TARGET libxxhash)
find_package(prometheus-cpp CONFIG REQUIRED COMPONENTS core)
find_package(CLI11 CONFIG REQUIRED)

# CVODE's library holds the serial vectors and the dense and band solvers that it needs; nothing else of SUNDIALS
# is linked. Its CMake package is left alone because that asks for MPI.
find_path(SUNDIALS_INCLUDE_DIR cvode/cvode.h REQUIRED)
find_library(SUNDIALS_CVODE_LIBRARY sundials_cvode REQUIRED)

# Sparse factorisations: one library, whatever is installed, for results differ in their last bits between the two. A program
# with the other says so in its version, its recordings and the plans of its scenes.
set(TRUESTEP_SPARSE klu CACHE STRING "Sparse factorisations: klu (SuiteSparse, LGPL) or eigen")
set_property(CACHE TRUESTEP_SPARSE PROPERTY STRINGS klu eigen)
find_path(KLU_INCLUDE_DIR klu.h PATH_SUFFIXES suitesparse)
find_library(KLU_LIBRARY klu)
if(TRUESTEP_SPARSE STREQUAL "klu")
  if(NOT KLU_INCLUDE_DIR OR NOT KLU_LIBRARY)
    message(FATAL_ERROR "KLU, which factorises sparse matrices, was not found: install libsuitesparse-dev. Without it, "
                        "-DTRUESTEP_SPARSE=eigen builds a program whose results differ in their last bits.")
  endif()
  set(sparse_other eigen)
elseif(TRUESTEP_SPARSE STREQUAL "eigen")
  set(sparse_other klu)
else()
  message(FATAL_ERROR "TRUESTEP_SPARSE is \"${TRUESTEP_SPARSE}\": klu or eigen")
endif()
