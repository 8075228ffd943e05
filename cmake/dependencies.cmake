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

# KLU (SuiteSparse, LGPL) factorises sparse matrices where it is present, Eigen elsewhere.
find_path(KLU_INCLUDE_DIR klu.h PATH_SUFFIXES suitesparse)
find_library(KLU_LIBRARY klu)
if(KLU_INCLUDE_DIR AND KLU_LIBRARY)
  set(klu_is_present ON)
else()
  set(klu_is_present OFF)
endif()
option(TRUESTEP_KLU "Sparse factorisations by KLU" ${klu_is_present})
